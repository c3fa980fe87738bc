//! Symbolic analysis: the fronts of the factorisation and their rows, on blocks only.
//!
//! A front is the dense matrix in which one node of the tree is eliminated (Duff, Reid 1983): its pivots (the fully
//! summed rows) and its update rows, the later rows that the pivots are coupled to after the elimination of the
//! children. Everything is a flat sorted list, as the pattern changes with the contacts. Values of the matrix are not
//! used.

use crate::block_matrix::{BlockMatrix, INVALID};
use crate::cholesky::nested_dissection::Tree;
use crate::cholesky::prefix_sum::prefix_sum;
use crate::cholesky::trapezoidal_storage;
use crate::vector::Vec3;

/// One dense matrix. Its local rows are its pivots and then its update rows, both in elimination order.
#[derive(Debug, Clone, Default)]
pub struct Front {
    /// Pivots: `pivots[0]..pivots[1]` of the elimination order.
    pub pivots: [u32; 2],
    /// Its range of [`Fronts::update_rows`] and of [`Fronts::relative_indices`].
    pub update_rows: [u32; 2],
    /// Its range of [`Fronts::entries`].
    pub entries: [u32; 2],
    /// Its range of [`Fronts::children`].
    pub children: [u32; 2],
    /// First front of its subtree; the subtree is `first..=self`.
    pub first: u32,
    /// First entry of its columns in the factor.
    pub start: usize,
    /// Multiplications of the elimination of its subtree.
    pub work: f64,
}

impl Front {
    /// Number of pivot block rows.
    pub fn pivot_count(&self) -> usize {
        (self.pivots[1] - self.pivots[0]) as usize
    }

    /// Number of update block rows.
    pub fn update_count(&self) -> usize {
        (self.update_rows[1] - self.update_rows[0]) as usize
    }

    /// Number of scalar pivot columns and of all scalar rows.
    pub fn shape(&self) -> (usize, usize) {
        (3 * self.pivot_count(), 3 * (self.pivot_count() + self.update_count()))
    }
}

/// A block of the matrix and its position in a front.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Slot of the block in the matrix.
    pub block: u32,
    /// Local block row.
    pub row: u32,
    /// Local block column.
    pub column: u32,
    /// Whether the block is used transposed.
    pub transposed: bool,
}

/// All fronts, children before parents.
#[derive(Debug, Default)]
pub struct Fronts {
    pub list: Vec<Front>,
    /// Rows of the matrix in elimination order.
    pub order: Vec<u32>,
    /// Fronts without a parent.
    pub roots: Vec<u32>,
    /// Update rows of all fronts as positions in the elimination order, increasing within a front.
    pub update_rows: Vec<u32>,
    /// Local row of every update row in the parent front.
    pub relative_indices: Vec<u32>,
    pub entries: Vec<Entry>,
    pub children: Vec<u32>,
    /// Number of entries of the factor.
    pub factor_len: usize,
}

