//! A symmetric sparse matrix of 3 x 3 blocks whose pattern is built once, refilled many times, and grows where
//! necessary.
//!
//! Only the lower triangle is stored, row by row. Fixed points (pins, inactive regions) have no row, and blocks that
//! touch them are dropped. Energies add their blocks in the same order each time, so that the slot of the last time is
//! tried before a search. A block outside the pattern is inserted: contacts appear and vanish, and earlier blocks stay.
//! Several threads fill the matrix at once, each its own rows: every block is the sum of the same numbers in the same
//! order for any number of threads.

use crate::BlockSink;
use crate::tuning::TUNING;
use crate::vector::{Mat3, Vec3};
use rayon::prelude::*;

/// Index of what is not there: the row of a fixed point, the slot of a block outside the pattern, a node of a graph or tree.
pub const INVALID: u32 = u32::MAX;

/// Callback for one group of points that are coupled to each other.
pub type StencilVisitor<'a> = dyn FnMut(&[u32]) + 'a;

/// Symmetric block matrix over the free points.
#[derive(Debug, Clone, Default)]
pub struct BlockMatrix {
    /// Row of every point; [`INVALID`] of a fixed point, which has none.
    row_of: Vec<u32>,
    /// Point of every row.
    point_of: Vec<u32>,
    /// First slot of every row, and the number of slots.
    start: Vec<u32>,
    /// Block columns, increasing within a row; the last of a row is its diagonal.
    column: Vec<u32>,
    value: Vec<Mat3>,
    /// Number of blocks of the pattern when it was built.
    initial_nnz: usize,
    /// Rows at which one thread's range ends and the next begins, from 0 to the number of rows.
    row_ranges: Vec<u32>,
    /// Slots of the blocks of the last filling in their order, per range; [`INVALID`] for a block outside the pattern.
    slot_hints: Vec<Vec<u32>>,
}

/// Sorts a list, moves its distinct numbers to the front, and returns their count.
fn sort_and_deduplicate(list: &mut [u32]) -> usize {
    list.sort_unstable();
    let mut count = 0;
    for k in 0..list.len() {
        if k == 0 || list[k] != list[count - 1] {
            list[count] = list[k];
            count += 1;
        }
    }
    count
}

impl BlockMatrix {
    /// Returns a zero matrix with the pattern of the given `couplings` between points. `row_of` is the row of every
    /// free point (counted from 0 without gaps) and [`INVALID`] of the others.
    pub fn with_pattern(row_of: Vec<u32>, couplings: &mut dyn FnMut(&mut StencilVisitor)) -> Self {
        let rows = row_of.iter().filter(|r| **r != INVALID).count();
        let mut point_of = vec![0; rows];
        for (p, &r) in row_of.iter().enumerate().filter(|(_, r)| **r != INVALID) {
            point_of[r as usize] = p as u32;
        }
        // Couplings as (row, column); then each row's columns together, sorted, the diagonal last.
        let mut below: Vec<[u32; 2]> = Vec::new();
        couplings(&mut |points: &[u32]| {
            for (k, &p) in points.iter().enumerate() {
                let i = row_of[p as usize];
                for &q in points[..k].iter().filter(|_| i != INVALID) {
                    let j = row_of[q as usize];
                    if j != INVALID && i != j {
                        below.push([i.max(j), i.min(j)]);
                    }
                }
            }
        });
        let mut end = vec![0u32; rows];
        below.iter().for_each(|[i, _]| end[*i as usize] += 1);
        let mut lists: Vec<&mut [u32]> = Vec::with_capacity(rows);
        let mut columns = vec![0; below.len()];
        let mut rest = columns.as_mut_slice();
        for count in &end {
            let (list, others) = rest.split_at_mut(*count as usize);
            lists.push(list);
            rest = others;
        }
        end.fill(0);
        for [i, j] in below {
            let next = &mut end[i as usize];
            lists[i as usize][*next as usize] = j;
            *next += 1;
        }
        let distinct: Vec<usize> = lists
            .par_iter_mut()
            .with_min_len(TUNING.min_rows_per_thread)
            .map(|l| sort_and_deduplicate(l))
            .collect();
        let mut start = Vec::with_capacity(rows + 1);
        let mut column = Vec::with_capacity(distinct.iter().sum::<usize>() + rows);
        start.push(0);
        for (r, (list, count)) in lists.iter().zip(distinct).enumerate() {
            column.extend_from_slice(&list[..count]);
            column.push(r as u32);
            start.push(column.len() as u32);
        }
        let value = vec![Mat3::zeros(); column.len()];
        let initial_nnz = column.len();
        Self {
            row_of,
            point_of,
            start,
            column,
            value,
            initial_nnz,
            row_ranges: Vec::new(),
            slot_hints: Vec::new(),
        }
    }

