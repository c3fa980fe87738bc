//! Which triangles of one mesh may meet during a motion: a tree of its patches.
//!
//! StaticBvh are cut from the mesh as it is first given and stay what they are: neighbours in cloth go along with one another, however
//! it is folded, so that the tree is never built anew. A box is kept for the beginning and one for the end of the motion
//! (`boxes::MovingBox`): layers that are carried along together, be it far, sweep nothing against one another.
//!
//! Pairs come in an order of the tree's, the same for any number of threads. Triangles with a corner that is not finite
//! meet nothing.

use crate::math::{Vec3, bounds};
use crate::mesh::PointIndex;
use crate::mesh::aabb::MovingBox;
use rayon::prelude::*;

/// Triangles of a patch that is not cut further.
const LEAF: usize = 4;
/// The search is shared out once it has so many parts.
const PARTS: usize = 256;

/// Pairs of triangles, in some order.
pub type Pairs = Vec<(u32, u32)>;

/// A tree of patches.
#[derive(Debug, Clone)]
pub struct StaticBvh {
    /// Triangles, those of a patch together.
    order: Vec<u32>,
    /// Children after their parents.
    nodes: Vec<Node>,
    /// One per node.
    boxes: Vec<MovingBox>,
    /// One per node: whether it has a marked triangle.
    marked: Vec<bool>,
}

/// A patch: `from..to` of the order; its two halves, or 0 for a leaf.
#[derive(Debug, Clone, Copy)]
struct Node {
    from: u32,
    to: u32,
    halves: u32,
}

