//! Symbolic analysis: which rows meet in which front, on blocks only.
//!
//! A front is the dense matrix in which one node of the tree is eliminated (Duff, Reid 1983): its own rows and its
//! boundary, the rows eliminated later that its own rows are coupled to once its children are gone. Everything here
//! is a flat sorted list, because contacts come and go and with them the pattern. Knows no values.

use crate::math::Vec3;
use crate::sim::BlockMatrix;
use crate::sim::linear::cholesky::nested_dissection::{NONE, Tree};
use crate::sim::linear::cholesky::trapezoidal_storage;

/// One dense matrix. Its local rows are its own rows and then its boundary, both in elimination order.
#[derive(Debug, Clone, Default)]
pub struct Front {
    /// Own rows: `own[0]..own[1]` of the elimination order.
    pub own: [u32; 2],
    /// Its part of [`Fronts::boundary`] and of [`Fronts::in_parent`].
    pub boundary: [u32; 2],
    /// Its part of [`Fronts::entries`].
    pub entries: [u32; 2],
    /// Its part of [`Fronts::children`].
    pub children: [u32; 2],
    /// First front of its subtree; the subtree is `first..=self`.
    pub first: u32,
    /// Start of its columns in the factor, in numbers.
    pub start: usize,
    /// Multiplications to eliminate its subtree.
    pub work: f64,
}

impl Front {
    /// Own block rows.
    pub fn own_count(&self) -> usize {
        (self.own[1] - self.own[0]) as usize
    }

    /// Block rows of the boundary.
    pub fn boundary_count(&self) -> usize {
        (self.boundary[1] - self.boundary[0]) as usize
    }

    /// Own columns and all rows, in numbers.
    pub fn shape(&self) -> (usize, usize) {
        (3 * self.own_count(), 3 * (self.own_count() + self.boundary_count()))
    }
}

/// A block of the matrix and its place in a front.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Number of the block in the matrix.
    pub block: u32,
    /// Local block row and block column.
    pub row: u32,
    pub column: u32,
    /// Whether it is stored transposed.
    pub turned: bool,
}

/// All fronts, children before parents.
#[derive(Debug, Default)]
pub struct Fronts {
    pub list: Vec<Front>,
    /// Rows of the matrix in elimination order.
    pub order: Vec<u32>,
    /// Fronts without a parent.
    pub roots: Vec<u32>,
    /// Elimination places of the boundary rows, increasing within a front.
    pub boundary: Vec<u32>,
    /// Per boundary row: its local row in the parent front.
    pub in_parent: Vec<u32>,
    pub entries: Vec<Entry>,
    pub children: Vec<u32>,
    /// Numbers in the factor.
    pub factor_len: usize,
}

