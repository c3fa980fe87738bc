//! Elimination order of the free points: nested dissection by recursive cuts through the present positions.
//!
//! A plane across an axis cuts a part of the points in two; the fewest points that touch all couplings across it form
//! the separator, which is eliminated after both halves (George 1973). Cuts follow the *present* positions because
//! contact pairs are neighbours in space: an order from the rest shape makes a folded sheet up to sixty times dearer
//! to factorise (`docs/adr/0009-direct-solver.md`). Where to cut is read off histograms: how far each point reaches along an axis
//! tells for every plane how many points it would take. The fewest points on a plane are a vertex cover, and that a
//! matching (Koenig's theorem). The tree of separators is the assembly tree of the factorisation (`fronts.rs`).
//! Knows no values.

use crate::math::Vec3;
use crate::sim::BlockMatrix;

/// Parts of this many points are not cut further: from 4 to 24 the work grows by 2 to 6 %, and the fronts get fewer.
const LEAF: usize = 16;
/// Planes tried per axis.
const CUTS: usize = 64;
/// The smaller half has at least this share of a part.
const LEAST_SHARE: f32 = 0.25;
/// How much uneven halves cost: a cut that leaves 1/4 on one side counts for 1.6 times its separator.
const UNEVEN: f32 = 10.0;

/// No node.
pub const NONE: u32 = u32::MAX;

/// The separators and leaves, children before parents.
#[derive(Debug, Default)]
pub struct Tree {
    /// Rows in elimination order.
    pub order: Vec<u32>,
    /// Per node: where its rows end in `order`; they start where those of the node before end.
    pub end: Vec<u32>,
    /// Per node: its parent, or [`NONE`].
    pub parent: Vec<u32>,
}

impl Tree {
    /// Cuts the rows of `matrix` by the present `positions` of all points [m].
    pub fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let mut cutter = Cutter::new(matrix, positions);
        cutter.part((0..matrix.row_count() as u32).collect());
        cutter.tree
    }

    /// Adds a node above `children`; gives the nodes that then wait for a parent.
    fn node(&mut self, rows: &[u32], children: Vec<u32>) -> Vec<u32> {
        if rows.is_empty() {
            return children;
        }
        let id = self.end.len() as u32;
        self.order.extend_from_slice(rows);
        self.end.push(self.order.len() as u32);
        self.parent.push(NONE);
        children.iter().for_each(|&c| self.parent[c as usize] = id);
        vec![id]
    }
}

/// Where a row is and how far it is coupled, per axis [m].
#[derive(Debug, Clone, Copy)]
struct Reach {
    at: [f32; 3],
    /// Smallest and largest coordinate among itself and the rows it is coupled to.
    low: [f32; 3],
    high: [f32; 3],
}

/// A plane: rows at or beyond `at` [m] on `axis` are on its high side.
#[derive(Debug, Clone, Copy)]
struct Plane {
    axis: usize,
    at: f32,
    cost: f32,
}

struct Cutter {
    /// Neighbours of row r: `neighbour[start[r]..start[r + 1]]`.
    start: Vec<u32>,
    neighbour: Vec<u32>,
    reach: Vec<Reach>,
    /// Per row: stamp of the half it was last put in.
    side: Vec<u32>,
    next: u32,
    /// Per row: its number among the high points at the present plane.
    number: Vec<u32>,
    tree: Tree,
}

impl Cutter {
    fn new(matrix: &BlockMatrix, positions: &[Vec3]) -> Self {
        let n = matrix.row_count();
        let (start, neighbour) = neighbours(matrix);
        let mut reach: Vec<Reach> = matrix
            .gather(positions)
            .iter()
            .map(|p| {
                let at = [p.x, p.y, p.z].map(|c| if c.is_finite() { c as f32 } else { 0.0 });
                Reach { at, low: at, high: at }
            })
            .collect();
        for r in 0..n {
            for &c in matrix.row(r) {
                for (a, b) in [(r, c as usize), (c as usize, r)] {
                    let at = reach[b].at;
                    let to = &mut reach[a];
                    for (k, at) in at.into_iter().enumerate() {
                        to.low[k] = to.low[k].min(at);
                        to.high[k] = to.high[k].max(at);
                    }
                }
            }
        }
        let tree = Tree { order: Vec::with_capacity(n), ..Tree::default() };
        Self { start, neighbour, reach, side: vec![0; n], next: 1, number: vec![0; n], tree }
    }

    fn neighbours(&self, r: u32) -> &[u32] {
        &self.neighbour[self.start[r as usize] as usize..self.start[r as usize + 1] as usize]
    }

