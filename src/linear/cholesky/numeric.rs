//! Multifrontal numeric factorisation.
//!
//! Children are eliminated before their parent, and their contribution blocks are extend-added to it in a fixed order;
//! independent subtrees run on several threads. Every number is therefore the sum of the same terms in the same order
//! for any number of threads. The factor is one contiguous array; contribution blocks live in pooled buffers until the
//! parent has added them. The choice of precision and iterative refinement are outside its scope.

use crate::block_matrix::BlockMatrix;
use crate::cholesky::dense;
use crate::cholesky::dense::NotPositive;
use crate::cholesky::real::Real;
use crate::cholesky::symbolic::{Front, Fronts};
use crate::cholesky::trapezoidal_storage::{self, column_offset};
use crate::cholesky::tuning::TUNING;
use crate::vector::Mat3;
use std::sync::Mutex;

/// Lower triangular factor of a scaled matrix.
#[derive(Default)]
pub struct Factor<T> {
    /// Pivot columns of every front, from its first pivot row down, in trapezoidal panels.
    pub entries: Vec<T>,
    /// Power of two by which the matrix was multiplied.
    pub scale: f64,
    buffers: BufferPool<T>,
}

/// Largest diagonal entry of the scaled matrix: far from both ends of the range of single precision.
const SCALED_MAX_DIAGONAL: f64 = (1u64 << 40) as f64;

impl<T: Real> Factor<T> {
    /// Exchanges the buffers that are used during a factorisation only.
    pub fn swap_buffers(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.buffers, &mut other.buffers);
    }

    /// Releases the factor if it has more than `entries` entries.
    pub fn release_if_larger_than(&mut self, entries: usize) {
        if self.entries.len() > entries {
            self.entries = Vec::new();
        }
    }

    /// Factorises `matrix`, whose pattern is that of `fronts`.
    pub fn fill(&mut self, fronts: &Fronts, matrix: &BlockMatrix) -> Result<(), NotPositive> {
        let largest = matrix.largest_diagonal();
        let power = (SCALED_MAX_DIAGONAL / largest).log2().floor();
        if matrix.row_count() > 0 && !power.is_finite() {
            return Err(NotPositive);
        }
        self.scale = power.exp2();
        if self.entries.len() < fronts.factor_len {
            // The old array is released first. The margin for the next pattern costs nothing until it is written to.
            self.entries = Vec::new();
            self.entries = vec![T::zero(); fronts.factor_len + fronts.factor_len / 4];
        }
        let factorisation =
            Factorisation { fronts, values: matrix.values(), scale: self.scale, buffers: &self.buffers };
        let contributions = factorisation.forest(&fronts.roots, &mut self.entries[..fronts.factor_len])?;
        self.buffers.put(contributions);
        Ok(())
    }
}

/// A factorisation in progress.
struct Factorisation<'a, T> {
    fronts: &'a Fronts,
    values: &'a [Mat3],
    scale: f64,
    buffers: &'a BufferPool<T>,
}

impl<T: Real> Factorisation<'_, T> {
    /// Eliminates the subtrees of neighbouring fronts, whose factors are in `entries`; returns the contribution block
    /// of each.
    fn forest(&self, fronts: &[u32], entries: &mut [T]) -> Result<Vec<Vec<T>>, NotPositive> {
        let (left, right) = match fronts {
            [] => return Ok(Vec::new()),
            [one] => return Ok(vec![self.subtree(*one, entries)?]),
            _ => fronts.split_at(fronts.len() / 2),
        };
        let (low, high) = entries.split_at_mut(self.start(right[0]) - self.start(left[0]));
        let work = |side: &[u32]| side.iter().map(|&v| self.fronts.list[v as usize].work).sum::<f64>();
        let (low, high) = if work(left).min(work(right)) > TUNING.parallel.min_forest_flops {
            rayon::join(|| self.forest(left, low), || self.forest(right, high))
        } else {
            (self.forest(left, low), self.forest(right, high))
        };
        let mut all = low?;
        all.append(&mut high?);
        Ok(all)
    }

    /// Returns the first entry of the factor of a subtree.
    fn start(&self, front: u32) -> usize {
        let first = self.fronts.list[front as usize].first;
        self.fronts.list[first as usize].start
    }

    /// Eliminates the subtree of front `v`; returns its contribution block.
    fn subtree(&self, v: u32, entries: &mut [T]) -> Result<Vec<T>, NotPositive> {
        let front = &self.fronts.list[v as usize];
        let children = self.fronts.children_of(front);
        let (below, panel) = entries.split_at_mut(front.start - self.start(v));
        let contributions = self.forest(children, below)?;
        let (pivots, rows) = front.shape();
        panel.fill(T::zero());
        self.assemble(front, panel, rows);
        for (&c, contribution) in children.iter().zip(&contributions) {
            let offset = |column| column_offset(rows, column);
            extend_add(self.fronts.extend_add_map(c), contribution, panel, [0, pivots], offset);
        }
        dense::eliminate(panel, rows, pivots)?;
        let size = rows - pivots;
        let mut update = self.buffers.take(trapezoidal_storage::len(size, size));
        if size > 0 {
            // The product comes first: it overwrites whatever the buffer held.
            let len = trapezoidal_storage::len(size, size);
            dense::contribution_block(panel, rows, pivots, &mut update[..len]);
            for (&c, contribution) in children.iter().zip(&contributions) {
                let offset = |column| column_offset(size, column);
                let map = self.fronts.extend_add_map(c);
                extend_add(map, contribution, &mut update, [pivots, rows], offset);
            }
        }
        self.buffers.put(contributions);
        Ok(update)
    }

    /// Writes the entries of the matrix into the front.
    fn assemble(&self, front: &Front, panel: &mut [T], rows: usize) {
        for e in &self.fronts.entries[front.entries[0] as usize..front.entries[1] as usize] {
            let block = &self.values[e.block as usize];
            for c in 0..3 {
                let first = column_offset(rows, 3 * e.column as usize + c) + 3 * e.row as usize;
                for (r, to) in panel[first..first + 3].iter_mut().enumerate() {
                    let value = if e.transposed { block[(c, r)] } else { block[(r, c)] };
                    *to = T::from_f64(value * self.scale);
                }
            }
        }
    }
}

