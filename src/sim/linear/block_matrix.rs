//! A symmetric sparse matrix of 3 x 3 blocks with a pattern that is built once, refilled many times, and grows where it must.
//!
//! Only the lower triangle is stored, row by row. Points that are held (pins, sleeping parts) have no row: blocks
//! that touch them are dropped on the way in. Energies add their blocks in the same order again and again, so where each
//! went last time is looked at before it is searched for. A block without a place gets one: contacts come and go, and what
//! was filled before stays. The matrix is filled by several threads at once, each with
//! rows of its own: every block is the sum of the same numbers in the same order for any number of threads.

use crate::energy::BlockSink;
use crate::math::{Mat3, Vec3};
use rayon::prelude::*;

/// Marks a point without a row.
pub const FIXED_ROW: u32 = u32::MAX;

/// Takes one group of points that are coupled to one another.
pub type StencilVisitor<'a> = dyn FnMut(&[u32]) + 'a;

/// Symmetric block matrix over the free points.
#[derive(Debug, Clone, Default)]
pub struct BlockMatrix {
    /// Per point: its row, or [`FIXED_ROW`].
    row_of: Vec<u32>,
    /// Per row: its point.
    point_of: Vec<u32>,
    /// Per row: start of its blocks; one more at the end.
    start: Vec<u32>,
    /// Block columns, increasing within a row; the last of a row is its diagonal.
    column: Vec<u32>,
    value: Vec<Mat3>,
    /// Blocks of the pattern as it was built.
    planned: usize,
    /// Rows at which one thread's range ends and the next begins, from 0 to the number of rows.
    cuts: Vec<u32>,
    /// Per range: where its blocks went, in order.
    went: Vec<Vec<u32>>,
}

/// A thread takes at least so many rows.
const FEWEST_ROWS: usize = 256;
/// A pattern that has grown by more than this share is worth building anew.
const OVERGROWN: f64 = 0.1;
/// In the place of one that was not found.
const NOWHERE: u32 = u32::MAX;