    /// Cuts `rows` into nodes; gives those that wait for a parent.
    fn part(&mut self, rows: Vec<u32>) -> Vec<u32> {
        let plane = if rows.len() > LEAF { self.best_plane(&rows) } else { None };
        let Some(plane) = plane else { return self.tree.node(&rows, Vec::new()) };
        let reach = &self.reach;
        let beyond = |r: &u32| reach[*r as usize].at[plane.axis] >= plane.at;
        let (mut high, mut low): (Vec<u32>, Vec<u32>) = rows.into_iter().partition(beyond);
        let stamp = self.next;
        self.next += 2;
        low.iter().for_each(|&r| self.side[r as usize] = stamp);
        high.iter().for_each(|&r| self.side[r as usize] = stamp + 1);
        let touches = |r: u32, stamp: u32| self.neighbours(r).iter().any(|&q| self.side[q as usize] == stamp);
        let reaches_up =
            |r: &u32| self.reach[*r as usize].high[plane.axis] >= plane.at && touches(*r, stamp + 1);
        let reaches_down = |r: &u32| self.reach[*r as usize].low[plane.axis] < plane.at && touches(*r, stamp);
        let from_low: Vec<u32> = low.iter().copied().filter(reaches_up).collect();
        let from_high: Vec<u32> = high.iter().copied().filter(reaches_down).collect();
        let separator = self.cover(&from_low, &from_high, stamp + 1);
        separator.iter().for_each(|&r| self.side[r as usize] = 0);
        low.retain(|&r| self.side[r as usize] != 0);
        high.retain(|&r| self.side[r as usize] != 0);
        let mut children = self.part(low);
        children.append(&mut self.part(high));
        self.tree.node(&separator, children)
    }

    /// The plane through `rows` with the smallest separator, if any has points on both sides.
    fn best_plane(&self, rows: &[u32]) -> Option<Plane> {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for &r in rows {
            for (k, at) in self.reach[r as usize].at.into_iter().enumerate() {
                low[k] = low[k].min(at);
                high[k] = high[k].max(at);
            }
        }
        let bins = CUTS.min(rows.len());
        let mut histograms = [Histogram::default(); 3];
        for k in 0..3 {
            histograms[k].low = low[k];
            histograms[k].scale = bins as f32 / (high[k] - low[k]);
        }
        // What is thin beside the widest axis has no cheap plane.
        let widest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
        let worth = [0, 1, 2].map(|k| high[k] - low[k] > 0.1 * widest && histograms[k].scale.is_finite());
        for &r in rows {
            let reach = &self.reach[r as usize];
            for k in (0..3).filter(|&k| worth[k]) {
                histograms[k].count(reach.at[k], reach.low[k], reach.high[k], bins);
            }
        }
        (0..3)
            .filter(|&k| worth[k])
            .filter_map(|axis| histograms[axis].best(axis, bins, rows.len()))
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The fewest rows that touch all couplings between `low` and `high`, whose stamp is `high_stamp`.
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
        let (in_low, in_high) =
            crate::sim::linear::cholesky::vertex_cover::least_cover(&start, &across, high.len());
        let chosen = |rows: &[u32], chosen: &[bool]| -> Vec<u32> {
            rows.iter().zip(chosen).filter(|(_, c)| **c).map(|(r, _)| *r).collect()
        };
        let mut cover = chosen(low, &in_low);
        cover.append(&mut chosen(high, &in_high));
        cover
    }
}

/// Both directions of every coupling: where each row's neighbours start, and these.
fn neighbours(matrix: &BlockMatrix) -> (Vec<u32>, Vec<u32>) {
    let n = matrix.row_count();
    let mut start = vec![0u32; n + 1];
    for r in 0..n {
        // The diagonal, the last of a row, is no coupling.
        let row = matrix.row(r);
        start[r] += row.len() as u32 - 1;
        row[..row.len() - 1].iter().for_each(|&c| start[c as usize] += 1);
    }
    let total = crate::sim::linear::cholesky::sum_up(&mut start);
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

/// Per bin of an axis: points, and by how much the points coupled across the plane at its lower end change there.
#[derive(Debug, Clone, Copy)]
struct Histogram {
    low: f32,
    /// Bins per length [1/m].
    scale: f32,
    points: [i32; CUTS + 1],
    from_low: [i32; CUTS + 1],
    from_high: [i32; CUTS + 1],
}

impl Default for Histogram {
    fn default() -> Self {
        let none = [0; CUTS + 1];
        Self { low: 0.0, scale: 0.0, points: none, from_low: none, from_high: none }
    }
}

impl Histogram {
    /// Counts a point at `at` that is coupled from `low` to `high`.
    fn count(&mut self, at: f32, low: f32, high: f32, bins: usize) {
        // The conversion saturates: what is beyond an end counts there.
        let bin = |x: f32| (((x - self.low) * self.scale) as usize).min(bins - 1);
        let (at, low, high) = (bin(at), bin(low), bin(high));
        self.points[at + 1] += 1;
        self.from_low[at + 1] += 1;
        self.from_low[high + 1] -= 1;
        self.from_high[low + 1] += 1;
        self.from_high[at + 1] -= 1;
    }

    fn best(&self, axis: usize, bins: usize, rows: usize) -> Option<Plane> {
        let (mut below, mut from_low, mut from_high) = (0, 0, 0);
        let mut best: Option<Plane> = None;
        for c in 0..bins {
            below += self.points[c];
            from_low += self.from_low[c];
            from_high += self.from_high[c];
            let share = below as f32 / rows as f32;
            if share.min(1.0 - share) < LEAST_SHARE {
                continue;
            }
            let uneven = share - 0.5;
            let cost = from_low.min(from_high) as f32 * (1.0 + UNEVEN * uneven * uneven);
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(Plane { axis, at: self.low + c as f32 / self.scale, cost });
            }
        }
        best
    }
}