/// Extend-adds the part of a child's contribution block in columns `columns[0]..columns[1]` of its parent front to
/// `target`. `target` has these columns from row `columns[0]` on, with row 0 of each at its `offset`; `map` is the
/// extend-add map of the child.
fn extend_add<T: Real>(
    map: &[u32],
    contribution: &[T],
    target: &mut [T],
    columns: [usize; 2],
    offset: impl Fn(usize) -> usize,
) {
    let size = 3 * map.len();
    let [first, last] = columns.map(|limit| map.partition_point(|&p| 3 * (p as usize) < limit));
    // Runs of neighbouring rows are added at once.
    let mut runs: Vec<RowRun> = Vec::new();
    for (k, &p) in map.iter().enumerate().skip(first) {
        let (from, to) = (3 * k, 3 * p as usize - columns[0]);
        match runs.last_mut() {
            Some(run) if run.to + run.len == to => run.len += 3,
            _ => runs.push(RowRun { from, to, len: 3 }),
        }
    }
    let mut runs = &mut runs[..];
    for j in first..last {
        let column = 3 * map[j] as usize - columns[0];
        for c in 0..3 {
            let source = &contribution[column_offset(size, 3 * j + c)..][..size];
            let target = &mut target[offset(column + c)..];
            for &RowRun { from, to, len } in runs.iter() {
                for (to, from) in target[to..to + len].iter_mut().zip(&source[from..from + len]) {
                    *to += *from;
                }
            }
        }
        // The next column starts one block further down.
        let run = &mut runs[0];
        *run = RowRun { from: run.from + 3, to: run.to + 3, len: run.len - 3 };
        if run.len == 0 {
            runs = &mut runs[1..];
        }
    }
}

/// A run of neighbouring scalar rows of a contribution block that are neighbours in the parent front as well.
#[derive(Clone, Copy)]
struct RowRun {
    /// First row in the child.
    from: usize,
    /// First row in the target.
    to: usize,
    /// Number of rows.
    len: usize,
}

/// Pool of buffers. Their contents are never read before they are written.
#[derive(Default)]
struct BufferPool<T>(Mutex<Vec<Vec<T>>>);

impl<T: Real> BufferPool<T> {
    /// Returns a buffer of at least `len` entries of any value.
    fn take(&self, len: usize) -> Vec<T> {
        if len == 0 {
            return Vec::new();
        }
        let mut pool = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let fit = |b: &Vec<T>| b.len() >= len;
        match (0..pool.len()).filter(|&k| fit(&pool[k])).min_by_key(|&k| pool[k].len()) {
            Some(best) => pool.swap_remove(best),
            None => {
                // The largest one, which is too small, is freed.
                let largest = (0..pool.len()).max_by_key(|&k| pool[k].len());
                drop(largest.map(|k| pool.swap_remove(k)));
                drop(pool);
                vec![T::zero(); len]
            }
        }
    }

    fn put(&self, buffers: Vec<Vec<T>>) {
        let mut pool = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        pool.extend(buffers.into_iter().filter(|b| !b.is_empty()));
    }
}