/// Sorts a list and moves its different numbers to the front; how many those are.
fn sort_once(list: &mut [u32]) -> usize {
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
    /// Pattern of the given `couplings` between points. `row_of` gives every free point its row (rows counted
    /// from 0 without gaps) and [`FIXED_ROW`] to the others.
    pub fn with_pattern(row_of: Vec<u32>, couplings: &mut dyn FnMut(&mut StencilVisitor)) -> Self {
        let rows = row_of.iter().filter(|r| **r != FIXED_ROW).count();
        let mut point_of = vec![0; rows];
        for (p, &r) in row_of.iter().enumerate().filter(|(_, r)| **r != FIXED_ROW) {
            point_of[r as usize] = p as u32;
        }
        // Couplings as (row, column); then each row's columns together, sorted, the diagonal last.
        let mut below: Vec<[u32; 2]> = Vec::new();
        couplings(&mut |points: &[u32]| {
            for (k, &p) in points.iter().enumerate() {
                let i = row_of[p as usize];
                for &q in points[..k].iter().filter(|_| i != FIXED_ROW) {
                    let j = row_of[q as usize];
                    if j != FIXED_ROW && i != j {
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
            let at = &mut end[i as usize];
            lists[i as usize][*at as usize] = j;
            *at += 1;
        }
        let distinct: Vec<usize> =
            lists.par_iter_mut().with_min_len(FEWEST_ROWS).map(|l| sort_once(l)).collect();
        let mut start = Vec::with_capacity(rows + 1);
        let mut column = Vec::with_capacity(distinct.iter().sum::<usize>() + rows);
        start.push(0);
        for (r, (list, count)) in lists.iter().zip(distinct).enumerate() {
            column.extend_from_slice(&list[..count]);
            column.push(r as u32);
            start.push(column.len() as u32);
        }
        let value = vec![Mat3::zeros(); column.len()];
        let planned = column.len();
        Self { row_of, point_of, start, column, value, planned, cuts: Vec::new(), went: Vec::new() }
    }

    /// Whether so many blocks have been added to the pattern that it is worth building anew.
    pub fn should_rebuild(&self) -> bool {
        (self.column.len() - self.planned) as f64 > OVERGROWN * self.planned as f64
    }

    /// Whether exactly the points with `held` unset have rows.
    pub fn has_fixed_set(&self, held: &[bool]) -> bool {
        self.row_of.len() == held.len() && self.row_of.iter().zip(held).all(|(r, h)| (*r == FIXED_ROW) == *h)
    }

    /// Number of block rows.
    pub fn row_count(&self) -> usize {
        self.point_of.len()
    }

    /// Bytes that a product reads of it.
    pub fn bytes(&self) -> f64 {
        (self.block_count() * (size_of::<Mat3>() + size_of::<u32>())) as f64
    }

    /// Number of stored blocks.
    pub fn block_count(&self) -> usize {
        self.column.len()
    }

    /// Per row: its point.
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

    /// Where the blocks of each row start, and the columns of all blocks: equal for equal patterns.
    pub fn pattern(&self) -> (&[u32], &[u32]) {
        (&self.start, &self.column)
    }

    /// All blocks, row by row.
    pub fn values(&self) -> &[Mat3] {
        &self.value
    }

    /// Adds to `marked`, one flag per point, the points that a marked one is coupled to.
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

    /// Replaces all values by what `add` adds, which is called once by every thread and must add the same blocks in the
    /// same order each time. The pattern grows by the blocks that have no place in it; whether there were any.
    pub fn fill(&mut self, add: &(dyn Fn(&mut dyn BlockSink) + Sync)) -> bool {
        let threads = rayon::current_num_threads().min(self.row_count() / FEWEST_ROWS).max(1);
        if self.cuts.len() != threads + 1 {
            self.cut_into(threads);
        }
        let Self { row_of, start, column, value, cuts, went, .. } = self;
        let mut rest = value.as_mut_slice();
        let mut ranges: Vec<Rows> = Vec::with_capacity(threads);
        for (ends, went) in cuts.windows(2).zip(went) {
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
                went,
                added: 0,
                strays: Vec::new(),
            });
        }
        // Each range is moved to its thread: what they count must not share a cache line.
        let strays = ranges.into_par_iter().map(|mut range| {
            range.value.fill(Mat3::zeros());
            add(&mut range);
            range.strays
        });
        let strays: Vec<Stray> = strays.collect::<Vec<_>>().concat();
        let grows = !strays.is_empty();
        if grows {
            self.grow(strays);
        }
        grows
    }

    /// Shares the rows between so many threads: as many blocks each.
    fn cut_into(&mut self, threads: usize) {
        let until = |k: usize| (self.column.len() * k / threads) as u32;
        let row = |k: usize| self.start.partition_point(|at| *at < until(k)) as u32;
        self.cuts = (0..threads).map(row).chain([self.row_count() as u32]).collect();
        self.went = vec![Vec::new(); threads];
    }

    /// Gives places to blocks that have none, with the values they bring.
    fn grow(&mut self, mut strays: Vec<Stray>) {
        // Those of one place stay in the order in which they came.
        strays.sort_by_key(|stray| [stray.row, stray.column]);
        let mut strays = strays.into_iter().peekable();
        let more = self.column.len() + strays.len();
        let (mut start, mut column, mut value) =
            (vec![0], Vec::with_capacity(more), Vec::with_capacity(more));
        let mut now_at = Vec::with_capacity(self.column.len());
        for r in 0..self.row_count() {
            for at in self.start[r] as usize..self.start[r + 1] as usize {
                while let Some(stray) = strays.next_if(|s| s.row as usize == r && s.column <= self.column[at])
                {
                    if column.len() > start[r] as usize && column.last() == Some(&stray.column) {
                        if let Some(value) = value.last_mut() {
                            *value += stray.block;
                        }
                    } else {
                        column.push(stray.column);
                        value.push(stray.block);
                    }
                }
                now_at.push(column.len() as u32);
                column.push(self.column[at]);
                value.push(self.value[at]);
            }
            start.push(column.len() as u32);
        }
        for at in self.went.iter_mut().flatten().filter(|at| **at != NOWHERE) {
            *at = now_at[*at as usize];
        }
        (self.start, self.column, self.value) = (start, column, value);
    }

    /// Adds `amount` times the identity to the diagonal block of point `p`, if it is free.
    pub fn add_diagonal(&mut self, p: usize, amount: f64) {
        if self.row_of[p] != FIXED_ROW {
            let at = self.start[self.row_of[p] as usize + 1] as usize - 1;
            for k in 0..3 {
                self.value[at][(k, k)] += amount;
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

    /// The values of the free points of a field over all points.
    pub fn gather(&self, field: &[Vec3]) -> Vec<Vec3> {
        self.point_of.iter().map(|&p| field[p as usize]).collect()
    }

    /// A field over all points with the given values at free points and zero at held ones.
    pub fn scatter(&self, values: &[Vec3]) -> Vec<Vec3> {
        let mut field = vec![Vec3::zeros(); self.row_of.len()];
        for (&p, v) in self.point_of.iter().zip(values) {
            field[p as usize] = *v;
        }
        field
    }

    /// y = A x over rows.
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
        let went = &mut Vec::new();
        let mut all = Rows { row_of, start, column, rows, value, went, added: 0, strays: Vec::new() };
        all.add(i, j, block);
        debug_assert!(all.strays.is_empty(), "block ({i}, {j}) is outside the pattern");
    }
}

/// Some neighbouring rows of a matrix on their way to being filled.
struct Rows<'a> {
    row_of: &'a [u32],
    start: &'a [u32],
    column: &'a [u32],
    /// The first, and the one after the last.
    rows: [u32; 2],
    /// Their blocks.
    value: &'a mut [Mat3],
    /// Where the blocks added so far went; then where later ones went the time before.
    went: &'a mut Vec<u32>,
    /// Blocks added so far.
    added: usize,
    /// Those without a place.
    strays: Vec<Stray>,
}

/// A block without a place in the pattern.
#[derive(Debug, Clone, Copy)]
struct Stray {
    row: u32,
    column: u32,
    block: Mat3,
}

impl Rows<'_> {
    /// Where the block (`row`, `column`) lies among the blocks of all rows; none if it has no place.
    #[inline]
    fn find(&mut self, row: u32, column: u32) -> Option<u32> {
        let [from, to] = [row, row + 1].map(|r| self.start[r as usize]);
        let last = self.went.get(self.added).copied();
        let found = match last.filter(|at| (from..to).contains(at) && self.column[*at as usize] == column) {
            Some(at) => Some(at),
            None => {
                let columns = &self.column[from as usize..to as usize];
                let found = columns.binary_search(&column).ok().map(|at| from + at as u32);
                let at = found.unwrap_or(NOWHERE);
                match self.went.get_mut(self.added) {
                    Some(went) => *went = at,
                    None => self.went.push(at),
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
        if r == FIXED_ROW || c == FIXED_ROW {
            return;
        }
        let (row, column, turned) = if r >= c { (r, c, false) } else { (c, r, true) };
        if !(self.rows[0]..self.rows[1]).contains(&row) {
            return;
        }
        let Some(at) = self.find(row, column) else {
            let block = if turned { block.transpose() } else { *block };
            self.strays.push(Stray { row, column, block });
            return;
        };
        let value = &mut self.value[(at - self.start[self.rows[0] as usize]) as usize];
        if turned { *value += block.transpose() } else { *value += block }
    }

    #[inline]
    fn is_relevant(&self, points: &[u32]) -> bool {
        // A block lies in the row of the later of its two points.
        let (mut low, mut high) = (FIXED_ROW, 0);
        for row in points.iter().filter_map(|p| self.row_of.get(*p as usize)).filter(|row| **row != FIXED_ROW)
        {
            (low, high) = (low.min(*row), high.max(*row));
        }
        low < self.rows[1] && high >= self.rows[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    /// Triples of points, near and far, every seventh point held.
    fn scene() -> (Vec<u32>, Vec<[u32; 3]>) {
        let mut rng = Rng::from_state(5);
        let count = 3000;
        let mut rows = 0;
        let row_of = (0..count).map(|p| {
            let row = if p % 7 == 0 { FIXED_ROW } else { rows };
            rows += u32::from(row != FIXED_ROW);
            row
        });
        let row_of = row_of.collect();
        let mut any = |most: u32| (rng.uniform() * f64::from(most)) as u32;
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
                    crate::energy::add_symmetric(out, p, q, &block);
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
            // Twice: the second time with the places known, and with some that are not.
            for triples in [&triples[..], &triples[1..], &triples[..]] {
                pool.install(|| matrix.fill(&|out| add_all(triples, out)));
            }
            assert_eq!(matrix.value, expected, "{threads} threads");
        }
    }

    #[test]
    fn a_block_without_a_place_gets_one() {
        let (row_of, triples) = scene();
        let of = |triples: &[[u32; 3]]| {
            BlockMatrix::with_pattern(row_of.clone(), &mut |visit| triples.iter().for_each(|t| visit(t)))
        };
        let mut whole = of(&triples);
        whole.fill(&|out| add_all(&triples, out));
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut grown = of(&triples[triples.len() / 30..]);
            // What has grown is filled again like any other, also by another number of threads.
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
