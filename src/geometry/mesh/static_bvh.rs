//! Bounding-volume hierarchy of fixed structure over the triangles of one mesh, for pairs that may come near during a motion.
//!
//! The mesh is divided as it is first given: neighbours in cloth move along with one another, however it is folded, so that the hierarchy is
//! never rebuilt. Every node has a box for the start and one for the end of the motion (`aabb::MovingBox`): layers that move along together
//! sweep nothing against one another, at any distance.
//!
//! The order of pairs is fixed by the hierarchy and the same for any number of threads. Triangles with a corner that is not finite come near
//! nothing.

use crate::math::{Vec3, bounds};
use crate::mesh::PointIndex;
use crate::mesh::aabb::MovingBox;
use crate::mesh::tuning::TUNING;
use rayon::prelude::*;

/// Pairs of triangles, in no order to rely on.
pub type TrianglePairs = Vec<(u32, u32)>;

/// A hierarchy of patches of triangles.
#[derive(Debug, Clone)]
pub struct StaticBvh {
    /// Triangles; those of a patch are contiguous.
    order: Vec<u32>,
    /// Nodes, children after their parents.
    nodes: Vec<Node>,
    /// Boxes, one per node.
    boxes: Vec<MovingBox>,
    /// Whether a node has a marked triangle, one flag per node.
    marked: Vec<bool>,
}

/// A patch: triangles `from..to` of the order, and the first of its two children, or 0 for a leaf.
#[derive(Debug, Clone, Copy)]
struct Node {
    from: u32,
    to: u32,
    children: u32,
}

impl StaticBvh {
    /// A hierarchy over `triangles` at `points` \[m\].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        let centre = |t: &[PointIndex; 3]| t.iter().map(|p| points[p.at()]).sum::<Vec3>() / 3.0;
        let centres: Vec<Vec3> = triangles.iter().map(centre).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = vec![Node { from: 0, to: order.len() as u32, children: 0 }];
        let mut next = 0;
        while next < nodes.len() {
            let Node { from, to, .. } = nodes[next];
            let patch = &mut order[from as usize..to as usize];
            if patch.len() > TUNING.bvh_leaf_size {
                let centres_of_patch: Vec<Vec3> = patch.iter().map(|f| centres[*f as usize]).collect();
                let (low, high) = bounds(&centres_of_patch);
                let axis = (high - low).imax();
                let along = |f: &u32| centres[*f as usize][axis];
                let half = patch.len() / 2;
                patch.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
                nodes[next].children = nodes.len() as u32;
                let middle = from + half as u32;
                nodes.push(Node { from, to: middle, children: 0 });
                nodes.push(Node { from: middle, to, children: 0 });
            }
            next += 1;
        }
        let (boxes, marked) = (vec![MovingBox::EMPTY; nodes.len()], vec![false; nodes.len()]);
        Self { order, nodes, boxes, marked }
    }

    /// Returns all pairs of different triangles whose `boxes`, one per triangle, come within `limit` ([`crate::mesh::aabb::SweptBox::limit`]), each
    /// once. `is_static`: the boxes are the same at both ends of the motion. With `marked`, one flag per triangle, only pairs with a marked
    /// triangle are returned.
    pub fn overlapping_triangles(
        &mut self,
        boxes: &[MovingBox],
        limit: f32,
        is_static: bool,
        marked: Option<&[bool]>,
    ) -> Vec<TrianglePairs> {
        self.fit(boxes, marked);
        let search = Search { boxes, limit, is_static, marked };
        let mut parts = vec![(0, 0)];
        while parts.len() < TUNING.bvh_search_parts {
            let before = parts.len();
            parts = parts.iter().flat_map(|part| self.split(*part, &search)).collect();
            if parts.len() <= before {
                break;
            }
        }
        let run = |parts: &[(u32, u32)]| {
            let mut pairs = Vec::with_capacity(TUNING.bvh_pairs_per_task);
            let mut waiting = parts.to_vec();
            while let Some((a, b)) = waiting.pop() {
                if self.is_leaf(a) && self.is_leaf(b) {
                    self.compare(a, b, &search, &mut pairs);
                } else {
                    waiting.extend(self.split((a, b), &search));
                }
            }
            pairs
        };
        parts.par_chunks(TUNING.bvh_parts_per_task).map(run).collect()
    }

    fn is_leaf(&self, node: u32) -> bool {
        self.nodes[node as usize].children == 0
    }

    /// Fits the boxes of all nodes to those of the triangles.
    fn fit(&mut self, boxes: &[MovingBox], marked: Option<&[bool]>) {
        for k in (0..self.nodes.len()).rev() {
            let node = self.nodes[k];
            if node.children == 0 {
                let patch = &self.order[node.from as usize..node.to as usize];
                let of = |f: &u32| &boxes[*f as usize];
                self.boxes[k] = patch.iter().map(of).fold(MovingBox::EMPTY, |all, one| all.joined(one));
                self.marked[k] = marked.is_none_or(|marked| patch.iter().any(|f| marked[*f as usize]));
            } else {
                let children = [node.children as usize, node.children as usize + 1];
                self.boxes[k] = self.boxes[children[0]].joined(&self.boxes[children[1]]);
                self.marked[k] = children.iter().any(|half| self.marked[*half]);
            }
        }
    }

    /// Returns the pairs of children of a pair of nodes that come near; a pair of leaves is not split.
    fn split(&self, (a, b): (u32, u32), search: &Search) -> impl Iterator<Item = (u32, u32)> + use<'_> {
        let (limit, is_static) = (search.limit, search.is_static);
        let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
        let size = |node: &Node| if node.children == 0 { 0 } else { node.to - node.from };
        let pairs = if first.children == 0 && second.children == 0 {
            [Some((a, b)), None, None]
        } else if a == b {
            let child = first.children;
            [Some((child, child)), Some((child, child + 1)), Some((child + 1, child + 1))]
        } else if size(&first) >= size(&second) {
            [Some((first.children, b)), Some((first.children + 1, b)), None]
        } else {
            [Some((a, second.children)), Some((a, second.children + 1)), None]
        };
        pairs.into_iter().flatten().filter(move |&(a, b)| {
            let [a, b] = [a as usize, b as usize];
            (self.marked[a] || self.marked[b]) && self.boxes[a].near(&self.boxes[b], limit, is_static)
        })
    }

    /// Adds the pairs of triangles of two leaves.
    fn compare(&self, a: u32, b: u32, search: &Search, pairs: &mut TrianglePairs) {
        let Search { boxes, limit, is_static, marked } = *search;
        let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
        for i in first.from..first.to {
            let f = self.order[i as usize];
            let others = if a == b { i + 1..second.to } else { second.from..second.to };
            for &g in &self.order[others.start as usize..others.end as usize] {
                let counts = marked.is_none_or(|marked| marked[f as usize] || marked[g as usize]);
                if counts && boxes[f as usize].near(&boxes[g as usize], limit, is_static) {
                    pairs.push((f, g));
                }
            }
        }
    }
}

