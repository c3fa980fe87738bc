//! Elimination order of the free points: nested dissection by recursive cuts through the current positions.
//!
//! A plane across an axis cuts a part of the points in two; the fewest points that touch all couplings across it form
//! the separator, which is eliminated after both halves (George 1973). Cuts follow the *current* positions because
//! contact pairs are neighbours in space: an order from the rest shape makes a folded sheet up to sixty times more
//! expensive to factorise (`docs/adr/0009-direct-solver.md`). Planes are chosen by histograms of the extents of the
//! points and their neighbours along each axis, which bound the size of every separator. The separator of a plane is a
//! minimum vertex cover. The tree of separators is the assembly tree of the factorisation (`symbolic.rs`). Values of
//! the matrix are not used.

use crate::block_matrix::{BlockMatrix, INVALID};
use crate::cholesky::prefix_sum::prefix_sum;
use crate::cholesky::tuning::TUNING;
use crate::cholesky::vertex_cover::minimum_vertex_cover;
use crate::vector::Vec3;

/// Number of planes tried per axis.
const PLANES: usize = TUNING.dissection.planes_per_axis;

/// Tree of separators and leaves, children before parents.
#[derive(Debug, Default)]
pub struct Tree {
    /// Rows in elimination order.
    pub order: Vec<u32>,
    /// End of the rows of every node in `order`; they start at the end of those of the node before.
    pub end: Vec<u32>,
    /// Parent of every node, or [`INVALID`].
    pub parent: Vec<u32>,
}

impl Tree {
    /// Returns the tree of the rows of `matrix` for the current `positions` of all points [m].
    pub fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let mut dissection = Dissection::new(matrix, positions);
        dissection.dissect((0..matrix.row_count() as u32).collect());
        dissection.tree
    }

    /// Adds a node above `children`; returns the nodes that are then without a parent.
    fn node(&mut self, rows: &[u32], children: Vec<u32>) -> Vec<u32> {
        if rows.is_empty() {
            return children;
        }
        let id = self.end.len() as u32;
        self.order.extend_from_slice(rows);
        self.end.push(self.order.len() as u32);
        self.parent.push(INVALID);
        children.iter().for_each(|&c| self.parent[c as usize] = id);
        vec![id]
    }
}

/// Position of a row and extent of its couplings, per axis [m].
#[derive(Debug, Clone, Copy)]
struct RowExtent {
    position: [f32; 3],
    /// Minimum and maximum coordinate of the row and those it is coupled to.
    low: [f32; 3],
    high: [f32; 3],
}

/// A plane: rows at or beyond coordinate `at` [m] on `axis` are on its high side.
#[derive(Debug, Clone, Copy)]
struct CutPlane {
    axis: usize,
    at: f32,
    cost: f32,
}

/// A dissection in progress.
struct Dissection {
    /// Neighbours of row r are `neighbour[start[r]..start[r + 1]]`.
    start: Vec<u32>,
    neighbour: Vec<u32>,
    extents: Vec<RowExtent>,
    /// Stamp of the half to which every row was assigned last.
    side: Vec<u32>,
    next: u32,
    /// Number of every row among the high rows at the current plane.
    number: Vec<u32>,
    tree: Tree,
}

