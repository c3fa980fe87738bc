//! Numeric factorisation by fronts.
//!
//! Children are eliminated before their parent and added to it in their fixed order; independent subtrees run on
//! several threads. Every number is therefore the sum of the same terms in the same order, whatever the number of
//! threads. The factor is kept in one piece of memory; what a front leaves on its boundary lives only until its parent
//! has taken it, in buffers that go round. Knows neither precision nor refinement.

use crate::math::Mat3;
use crate::sim::BlockMatrix;
use crate::sim::linear::cholesky::Real;
use crate::sim::linear::cholesky::dense;
use crate::sim::linear::cholesky::dense::NotPositive;
use crate::sim::linear::cholesky::symbolic::{Front, Fronts};
use crate::sim::linear::cholesky::trapezoidal_storage;
use std::sync::Mutex;

/// Lower triangular factor of a scaled matrix.
#[derive(Default)]
pub struct Factor<T> {
    /// Per front its own columns, from its first own row down, in stairs.
    pub number: Vec<T>,
    /// The matrix was multiplied with this power of two.
    pub scale: f64,
    spare: Spare<T>,
}

/// Largest diagonal entry of the matrix once it is scaled: far from both ends of single precision.
const LARGEST: f64 = (1u64 << 40) as f64;
/// Forests whose smaller half is less work (multiplications) are not shared between threads.
const SHARED: f64 = 1e6;

impl<T: Real> Factor<T> {
    /// Exchanges what is of use during a filling only.
    pub fn swap_buffers(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.spare, &mut other.spare);
    }

    /// See [`crate::sim::linear::cholesky::Cholesky::let_go_beyond`].
    pub fn let_go_beyond(&mut self, numbers: usize) {
        if self.number.len() > numbers {
            self.number = Vec::new();
        }
    }

    /// Factorises `matrix`, to whose pattern `fronts` belong.
    pub fn fill(&mut self, fronts: &Fronts, matrix: &BlockMatrix) -> Result<(), NotPositive> {
        let largest = matrix.largest_diagonal();
        let power = (LARGEST / largest).log2().floor();
        if matrix.row_count() > 0 && !power.is_finite() {
            return Err(NotPositive);
        }
        self.scale = power.exp2();
        if self.number.len() < fronts.factor_len {
            // Let go of the old piece first; leave room for the next pattern, which costs nothing until it is touched.
            self.number = Vec::new();
            self.number = vec![T::zero(); fronts.factor_len + fronts.factor_len / 4];
        }
        let job = Job { fronts, values: matrix.values(), scale: self.scale, spare: &self.spare };
        let left = job.forest(&fronts.roots, &mut self.number[..fronts.factor_len])?;
        self.spare.give(left);
        Ok(())
    }
}

struct Job<'a, T> {
    fronts: &'a Fronts,
    values: &'a [Mat3],
    scale: f64,
    spare: &'a Spare<T>,
}