/// Parameters of a search.
#[derive(Clone, Copy)]
struct Search<'a> {
    /// Boxes, one per triangle.
    boxes: &'a [MovingBox],
    limit: f32,
    is_static: bool,
    marked: Option<&'a [bool]>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;
    use crate::mesh::aabb::SweptBox;
    use std::collections::BTreeSet;

    /// Loose triangles that fly along together, every third in its own direction.
    #[test]
    fn every_pair_that_comes_near_is_found_once() {
        let mut rng = Rng::from_state(6);
        let (mut start, mut end, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..400u32 {
            let (at, motion) = (rng.in_unit_cube(), if k % 3 == 0 { rng.in_cube() } else { Vec3::x() });
            for _ in 0..3 {
                let x = at + rng.in_unit_cube() * 0.1;
                start.push(x);
                end.push(x + motion + rng.in_unit_cube() * 0.02);
            }
            triangles.push([3 * k, 3 * k + 1, 3 * k + 2].map(PointIndex));
        }
        let mut patches = StaticBvh::new(&start, &triangles);
        let limit = SweptBox::limit(0.01);
        for is_static in [false, true] {
            let of = |p: &PointIndex| {
                let (from, to) = (&start[p.at()], &end[p.at()]);
                if is_static { MovingBox::swept(from, to) } else { MovingBox::uniform(from, to) }
            };
            let around = |t: &[PointIndex; 3]| of(&t[0]).with(&of(&t[1])).with(&of(&t[2]));
            let boxes: Vec<MovingBox> = triangles.iter().map(around).collect();
            let flags: Vec<bool> = (0..triangles.len()).map(|f| f % 7 == 0).collect();
            for marked in [None, Some(&flags[..])] {
                let found = patches.overlapping_triangles(&boxes, limit, is_static, marked).concat();
                let sorted: BTreeSet<(u32, u32)> = found.iter().map(|&(a, b)| (a.min(b), a.max(b))).collect();
                assert_eq!(sorted.len(), found.len(), "no pair twice");
                let count = triangles.len() as u32;
                let wanted = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
                let counts = |(a, b): &(u32, u32)| {
                    marked.is_none_or(|marked| marked[*a as usize] || marked[*b as usize])
                        && boxes[*a as usize].near(&boxes[*b as usize], limit, is_static)
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