    /// Whether the pattern has grown so much that it should be rebuilt.
    pub fn should_rebuild(&self) -> bool {
        (self.column.len() - self.initial_nnz) as f64 > TUNING.max_pattern_growth * self.initial_nnz as f64
    }

    /// Whether exactly the points without a `fixed` flag have rows.
    pub fn has_fixed_set(&self, fixed: &[bool]) -> bool {
        self.row_of.len() == fixed.len()
            && self.row_of.iter().zip(fixed).all(|(r, fixed)| (*r == INVALID) == *fixed)
    }

    /// Number of block rows.
    pub fn row_count(&self) -> usize {
        self.point_of.len()
    }

    /// Number of bytes that a product reads.
    pub fn bytes(&self) -> f64 {
        (self.block_count() * (size_of::<Mat3>() + size_of::<u32>())) as f64
    }

    /// Number of stored blocks.
    pub fn block_count(&self) -> usize {
        self.column.len()
    }

    /// Point of every row.
    pub fn points(&self) -> &[u32] {
        &self.point_of
    }

    /// Block columns of row `r` up to and including the diagonal.
    pub fn row(&self, r: usize) -> &[u32] {
        &self.column[self.start[r] as usize..self.start[r + 1] as usize]
    }

    /// Blocks of row `r`, in the order of [`Self::row`].
    pub fn blocks(&self, r: usize) -> &[Mat3] {
        &self.value[self.start[r] as usize..self.start[r + 1] as usize]
    }

    /// First slots of all rows and columns of all slots, which are equal for equal patterns.
    pub fn pattern(&self) -> (&[u32], &[u32]) {
        (&self.start, &self.column)
    }

    /// All blocks, row by row.
    pub fn values(&self) -> &[Mat3] {
        &self.value
    }

    /// Marks the points that are coupled to a marked one; one flag per point.
    pub fn dilate(&self, marked: &mut [bool]) {
        let before = marked.to_vec();
        for (r, &p) in self.point_of.iter().enumerate() {
            for q in self.row(r).iter().map(|&c| self.point_of[c as usize]) {
                marked[p as usize] |= before[q as usize];
                marked[q as usize] |= before[p as usize];
            }
        }
    }

    /// The diagonal block of row `r`.
    pub fn diagonal(&self, r: usize) -> &Mat3 {
        &self.value[self.start[r + 1] as usize - 1]
    }

    /// Replaces all values by the blocks that `add` adds. Every thread calls it once; it must add the same blocks in
    /// the same order each time. The pattern grows by blocks outside it; returns whether there were any.
    pub fn fill(&mut self, add: &(dyn Fn(&mut dyn BlockSink) + Sync)) -> bool {
        let threads = rayon::current_num_threads().min(self.row_count() / TUNING.min_rows_per_thread).max(1);
        if self.row_ranges.len() != threads + 1 {
            self.split_rows(threads);
        }
        let Self { row_of, start, column, value, row_ranges, slot_hints, .. } = self;
        let mut rest = value.as_mut_slice();
        let mut ranges: Vec<Rows> = Vec::with_capacity(threads);
        for (ends, slot_hints) in row_ranges.windows(2).zip(slot_hints) {
            let rows = [ends[0], ends[1]];
            let [from, to] = rows.map(|r| start[r as usize] as usize);
            let (mine, others) = rest.split_at_mut(to - from);
            rest = others;
            ranges.push(Rows {
                row_of,
                start,
                column,
                rows,
                value: mine,
                slot_hints,
                added: 0,
                misses: Vec::new(),
            });
        }
        // Each range is moved to its thread, so that counters are on different cache lines.
        let misses = ranges.into_par_iter().map(|mut range| {
            range.value.fill(Mat3::zeros());
            add(&mut range);
            range.misses
        });
        let misses: Vec<PatternMiss> = misses.collect::<Vec<_>>().concat();
        let grows = !misses.is_empty();
        if grows {
            self.grow(misses);
        }
        grows
    }

    /// Splits the rows into as many ranges as `threads`, with equal numbers of blocks.
    fn split_rows(&mut self, threads: usize) {
        let until = |k: usize| (self.column.len() * k / threads) as u32;
        let row = |k: usize| self.start.partition_point(|slot| *slot < until(k)) as u32;
        self.row_ranges = (0..threads).map(row).chain([self.row_count() as u32]).collect();
        self.slot_hints = vec![Vec::new(); threads];
    }