impl Dissection {
    fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let n = matrix.row_count();
        let (start, neighbour) = neighbours(matrix);
        let gathered = matrix.gather(positions);
        let origin = far_centre(&gathered);
        let mut extents: Vec<RowExtent> = gathered
            .iter()
            .map(|p| {
                let own = p - origin;
                let position = [own.x, own.y, own.z].map(|c| if c.is_finite() { c as f32 } else { 0.0 });
                RowExtent { position, low: position, high: position }
            })
            .collect();
        for r in 0..n {
            for &c in matrix.row(r) {
                for (a, b) in [(r, c as usize), (c as usize, r)] {
                    let position = extents[b].position;
                    let to = &mut extents[a];
                    for (k, coordinate) in position.into_iter().enumerate() {
                        to.low[k] = to.low[k].min(coordinate);
                        to.high[k] = to.high[k].max(coordinate);
                    }
                }
            }
        }
        let tree = Tree { order: Vec::with_capacity(n), ..Tree::default() };
        Self { start, neighbour, extents, side: vec![0; n], next: 1, number: vec![0; n], tree }
    }

    fn neighbours(&self, r: u32) -> &[u32] {
        &self.neighbour[self.start[r as usize] as usize..self.start[r as usize + 1] as usize]
    }

    /// Cuts `rows` into nodes; returns those without a parent.
    fn dissect(&mut self, rows: Vec<u32>) -> Vec<u32> {
        let plane =
            if rows.len() > TUNING.dissection.max_leaf_points { self.best_plane(&rows) } else { None };
        let Some(plane) = plane else { return self.tree.node(&rows, Vec::new()) };
        let extents = &self.extents;
        let beyond = |r: &u32| extents[*r as usize].position[plane.axis] >= plane.at;
        let (mut high, mut low): (Vec<u32>, Vec<u32>) = rows.into_iter().partition(beyond);
        // A plane that rounding has moved beyond all rows cuts nothing.
        if high.is_empty() || low.is_empty() {
            high.append(&mut low);
            return self.tree.node(&high, Vec::new());
        }
        let stamp = self.next;
        self.next += 2;
        low.iter().for_each(|&r| self.side[r as usize] = stamp);
        high.iter().for_each(|&r| self.side[r as usize] = stamp + 1);
        let touches = |r: u32, stamp: u32| self.neighbours(r).iter().any(|&q| self.side[q as usize] == stamp);
        let reaches_up =
            |r: &u32| self.extents[*r as usize].high[plane.axis] >= plane.at && touches(*r, stamp + 1);
        let reaches_down =
            |r: &u32| self.extents[*r as usize].low[plane.axis] < plane.at && touches(*r, stamp);
        let from_low: Vec<u32> = low.iter().copied().filter(reaches_up).collect();
        let from_high: Vec<u32> = high.iter().copied().filter(reaches_down).collect();
        let separator = self.cover(&from_low, &from_high, stamp + 1);
        separator.iter().for_each(|&r| self.side[r as usize] = 0);
        low.retain(|&r| self.side[r as usize] != 0);
        high.retain(|&r| self.side[r as usize] != 0);
        let mut children = self.dissect(low);
        children.append(&mut self.dissect(high));
        self.tree.node(&separator, children)
    }

    /// Returns the plane through `rows` with the smallest separator; `None` if none leaves enough rows on both sides.
    fn best_plane(&self, rows: &[u32]) -> Option<CutPlane> {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for &r in rows {
            for (k, at) in self.extents[r as usize].position.into_iter().enumerate() {
                low[k] = low[k].min(at);
                high[k] = high[k].max(at);
            }
        }
        let bins = PLANES.min(rows.len());
        let mut histograms = [Histogram::default(); 3];
        for k in 0..3 {
            histograms[k].low = low[k];
            histograms[k].scale = bins as f32 / (high[k] - low[k]);
        }
        // Across a thin axis no plane has a small separator.
        let widest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
        let is_wide = [0, 1, 2].map(|k| {
            high[k] - low[k] > TUNING.dissection.min_extent_fraction * widest
                && histograms[k].scale.is_finite()
        });
        for &r in rows {
            let extent = &self.extents[r as usize];
            for k in (0..3).filter(|&k| is_wide[k]) {
                histograms[k].count(extent.position[k], extent.low[k], extent.high[k], bins);
            }
        }
        (0..3)
            .filter(|&k| is_wide[k])
            .filter_map(|axis| histograms[axis].best(axis, bins, rows.len()))
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// Returns the fewest rows that touch all couplings between `low` and `high`, whose stamp is `high_stamp`.
    fn cover(&mut self, low: &[u32], high: &[u32], high_stamp: u32) -> Vec<u32> {
        for (k, &h) in high.iter().enumerate() {
            self.number[h as usize] = k as u32;
        }
        let mut start = vec![0];
        let mut across = Vec::new();
        for &r in low {
            let beyond = self.neighbours(r).iter().filter(|&&q| self.side[q as usize] == high_stamp);
            across.extend(beyond.map(|&q| self.number[q as usize]));
            start.push(across.len() as u32);
        }
        let (in_low, in_high) = minimum_vertex_cover(&start, &across, high.len());
        let chosen = |rows: &[u32], chosen: &[bool]| -> Vec<u32> {
            rows.iter().zip(chosen).filter(|(_, c)| **c).map(|(r, _)| *r).collect()
        };
        let mut cover = chosen(low, &in_low);
        cover.append(&mut chosen(high, &in_high));
        cover
    }
}