impl<T: Real> Job<'_, T> {
    /// Eliminates the subtrees of neighbouring fronts, whose factors lie in `numbers`; gives what each leaves.
    fn forest(&self, fronts: &[u32], numbers: &mut [T]) -> Result<Vec<Vec<T>>, NotPositive> {
        let (left, right) = match fronts {
            [] => return Ok(Vec::new()),
            [one] => return Ok(vec![self.subtree(*one, numbers)?]),
            _ => fronts.split_at(fronts.len() / 2),
        };
        let (low, high) = numbers.split_at_mut(self.start(right[0]) - self.start(left[0]));
        let work = |side: &[u32]| side.iter().map(|&v| self.fronts.list[v as usize].work).sum::<f64>();
        let (low, high) = if work(left).min(work(right)) > SHARED {
            rayon::join(|| self.forest(left, low), || self.forest(right, high))
        } else {
            (self.forest(left, low), self.forest(right, high))
        };
        let mut all = low?;
        all.append(&mut high?);
        Ok(all)
    }

    /// Where the factor of a subtree starts.
    fn start(&self, front: u32) -> usize {
        let first = self.fronts.list[front as usize].first;
        self.fronts.list[first as usize].start
    }

    fn subtree(&self, v: u32, numbers: &mut [T]) -> Result<Vec<T>, NotPositive> {
        let front = &self.fronts.list[v as usize];
        let children = self.fronts.children_of(front);
        let (below, panel) = numbers.split_at_mut(front.start - self.start(v));
        let left = self.forest(children, below)?;
        let (own, rows) = front.shape();
        panel.fill(T::zero());
        self.enter(front, panel, rows);
        for (&c, update) in children.iter().zip(&left) {
            let row_zero = |column| trapezoidal_storage::row_zero(rows, column);
            add(self.fronts.places_of(c), update, panel, [0, own], row_zero);
        }
        dense::eliminate(panel, rows, own)?;
        let size = rows - own;
        let mut update = self.spare.take(trapezoidal_storage::len(size, size));
        if size > 0 {
            // The product comes first: it overwrites whatever the buffer held.
            dense::leave(panel, rows, own, &mut update[..trapezoidal_storage::len(size, size)]);
            for (&c, from) in children.iter().zip(&left) {
                add(self.fronts.places_of(c), from, &mut update, [own, rows], |column| {
                    trapezoidal_storage::row_zero(size, column)
                });
            }
        }
        self.spare.give(left);
        Ok(update)
    }

    /// Adds the entries of the matrix to the front.
    fn enter(&self, front: &Front, panel: &mut [T], rows: usize) {
        for e in &self.fronts.entries[front.entries[0] as usize..front.entries[1] as usize] {
            let block = &self.values[e.block as usize];
            for c in 0..3 {
                let at = trapezoidal_storage::row_zero(rows, 3 * e.column as usize + c) + 3 * e.row as usize;
                for (r, to) in panel[at..at + 3].iter_mut().enumerate() {
                    let value = if e.turned { block[(c, r)] } else { block[(r, c)] };
                    *to = T::from_f64(value * self.scale);
                }
            }
        }
    }
}

/// Adds the part of a child's `update` that falls into columns `columns[0]..columns[1]` of its parent front to `target`,
/// which holds these columns from row `columns[0]` on: row 0 of each at `row_zero`. `places` are the parent's local rows.
fn add<T: Real>(
    places: &[u32],
    update: &[T],
    target: &mut [T],
    columns: [usize; 2],
    row_zero: impl Fn(usize) -> usize,
) {
    let size = 3 * places.len();
    let [first, last] = columns.map(|limit| places.partition_point(|&p| 3 * (p as usize) < limit));
    // Runs of neighbouring rows are added at once: (start in the child, start in the target, length), in numbers.
    let mut runs: Vec<(usize, usize, usize)> = Vec::new();
    for (k, &p) in places.iter().enumerate().skip(first) {
        let (from, to) = (3 * k, 3 * p as usize - columns[0]);
        match runs.last_mut() {
            Some(run) if run.1 + run.2 == to => run.2 += 3,
            _ => runs.push((from, to, 3)),
        }
    }
    let mut runs = &mut runs[..];
    for j in first..last {
        let column = 3 * places[j] as usize - columns[0];
        for c in 0..3 {
            let source = &update[trapezoidal_storage::row_zero(size, 3 * j + c)..][..size];
            let target = &mut target[row_zero(column + c)..];
            for &(from, to, len) in runs.iter() {
                for (to, from) in target[to..to + len].iter_mut().zip(&source[from..from + len]) {
                    *to += *from;
                }
            }
        }
        // The next column starts one block further down.
        let run = &mut runs[0];
        *run = (run.0 + 3, run.1 + 3, run.2 - 3);
        if run.2 == 0 {
            runs = &mut runs[1..];
        }
    }
}

/// Buffers that go round. What they hold is never read before it is written.
#[derive(Default)]
struct Spare<T>(Mutex<Vec<Vec<T>>>);

impl<T: Real> Spare<T> {
    /// A buffer of at least `len` numbers of any value.
    fn take(&self, len: usize) -> Vec<T> {
        if len == 0 {
            return Vec::new();
        }
        let mut spare = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let fit = |b: &Vec<T>| b.len() >= len;
        match (0..spare.len()).filter(|&k| fit(&spare[k])).min_by_key(|&k| spare[k].len()) {
            Some(best) => spare.swap_remove(best),
            None => {
                // One that was too small gives its memory back.
                let largest = (0..spare.len()).max_by_key(|&k| spare[k].len());
                drop(largest.map(|k| spare.swap_remove(k)));
                drop(spare);
                vec![T::zero(); len]
            }
        }
    }

    fn give(&self, buffers: Vec<Vec<T>>) {
        let mut spare = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        spare.extend(buffers.into_iter().filter(|b| !b.is_empty()));
    }
}