    /// Inserts blocks outside the pattern with their values.
    fn grow(&mut self, mut misses: Vec<PatternMiss>) {
        // A stable sort: blocks of one slot stay in the order in which they were added.
        misses.sort_by_key(|miss| [miss.row, miss.column]);
        let mut misses = misses.into_iter().peekable();
        let more = self.column.len() + misses.len();
        let (mut start, mut column, mut value) =
            (vec![0], Vec::with_capacity(more), Vec::with_capacity(more));
        let mut new_slots = Vec::with_capacity(self.column.len());
        for r in 0..self.row_count() {
            for slot in self.start[r] as usize..self.start[r + 1] as usize {
                while let Some(miss) =
                    misses.next_if(|s| s.row as usize == r && s.column <= self.column[slot])
                {
                    if column.len() > start[r] as usize && column.last() == Some(&miss.column) {
                        if let Some(value) = value.last_mut() {
                            *value += miss.block;
                        }
                    } else {
                        column.push(miss.column);
                        value.push(miss.block);
                    }
                }
                new_slots.push(column.len() as u32);
                column.push(self.column[slot]);
                value.push(self.value[slot]);
            }
            start.push(column.len() as u32);
        }
        for slot in self.slot_hints.iter_mut().flatten().filter(|slot| **slot != INVALID) {
            *slot = new_slots[*slot as usize];
        }
        (self.start, self.column, self.value) = (start, column, value);
    }

    /// Adds `amount` times the identity to the diagonal block of point `p`, if it is free.
    pub fn add_diagonal(&mut self, p: usize, amount: f64) {
        if self.row_of[p] != INVALID {
            let slot = self.start[self.row_of[p] as usize + 1] as usize - 1;
            for k in 0..3 {
                self.value[slot][(k, k)] += amount;
            }
        }
    }

    /// Largest entry on the diagonal; infinite if any is not finite.
    pub fn largest_diagonal(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for block in (0..self.row_count()).filter_map(|r| self.blocks(r).last()) {
            for k in 0..3 {
                let entry = block[(k, k)];
                largest = if entry.is_finite() { largest.max(entry) } else { f64::INFINITY };
            }
        }
        largest
    }

    /// Returns the values at free points of a field over all points, one per row.
    pub fn gather(&self, field: &[Vec3]) -> Vec<Vec3> {
        self.point_of.iter().map(|&p| field[p as usize]).collect()
    }

    /// Returns the field over all points with the given values at free points, one per row, and zero at fixed ones.
    pub fn scatter(&self, values: &[Vec3]) -> Vec<Vec3> {
        let mut field = vec![Vec3::zeros(); self.row_of.len()];
        for (&p, v) in self.point_of.iter().zip(values) {
            field[p as usize] = *v;
        }
        field
    }

    /// Computes y = A x, one per row.
    pub fn multiply(&self, x: &[Vec3], y: &mut [Vec3]) {
        y.fill(Vec3::zeros());
        for r in 0..self.row_count() {
            let mut sum = Vec3::zeros();
            let xr = x[r];
            for (&c, block) in self.row(r).iter().zip(self.blocks(r)) {
                let c = c as usize;
                sum += block * x[c];
                if c != r {
                    y[c] += block.tr_mul(&xr);
                }
            }
            y[r] += sum;
        }
    }
}

impl BlockSink for BlockMatrix {
    fn add(&mut self, i: u32, j: u32, block: &Mat3) {
        let rows = [0, self.row_count() as u32];
        let Self { row_of, start, column, value, .. } = self;
        let slot_hints = &mut Vec::new();
        let mut all = Rows { row_of, start, column, rows, value, slot_hints, added: 0, misses: Vec::new() };
        all.add(i, j, block);
        debug_assert!(all.misses.is_empty(), "block ({i}, {j}) is outside the pattern");
    }
}

/// A range of rows of a matrix while it is filled.
struct Rows<'a> {
    row_of: &'a [u32],
    start: &'a [u32],
    column: &'a [u32],
    /// The first row, and the one after the last.
    rows: [u32; 2],
    /// Their blocks.
    value: &'a mut [Mat3],
    /// Slots of the blocks added so far, followed by those of later blocks at the last filling.
    slot_hints: &'a mut Vec<u32>,
    /// Number of blocks added so far.
    added: usize,
    /// Blocks outside the pattern.
    misses: Vec<PatternMiss>,
}

/// A block outside the pattern.
#[derive(Debug, Clone, Copy)]
struct PatternMiss {
    row: u32,
    column: u32,
    block: Mat3,
}