/// Returns the middle of `points` if it is so far from the origin that single precision does not tell them apart, or else the origin.
fn far_centre(points: &[Vec3]) -> Vec3 {
    let finite = || points.iter().filter(|p| p.iter().all(|c| c.is_finite()));
    let Some(first) = finite().next() else { return Vec3::zeros() };
    let (low, high) = finite().fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
    let centre = 0.5 * (low + high);
    let is_far = centre.amax() > TUNING.dissection.max_offset_ratio * (high - low).amax();
    if is_far { centre } else { Vec3::zeros() }
}

/// Returns the neighbours of all rows, both directions of every coupling, in compressed row storage.
fn neighbours(matrix: &BlockMatrix) -> (Vec<u32>, Vec<u32>) {
    let n = matrix.row_count();
    let mut start = vec![0u32; n + 1];
    for r in 0..n {
        // The diagonal, the last block of a row, is not a coupling.
        let row = matrix.row(r);
        start[r] += row.len() as u32 - 1;
        row[..row.len() - 1].iter().for_each(|&c| start[c as usize] += 1);
    }
    let total = prefix_sum(&mut start);
    let mut neighbour = vec![0u32; total as usize];
    let mut fill = start.clone();
    for r in 0..n {
        for &c in matrix.row(r).iter().take_while(|&&c| (c as usize) < r) {
            for (a, b) in [(r, c), (c as usize, r as u32)] {
                neighbour[fill[a] as usize] = b;
                fill[a] += 1;
            }
        }
    }
    (start, neighbour)
}

/// Histograms along an axis: points per bin, and the change of the number of points coupled across the plane at its
/// lower end.
#[derive(Debug, Clone, Copy)]
struct Histogram {
    low: f32,
    /// Number of bins per length [1/m].
    scale: f32,
    points: [i32; PLANES + 1],
    from_low: [i32; PLANES + 1],
    from_high: [i32; PLANES + 1],
}

impl Default for Histogram {
    fn default() -> Self {
        let none = [0; PLANES + 1];
        Self { low: 0.0, scale: 0.0, points: none, from_low: none, from_high: none }
    }
}

impl Histogram {
    /// Adds a point at `at` that is coupled from `low` to `high`.
    fn count(&mut self, at: f32, low: f32, high: f32, bins: usize) {
        // The conversion saturates: coordinates beyond an end count there.
        let bin = |x: f32| (((x - self.low) * self.scale) as usize).min(bins - 1);
        let (at, low, high) = (bin(at), bin(low), bin(high));
        self.points[at + 1] += 1;
        self.from_low[at + 1] += 1;
        self.from_low[high + 1] -= 1;
        self.from_high[low + 1] += 1;
        self.from_high[at + 1] -= 1;
    }

    /// Returns the plane with the smallest cost.
    fn best(&self, axis: usize, bins: usize, rows: usize) -> Option<CutPlane> {
        let tuning = &TUNING.dissection;
        let (mut below, mut from_low, mut from_high) = (0, 0, 0);
        let mut best: Option<CutPlane> = None;
        for c in 0..bins {
            below += self.points[c];
            from_low += self.from_low[c];
            from_high += self.from_high[c];
            let fraction = below as f32 / rows as f32;
            if fraction.min(1.0 - fraction) < tuning.min_side_fraction {
                continue;
            }
            let imbalance = fraction - 0.5;
            let penalty = 1.0 + tuning.imbalance_weight * imbalance * imbalance;
            let cost = from_low.min(from_high) as f32 * penalty;
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(CutPlane { axis, at: self.low + c as f32 / self.scale, cost });
            }
        }
        best
    }
}