impl Fronts {
    /// Fronts for the pattern of `matrix`, cut by the present `positions` of all points [m].
    pub fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let tree = Tree::new(matrix, positions);
        let mut fronts = Self { order: tree.order, ..Self::default() };
        fronts.link(&tree.end, &tree.parent);
        let later = Later::new(matrix, &fronts.order);
        fronts.meet(&later);
        fronts.measure();
        fronts
    }

    /// Multiplications of a factorisation.
    pub fn work(&self) -> f64 {
        self.roots.iter().map(|&v| self.list[v as usize].work).sum()
    }

    /// Fronts below `front`.
    pub fn children_of(&self, front: &Front) -> &[u32] {
        &self.children[front.children[0] as usize..front.children[1] as usize]
    }

    /// Local rows of the boundary of front `v` in its parent.
    pub fn places_of(&self, v: u32) -> &[u32] {
        let [a, b] = self.list[v as usize].boundary;
        &self.in_parent[a as usize..b as usize]
    }

    /// Own rows, children, subtrees.
    fn link(&mut self, end: &[u32], parent: &[u32]) {
        let mut start = 0;
        let mut count = vec![0u32; end.len() + 1];
        for (v, (&end, &parent)) in end.iter().zip(parent).enumerate() {
            self.list.push(Front { own: [start, end], first: v as u32, ..Front::default() });
            start = end;
            match parent {
                NONE => self.roots.push(v as u32),
                p => count[p as usize] += 1,
            }
        }
        let mut total = 0;
        for (front, count) in self.list.iter_mut().zip(&count) {
            front.children = [total, total];
            total += count;
        }
        self.children = vec![0; total as usize];
        for (v, &p) in parent.iter().enumerate().filter(|(_, p)| **p != NONE) {
            let first = self.list[v].first;
            let front = &mut self.list[p as usize];
            self.children[front.children[1] as usize] = v as u32;
            front.children[1] += 1;
            front.first = front.first.min(first);
        }
    }

    /// Boundaries, and places of everything in the fronts.
    fn meet(&mut self, later: &Later) {
        // Per elimination place: the last front that has seen it, and its local row there.
        let mut seen = vec![NONE; self.order.len()];
        let mut local = vec![0u32; self.order.len()];
        for v in 0..self.list.len() {
            let front = self.list[v].clone();
            let from = self.boundary.len();
            let mut found = |place: u32, boundary: &mut Vec<u32>| {
                if place >= front.own[1] && seen[place as usize] != v as u32 {
                    seen[place as usize] = v as u32;
                    boundary.push(place);
                }
            };
            for p in front.own[0]..front.own[1] {
                later.of(p).iter().for_each(|&(place, _)| found(place, &mut self.boundary));
            }
            for k in front.children[0]..front.children[1] {
                let child = &self.list[self.children[k as usize] as usize];
                for b in child.boundary[0]..child.boundary[1] {
                    let place = self.boundary[b as usize];
                    found(place, &mut self.boundary);
                }
            }
            self.boundary[from..].sort_unstable();
            for p in front.own[0]..front.own[1] {
                local[p as usize] = p - front.own[0];
            }
            for (k, &place) in self.boundary[from..].iter().enumerate() {
                local[place as usize] = (front.own_count() + k) as u32;
            }
            self.in_parent.resize(self.boundary.len(), 0);
            for k in front.children[0]..front.children[1] {
                let [a, b] = self.list[self.children[k as usize] as usize].boundary.map(|b| b as usize);
                for (to, place) in self.in_parent[a..b].iter_mut().zip(&self.boundary[a..b]) {
                    *to = local[*place as usize];
                }
            }
            let first_entry = self.entries.len() as u32;
            for p in front.own[0]..front.own[1] {
                self.entries.extend(later.of(p).iter().map(|&(place, block)| Entry {
                    block: block & !Later::TURNED,
                    row: local[place as usize],
                    column: p - front.own[0],
                    turned: block & Later::TURNED != 0,
                }));
            }
            let front = &mut self.list[v];
            front.boundary = [from as u32, self.boundary.len() as u32];
            front.entries = [first_entry, self.entries.len() as u32];
        }
    }

    /// Sizes and work.
    fn measure(&mut self) {
        for v in 0..self.list.len() {
            let (own, all) = self.list[v].shape();
            let [a, b] = self.list[v].children.map(|c| c as usize);
            let below: f64 = self.children[a..b].iter().map(|&c| self.list[c as usize].work).sum();
            let (k, b) = (own as f64, (all - own) as f64);
            self.list[v].work = below + k * (k * k / 3.0 + k * b + b * b);
            self.list[v].start = self.factor_len;
            // Where even the whole rectangle cannot be counted the factor is refused.
            let len = own.checked_mul(all).map_or(usize::MAX, |_| trapezoidal_storage::len(all, own));
            self.factor_len = self.factor_len.saturating_add(len);
        }
    }
}

/// Per elimination place: the places eliminated no earlier that it is coupled to, with the number of the block.
struct Later {
    start: Vec<u32>,
    list: Vec<(u32, u32)>,
}

impl Later {
    /// Marks blocks whose column is eliminated after their row.
    const TURNED: u32 = 1 << 31;

    fn new(matrix: &BlockMatrix, order: &[u32]) -> Self {
        let n = order.len();
        let mut place = vec![0u32; n];
        order.iter().enumerate().for_each(|(p, &r)| place[r as usize] = p as u32);
        let mut start = vec![0u32; n + 1];
        for r in 0..n {
            for &c in matrix.row(r) {
                start[place[r].min(place[c as usize]) as usize] += 1;
            }
        }
        let total = crate::sim::linear::cholesky::sum_up(&mut start);
        let mut fill = start.clone();
        let mut list = vec![(0, 0); total as usize];
        let mut block = 0;
        for r in 0..n {
            for &c in matrix.row(r) {
                let (p, q) = (place[r], place[c as usize]);
                let (first, turned) = if p < q { (p, Self::TURNED) } else { (q, 0) };
                list[fill[first as usize] as usize] = (p.max(q), block | turned);
                fill[first as usize] += 1;
                block += 1;
            }
        }
        Self { start, list }
    }

    fn of(&self, place: u32) -> &[(u32, u32)] {
        &self.list[self.start[place as usize] as usize..self.start[place as usize + 1] as usize]
    }
}