impl Rows<'_> {
    /// Returns the slot of the block (`row`, `column`) among those of all rows; `None` outside the pattern.
    #[inline]
    fn find(&mut self, row: u32, column: u32) -> Option<u32> {
        let [from, to] = [row, row + 1].map(|r| self.start[r as usize]);
        let hint = self.slot_hints.get(self.added).copied();
        let found =
            match hint.filter(|slot| (from..to).contains(slot) && self.column[*slot as usize] == column) {
                Some(slot) => Some(slot),
                None => {
                    let columns = &self.column[from as usize..to as usize];
                    let found = columns.binary_search(&column).ok().map(|slot| from + slot as u32);
                    let slot = found.unwrap_or(INVALID);
                    match self.slot_hints.get_mut(self.added) {
                        Some(hint) => *hint = slot,
                        None => self.slot_hints.push(slot),
                    }
                    found
                }
            };
        self.added += 1;
        found
    }
}

impl BlockSink for Rows<'_> {
    #[inline]
    fn add(&mut self, i: u32, j: u32, block: &Mat3) {
        let (r, c) = (self.row_of[i as usize], self.row_of[j as usize]);
        if r == INVALID || c == INVALID {
            return;
        }
        let (row, column, transposed) = if r >= c { (r, c, false) } else { (c, r, true) };
        if !(self.rows[0]..self.rows[1]).contains(&row) {
            return;
        }
        let Some(slot) = self.find(row, column) else {
            let block = if transposed { block.transpose() } else { *block };
            self.misses.push(PatternMiss { row, column, block });
            return;
        };
        let value = &mut self.value[(slot - self.start[self.rows[0] as usize]) as usize];
        if transposed { *value += block.transpose() } else { *value += block }
    }

    #[inline]
    fn is_relevant(&self, points: &[u32]) -> bool {
        // A block lies in the row of the later of its two points.
        let (mut low, mut high) = (INVALID, 0);
        for row in points.iter().filter_map(|p| self.row_of.get(*p as usize)).filter(|row| **row != INVALID) {
            (low, high) = (low.min(*row), high.max(*row));
        }
        low < self.rows[1] && high >= self.rows[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Rng;

    /// Triples of points, near and far, every seventh point fixed.
    fn scene() -> (Vec<u32>, Vec<[u32; 3]>) {
        let mut rng = Rng::from_state(5);
        let count = 3000;
        let mut rows = 0;
        let row_of = (0..count).map(|p| {
            let row = if p % 7 == 0 { INVALID } else { rows };
            rows += u32::from(row != INVALID);
            row
        });
        let row_of = row_of.collect();
        let mut any = |limit: u32| (rng.uniform() * f64::from(limit)) as u32;
        let triples = (0..4 * count).map(|_| {
            let p = any(count);
            [p, (p + 1 + any(5)) % count, any(count)]
        });
        (row_of, triples.collect())
    }

    fn add_all(triples: &[[u32; 3]], out: &mut dyn BlockSink) {
        for (k, triple) in triples.iter().enumerate() {
            if !out.is_relevant(triple) {
                continue;
            }
            for (i, &p) in triple.iter().enumerate() {
                for &q in &triple[..=i] {
                    let block = Mat3::repeat(1.0 / (k + i + 1) as f64);
                    crate::add_symmetric(out, p, q, &block);
                }
            }
        }
    }

    #[test]
    fn values_do_not_depend_on_the_number_of_threads() {
        let (row_of, triples) = scene();
        let mut matrix =
            BlockMatrix::with_pattern(row_of, &mut |visit| triples.iter().for_each(|t| visit(t)));
        add_all(&triples, &mut matrix);
        let expected = matrix.value.clone();
        assert!(expected.iter().any(|block| block.norm() > 0.0));
        for threads in [1, 2, 3, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            // Repeatedly: with known slots, and with some that are not.
            for triples in [&triples[..], &triples[1..], &triples[..]] {
                pool.install(|| matrix.fill(&|out| add_all(triples, out)));
            }
            assert_eq!(matrix.value, expected, "{threads} threads");
        }
    }

    #[test]
    fn a_block_outside_the_pattern_is_inserted() {
        let (row_of, triples) = scene();
        let of = |triples: &[[u32; 3]]| {
            BlockMatrix::with_pattern(row_of.clone(), &mut |visit| triples.iter().for_each(|t| visit(t)))
        };
        let mut whole = of(&triples);
        whole.fill(&|out| add_all(&triples, out));
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut grown = of(&triples[triples.len() / 30..]);
            // A grown pattern is refilled as any other, also by another number of threads.
            for again in [&pool, &pool, &rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap()] {
                again.install(|| grown.fill(&|out| add_all(&triples, out)));
                assert_eq!(grown.pattern(), whole.pattern());
                assert_eq!(grown.value, whole.value, "{threads} threads");
            }
            assert!(!grown.should_rebuild());
        }
        let mut small = of(&triples[triples.len() / 3..]);
        small.fill(&|out| add_all(&triples, out));
        assert!(small.should_rebuild() && !whole.should_rebuild());
    }
}
