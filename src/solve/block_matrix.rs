//! A symmetric sparse matrix of 3 x 3 blocks with a pattern that is built once and refilled many times.
//!
//! Only the lower triangle is stored, row by row. Points that are held (pins, sleeping parts) have no row: blocks
//! that touch them are dropped on the way in. Energies add their blocks in the same order again and again, so where each
//! went last time is looked at before it is searched for.

use crate::energy::BlockSink;
use crate::math::{Mat3, Vec3};

/// Marks a point without a row.
pub const HELD: u32 = u32::MAX;

/// Takes one group of points that are coupled to one another.
pub type Visit<'a> = dyn FnMut(&[u32]) + 'a;

/// Symmetric block matrix over the free points.
#[derive(Debug, Clone, Default)]
pub struct BlockMatrix {
    /// Per point: its row, or [`HELD`].
    row_of: Vec<u32>,
    /// Per row: its point.
    point_of: Vec<u32>,
    /// Per row: start of its blocks; one more at the end.
    start: Vec<u32>,
    /// Block columns, increasing within a row; the last of a row is its diagonal.
    column: Vec<u32>,
    value: Vec<Mat3>,
    /// Where the blocks added since the last [`Self::clear`] went, in order; then where later ones went the time before.
    went: Vec<u32>,
    /// Blocks added since the last [`Self::clear`].
    added: usize,
}

impl BlockMatrix {
    /// Pattern of the given `couplings` between points. `row_of` gives every free point its row (rows counted
    /// from 0 without gaps) and [`HELD`] to the others.
    pub fn with_pattern(row_of: Vec<u32>, couplings: &mut dyn FnMut(&mut Visit)) -> Self {
        let rows = row_of.iter().filter(|r| **r != HELD).count();
        let mut point_of = vec![0; rows];
        for (p, &r) in row_of.iter().enumerate().filter(|(_, r)| **r != HELD) {
            point_of[r as usize] = p as u32;
        }
        let mut lower: Vec<Vec<u32>> = (0..rows as u32).map(|r| vec![r]).collect();
        couplings(&mut |points: &[u32]| {
            for (k, &p) in points.iter().enumerate() {
                let i = row_of[p as usize];
                for &q in points[..k].iter().filter(|_| i != HELD) {
                    let j = row_of[q as usize];
                    if j != HELD && i != j {
                        lower[i.max(j) as usize].push(i.min(j));
                    }
                }
            }
        });
        let mut start = Vec::with_capacity(rows + 1);
        let mut column = Vec::new();
        start.push(0);
        for row in &mut lower {
            row.sort_unstable();
            row.dedup();
            column.extend_from_slice(row);
            start.push(column.len() as u32);
        }
        let value = vec![Mat3::zeros(); column.len()];
        Self { row_of, point_of, start, column, value, went: Vec::new(), added: 0 }
    }

    /// Whether exactly the points with `held` unset have rows.
    pub fn holds(&self, held: &[bool]) -> bool {
        self.row_of.len() == held.len() && self.row_of.iter().zip(held).all(|(r, h)| (*r == HELD) == *h)
    }

    /// Whether every pair of the free ones among `points` has a block.
    pub fn couples(&self, points: &[u32]) -> bool {
        points.iter().enumerate().all(|(k, &p)| {
            let i = self.row_of[p as usize];
            points[..k].iter().all(|&q| {
                let j = self.row_of[q as usize];
                i == HELD || j == HELD || self.row(i.max(j) as usize).binary_search(&i.min(j)).is_ok()
            })
        })
    }

    /// Number of block rows.
    pub fn row_count(&self) -> usize {
        self.point_of.len()
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

    /// The rows and columns of the points for which `kept` is set, one flag per point, with their values.
    pub fn part(&self, kept: &[bool]) -> Self {
        let mut row_of = vec![HELD; self.row_of.len()];
        let mut point_of = Vec::new();
        for &p in self.point_of.iter().filter(|&&p| kept[p as usize]) {
            row_of[p as usize] = point_of.len() as u32;
            point_of.push(p);
        }
        let (mut start, mut column, mut value) = (vec![0], Vec::new(), Vec::new());
        for &p in &point_of {
            let r = self.row_of[p as usize] as usize;
            for (&c, block) in self.row(r).iter().zip(self.blocks(r)) {
                // Rows keep their order, so columns stay sorted and the diagonal last.
                let c = row_of[self.point_of[c as usize] as usize];
                if c != HELD {
                    column.push(c);
                    value.push(*block);
                }
            }
            start.push(column.len() as u32);
        }
        Self { row_of, point_of, start, column, value, went: Vec::new(), added: 0 }
    }

    /// Adds to `marked`, one flag per point, the points that a marked one is coupled to.
    pub fn widen(&self, marked: &mut [bool]) {
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

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.value.fill(Mat3::zeros());
        self.added = 0;
    }

    /// Where the block (`row`, `column`) lies.
    #[inline]
    fn find(&mut self, row: u32, column: u32) -> Option<usize> {
        let [from, to] = [row, row + 1].map(|r| self.start[r as usize]);
        let last = self.went.get(self.added).copied();
        let at = match last.filter(|at| (from..to).contains(at) && self.column[*at as usize] == column) {
            Some(at) => at,
            None => {
                let columns = &self.column[from as usize..to as usize];
                let at = from + columns.binary_search(&column).ok()? as u32;
                match self.went.get_mut(self.added) {
                    Some(went) => *went = at,
                    None => self.went.push(at),
                }
                at
            }
        };
        self.added += 1;
        Some(at as usize)
    }

    /// Adds `amount` times the identity to the diagonal block of point `p`, if it is free.
    pub fn add_diagonal(&mut self, p: usize, amount: f64) {
        if self.row_of[p] != HELD {
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
    #[inline]
    fn add(&mut self, i: u32, j: u32, block: &Mat3) {
        let (r, c) = (self.row_of[i as usize], self.row_of[j as usize]);
        if r == HELD || c == HELD {
            return;
        }
        let (row, col, turned) = if r >= c { (r, c, false) } else { (c, r, true) };
        // A block outside the pattern would be a stencil its energy did not announce.
        let Some(at) = self.find(row, col) else {
            debug_assert!(false, "block ({i}, {j}) is outside the pattern");
            return;
        };
        if turned { self.value[at] += block.transpose() } else { self.value[at] += block }
    }
}