impl Fronts {
    /// Returns the fronts of the pattern of `matrix`, with the elimination order for the `positions` of all points [m].
    pub fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let tree = Tree::new(matrix, positions);
        let mut fronts = Self { order: tree.order, ..Self::default() };
        fronts.link(&tree.end, &tree.parent);
        let couplings = LaterCouplings::new(matrix, &fronts.order);
        fronts.find_rows(&couplings);
        fronts.count_work();
        fronts
    }

    /// Multiplications of a factorisation.
    pub fn work(&self) -> f64 {
        self.roots.iter().map(|&v| self.list[v as usize].work).sum()
    }

    /// Returns the children of `front`.
    pub fn children_of(&self, front: &Front) -> &[u32] {
        &self.children[front.children[0] as usize..front.children[1] as usize]
    }

    /// Returns the relative indices of front `v`: the local rows in its parent to which its update rows are
    /// extend-added.
    pub fn extend_add_map(&self, v: u32) -> &[u32] {
        let [a, b] = self.list[v as usize].update_rows;
        &self.relative_indices[a as usize..b as usize]
    }

    /// Sets pivots, children and subtrees.
    fn link(&mut self, end: &[u32], parent: &[u32]) {
        let mut start = 0;
        let mut count = vec![0u32; end.len() + 1];
        for (v, (&end, &parent)) in end.iter().zip(parent).enumerate() {
            self.list.push(Front { pivots: [start, end], first: v as u32, ..Front::default() });
            start = end;
            match parent {
                INVALID => self.roots.push(v as u32),
                p => count[p as usize] += 1,
            }
        }
        let mut total = 0;
        for (front, count) in self.list.iter_mut().zip(&count) {
            front.children = [total, total];
            total += count;
        }
        self.children = vec![0; total as usize];
        for (v, &p) in parent.iter().enumerate().filter(|(_, p)| **p != INVALID) {
            let first = self.list[v].first;
            let front = &mut self.list[p as usize];
            self.children[front.children[1] as usize] = v as u32;
            front.children[1] += 1;
            front.first = front.first.min(first);
        }
    }

    /// Finds the update rows, and the positions of all blocks and children's rows in the fronts.
    fn find_rows(&mut self, couplings: &LaterCouplings) {
        // The last front that has seen each position of the elimination order, and its local row there.
        let mut seen = vec![INVALID; self.order.len()];
        let mut local = vec![0u32; self.order.len()];
        for v in 0..self.list.len() {
            let front = self.list[v].clone();
            let from = self.update_rows.len();
            let mut found = |position: u32, update_rows: &mut Vec<u32>| {
                if position >= front.pivots[1] && seen[position as usize] != v as u32 {
                    seen[position as usize] = v as u32;
                    update_rows.push(position);
                }
            };
            for p in front.pivots[0]..front.pivots[1] {
                couplings.of(p).iter().for_each(|c| found(c.position, &mut self.update_rows));
            }
            for k in front.children[0]..front.children[1] {
                let child = &self.list[self.children[k as usize] as usize];
                for k in child.update_rows[0]..child.update_rows[1] {
                    let position = self.update_rows[k as usize];
                    found(position, &mut self.update_rows);
                }
            }
            self.update_rows[from..].sort_unstable();
            for p in front.pivots[0]..front.pivots[1] {
                local[p as usize] = p - front.pivots[0];
            }
            for (k, &position) in self.update_rows[from..].iter().enumerate() {
                local[position as usize] = (front.pivot_count() + k) as u32;
            }
            self.relative_indices.resize(self.update_rows.len(), 0);
            for k in front.children[0]..front.children[1] {
                let child = &self.list[self.children[k as usize] as usize];
                let [a, b] = child.update_rows.map(|k| k as usize);
                for (to, position) in self.relative_indices[a..b].iter_mut().zip(&self.update_rows[a..b]) {
                    *to = local[*position as usize];
                }
            }
            let first_entry = self.entries.len() as u32;
            for p in front.pivots[0]..front.pivots[1] {
                self.entries.extend(couplings.of(p).iter().map(|c| Entry {
                    block: c.block,
                    row: local[c.position as usize],
                    column: p - front.pivots[0],
                    transposed: c.transposed,
                }));
            }
            let front = &mut self.list[v];
            front.update_rows = [from as u32, self.update_rows.len() as u32];
            front.entries = [first_entry, self.entries.len() as u32];
        }
    }

    /// Sets sizes and work.
    fn count_work(&mut self) {
        for v in 0..self.list.len() {
            let (pivots, all) = self.list[v].shape();
            let [a, b] = self.list[v].children.map(|c| c as usize);
            let below: f64 = self.children[a..b].iter().map(|&c| self.list[c as usize].work).sum();
            let (k, b) = (pivots as f64, (all - pivots) as f64);
            self.list[v].work = below + k * (k * k / 3.0 + k * b + b * b);
            self.list[v].start = self.factor_len;
            // A size that overflows makes the factor too large.
            let len = pivots.checked_mul(all).map_or(usize::MAX, |_| trapezoidal_storage::len(all, pivots));
            self.factor_len = self.factor_len.saturating_add(len);
        }
    }
}

/// A coupling of a row to one that is eliminated no earlier.
#[derive(Debug, Clone, Copy, Default)]
struct LaterCoupling {
    /// Position of the other row in the elimination order.
    position: u32,
    /// Slot of the block in the matrix.
    block: u32,
    /// Whether the column of the block is eliminated after its row.
    transposed: bool,
}

/// The later couplings of every position in the elimination order, in compressed row storage.
struct LaterCouplings {
    start: Vec<u32>,
    list: Vec<LaterCoupling>,
}

impl LaterCouplings {
    fn new(matrix: &BlockMatrix, order: &[u32]) -> Self {
        let n = order.len();
        let mut position = vec![0u32; n];
        order.iter().enumerate().for_each(|(p, &r)| position[r as usize] = p as u32);
        let mut start = vec![0u32; n + 1];
        for r in 0..n {
            for &c in matrix.row(r) {
                start[position[r].min(position[c as usize]) as usize] += 1;
            }
        }
        let total = prefix_sum(&mut start);
        let mut fill = start.clone();
        let mut list = vec![LaterCoupling::default(); total as usize];
        let mut block = 0;
        for r in 0..n {
            for &c in matrix.row(r) {
                let (p, q) = (position[r], position[c as usize]);
                let (first, transposed) = if p < q { (p, true) } else { (q, false) };
                let next = &mut fill[first as usize];
                list[*next as usize] = LaterCoupling { position: p.max(q), block, transposed };
                *next += 1;
                block += 1;
            }
        }
        Self { start, list }
    }

    /// Returns the later couplings of a position, the diagonal block among them.
    fn of(&self, position: u32) -> &[LaterCoupling] {
        &self.list[self.start[position as usize] as usize..self.start[position as usize + 1] as usize]
    }
}