impl StaticBvh {
    /// The patches of the mesh of these `triangles` at `points` \[m\].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        let centre = |t: &[PointIndex; 3]| t.iter().map(|p| points[p.at()]).sum::<Vec3>() / 3.0;
        let centres: Vec<Vec3> = triangles.iter().map(centre).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = vec![Node { from: 0, to: order.len() as u32, halves: 0 }];
        let mut next = 0;
        while next < nodes.len() {
            let Node { from, to, .. } = nodes[next];
            let patch = &mut order[from as usize..to as usize];
            if patch.len() > LEAF {
                let places: Vec<Vec3> = patch.iter().map(|f| centres[*f as usize]).collect();
                let (low, high) = bounds(&places);
                let axis = (high - low).imax();
                let along = |f: &u32| centres[*f as usize][axis];
                let half = patch.len() / 2;
                patch.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
                nodes[next].halves = nodes.len() as u32;
                let middle = from + half as u32;
                nodes.push(Node { from, to: middle, halves: 0 });
                nodes.push(Node { from: middle, to, halves: 0 });
            }
            next += 1;
        }
        let (boxes, marked) = (vec![MovingBox::EMPTY; nodes.len()], vec![false; nodes.len()]);
        Self { order, nodes, boxes, marked }
    }

    /// All pairs of different triangles whose `boxes`, one per triangle, come within `reach` ([`crate::mesh::aabb::SweptBox::reach`]), each
    /// once; only those with one that is `marked`, if any are told, one flag per triangle.
    pub fn overlapping_triangles(
        &mut self,
        boxes: &[MovingBox],
        reach: f32,
        rests: bool,
        marked: Option<&[bool]>,
    ) -> Vec<Pairs> {
        self.fit(boxes, marked);
        let mut parts = vec![(0, 0)];
        while parts.len() < PARTS {
            let before = parts.len();
            parts = parts.iter().flat_map(|part| self.halved(*part, reach, rests)).collect();
            if parts.len() <= before {
                break;
            }
        }
        let search = |part: (u32, u32)| {
            let (mut pairs, mut waiting) = (Vec::new(), vec![part]);
            while let Some((a, b)) = waiting.pop() {
                if self.is_leaf(a) && self.is_leaf(b) {
                    self.compare(a, b, boxes, (reach, rests), marked, &mut pairs);
                } else {
                    waiting.extend(self.halved((a, b), reach, rests));
                }
            }
            pairs
        };
        parts.into_par_iter().with_max_len(1).map(search).collect()
    }

    fn is_leaf(&self, node: u32) -> bool {
        self.nodes[node as usize].halves == 0
    }

    /// Fits the boxes of all patches to those of the triangles.
    fn fit(&mut self, boxes: &[MovingBox], marked: Option<&[bool]>) {
        for k in (0..self.nodes.len()).rev() {
            let node = self.nodes[k];
            if node.halves == 0 {
                let patch = &self.order[node.from as usize..node.to as usize];
                let of = |f: &u32| &boxes[*f as usize];
                self.boxes[k] = patch.iter().map(of).fold(MovingBox::EMPTY, |all, one| all.joined(one));
                self.marked[k] = marked.is_none_or(|marked| patch.iter().any(|f| marked[*f as usize]));
            } else {
                let halves = [node.halves as usize, node.halves as usize + 1];
                self.boxes[k] = self.boxes[halves[0]].joined(&self.boxes[halves[1]]);
                self.marked[k] = halves.iter().any(|half| self.marked[*half]);
            }
        }
    }

    /// The pairs that a pair of patches falls into which come near; two leaves stay what they are.
    fn halved(
        &self,
        (a, b): (u32, u32),
        reach: f32,
        rests: bool,
    ) -> impl Iterator<Item = (u32, u32)> + use<'_> {
        let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
        let size = |node: &Node| if node.halves == 0 { 0 } else { node.to - node.from };
        let pairs = if first.halves == 0 && second.halves == 0 {
            [Some((a, b)), None, None]
        } else if a == b {
            let half = first.halves;
            [Some((half, half)), Some((half, half + 1)), Some((half + 1, half + 1))]
        } else if size(&first) >= size(&second) {
            [Some((first.halves, b)), Some((first.halves + 1, b)), None]
        } else {
            [Some((a, second.halves)), Some((a, second.halves + 1)), None]
        };
        pairs.into_iter().flatten().filter(move |&(a, b)| {
            let [a, b] = [a as usize, b as usize];
            (self.marked[a] || self.marked[b]) && self.boxes[a].near(&self.boxes[b], reach, rests)
        })
    }

    /// Adds the pairs of triangles of two leaves.
    fn compare(
        &self,
        a: u32,
        b: u32,
        boxes: &[MovingBox],
        (reach, rests): (f32, bool),
        marked: Option<&[bool]>,
        pairs: &mut Pairs,
    ) {
        let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
        for i in first.from..first.to {
            let f = self.order[i as usize];
            let others = if a == b { i + 1..second.to } else { second.from..second.to };
            for &g in &self.order[others.start as usize..others.end as usize] {
                let counts = marked.is_none_or(|marked| marked[f as usize] || marked[g as usize]);
                if counts && boxes[f as usize].near(&boxes[g as usize], reach, rests) {
                    pairs.push((f, g));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;
    use crate::mesh::aabb::SweptBox;
    use std::collections::BTreeSet;

    /// Loose triangles that fly along together, every third its own way.
    #[test]
    fn every_pair_that_meets_comes_once() {
        let mut rng = Rng::from_state(6);
        let (mut start, mut end, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..400u32 {
            let (at, way) = (rng.in_unit_cube(), if k % 3 == 0 { rng.in_cube() } else { Vec3::x() });
            for _ in 0..3 {
                let x = at + rng.in_unit_cube() * 0.1;
                start.push(x);
                end.push(x + way + rng.in_unit_cube() * 0.02);
            }
            triangles.push([3 * k, 3 * k + 1, 3 * k + 2].map(PointIndex));
        }
        let mut patches = StaticBvh::new(&start, &triangles);
        let reach = SweptBox::reach(0.01);
        for rests in [false, true] {
            let of = |p: &PointIndex| {
                let (from, to) = (&start[p.at()], &end[p.at()]);
                if rests { MovingBox::swept(from, to) } else { MovingBox::together(from, to) }
            };
            let around = |t: &[PointIndex; 3]| of(&t[0]).with(&of(&t[1])).with(&of(&t[2]));
            let boxes: Vec<MovingBox> = triangles.iter().map(around).collect();
            let flags: Vec<bool> = (0..triangles.len()).map(|f| f % 7 == 0).collect();
            for marked in [None, Some(&flags[..])] {
                let found = patches.overlapping_triangles(&boxes, reach, rests, marked).concat();
                let sorted: BTreeSet<(u32, u32)> = found.iter().map(|&(a, b)| (a.min(b), a.max(b))).collect();
                assert_eq!(sorted.len(), found.len(), "no pair twice");
                let count = triangles.len() as u32;
                let wanted = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
                let counts = |(a, b): &(u32, u32)| {
                    marked.is_none_or(|marked| marked[*a as usize] || marked[*b as usize])
                        && boxes[*a as usize].near(&boxes[*b as usize], reach, rests)
                };
                let wanted: BTreeSet<(u32, u32)> = wanted.filter(counts).collect();
                assert!(wanted.len() > 100, "{}", wanted.len());
                assert_eq!(sorted, wanted);
            }
        }
    }

    #[test]
    fn no_triangles_have_no_overlaps() {
        assert!(StaticBvh::new(&[], &[]).overlapping_triangles(&[], 1.0, true, None).concat().is_empty());
    }
}
