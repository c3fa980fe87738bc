//! Searches among the candidates of an earlier, wider search, as long as little has moved since: the same answers for less.
//!
//! A point that is within the skin of where it was then, at the start and at the end of its way, has come no nearer to anything
//! than by that on each side: whoever it may meet is in the list. Only around points that have gone farther the tree is asked.

use crate::contact::broad_phase::{CandidateFinder, Candidates, PointSubset, PrimitivePair, ROUNDING};
use crate::math::Vec3;
use crate::mesh::aabb::SweptBox;
use rayon::prelude::*;

/// How far a point may be from where it was [reaches].
const SKIN: f64 = 0.2;
/// With more than this share of the triangles farther than that the list is of no use.
const MOST_FAR: f64 = 0.3;
/// After a list that was of no use so many searches at rest are made without one.
const WAIT: u32 = 8;
/// Pairs that one task looks at.
const CHUNK: usize = 4096;

/// The candidates of a mesh at rest within a wider reach.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    /// Where the mesh was \[m\].
    at: Vec<Vec3>,
    /// Reach of the searches that it serves \[m\].
    reach: f64,
    list: Candidates,
    /// Whether it has served any search but the one it was made for.
    served: bool,
    /// Searches at rest until another is made.
    wait: u32,
}

impl Kept {
    /// Whether a point goes farther than the list covers.
    fn is_far(&self, p: usize, start: &[Vec3], end: &[Vec3]) -> bool {
        let (at, skin) = (&self.at[p], SKIN * self.reach);
        let farthest = (start[p] - at).norm_squared().max((end[p] - at).norm_squared());
        // What is not finite is far.
        !(farthest <= skin * skin && end[p].x.is_finite())
    }
}

impl Candidates {
    /// Those of its pairs for which `point`, of point-triangle, and `edge`, of edge-edge pairs, is true.
    fn only(&self, point: impl Fn([u32; 2]) -> bool + Sync, edge: impl Fn([u32; 2]) -> bool + Sync) -> Self {
        Self { point_triangle: chosen(&self.point_triangle, point), edge_edge: chosen(&self.edge_edge, edge) }
    }
}

/// The pairs of a list for which `wanted` is true, in order.
fn chosen(list: &[[u32; 2]], wanted: impl Fn([u32; 2]) -> bool + Sync) -> Vec<[u32; 2]> {
    list.par_iter().with_min_len(CHUNK).copied().filter(|pair| wanted(*pair)).collect()
}

impl CandidateFinder {
    /// [`Self::find`] for a mesh that is searched again and again as it moves; the same answer.
    pub fn find_again(
        &mut self,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(PrimitivePair) -> bool + Sync),
    ) -> Candidates {
        let rests = start == end;
        let far = match self.far(start, end, reach) {
            Some(far) => {
                self.kept.served = true;
                far
            }
            None if rests && self.keeps(start, reach) => vec![false; self.triangles.len()],
            None => return self.find(start, end, reach, together, skip),
        };
        let reach = reach * (1.0 + ROUNDING);
        self.sweep(start, end, together);
        let known = self.among(&self.kept.list, start, end, reach, together, &|quad, a, b| {
            !far[a as usize] && !far[b as usize] && !skip(quad)
        });
        if !far.contains(&true) {
            return known;
        }
        let pairs = self.overlapping_triangles(start, end, reach, together, Some(&far));
        let others = self.compare(&pairs, start, end, reach, together, skip);
        Candidates {
            point_triangle: merged(known.point_triangle, others.point_triangle),
            edge_edge: merged(known.edge_edge, others.edge_edge),
        }
    }

    /// Forgets the list.
    pub fn clear_caches(&mut self) {
        self.kept = Kept::default();
    }

    /// Per triangle whether the list says nothing of it during this motion; none where the list is of no use.
    pub(super) fn far(&self, start: &[Vec3], end: &[Vec3], reach: f64) -> Option<Vec<bool>> {
        let kept = &self.kept;
        if kept.reach != reach || kept.at.len() != start.len() {
            return None;
        }
        let points: Vec<bool> = (0..start.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|p| kept.is_far(p, start, end))
            .collect();
        let far = |t: &crate::contact::broad_phase::Triangle| t.corners.iter().any(|c| points[*c as usize]);
        let far: Vec<bool> = self.triangles.iter().map(far).collect();
        let count = far.iter().filter(|far| **far).count();
        (count as f64 <= MOST_FAR * far.len() as f64).then_some(far)
    }

    /// Makes a list for searches of `reach` \[m\] at `x` \[m\], unless the last was of no use.
    fn keeps(&mut self, x: &[Vec3], reach: f64) -> bool {
        if self.kept.wait > 0 {
            self.kept.wait -= 1;
            return false;
        }
        let was_of_no_use = self.kept.reach == reach && !self.kept.served;
        self.kept = Kept::default();
        if was_of_no_use {
            self.kept.wait = WAIT;
            return false;
        }
        let list = self.find(x, x, (1.0 + 2.0 * SKIN) * reach, true, &|_| false);
        self.kept = Kept { at: x.to_vec(), reach, list, served: false, wait: 0 };
        true
    }

    /// Of the candidates in `list` those of a motion, where `wanted`: it is asked with the triangles around the two.
    fn among(
        &self,
        list: &Candidates,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        wanted: &(dyn Fn(PrimitivePair, u32, u32) -> bool + Sync),
    ) -> Candidates {
        let side = self.same_side(start, end, reach, together);
        let box_reach = SweptBox::reach(reach);
        let point = |[p, f]: [u32; 2]| {
            self.point_boxes[p as usize].near(&self.triangle_boxes[f as usize], box_reach, side.rests())
                && side.point_near(p, f)
                && wanted(self.quad_point_triangle(p, f), self.point_owner[p as usize], f)
        };
        let edge = |[e, f]: [u32; 2]| {
            let [a, b] = [e, f].map(|e| self.edge_owner[e as usize]);
            self.edge_boxes[e as usize].near(&self.edge_boxes[f as usize], box_reach, side.rests())
                && side.edge_near(e, f)
                && wanted(self.quad_edge_edge(e, f), a, b)
        };
        list.only(point, edge)
    }

    /// Of the list the pairs with one of a portion's triangles, where the mesh rests at `x` \[m\] and the list knows all of it.
    pub(super) fn around_portion(&self, has: &[bool], x: &[Vec3], reach: f64) -> Option<Candidates> {
        let far = self.far(x, x, reach)?;
        if far.contains(&true) {
            return None;
        }
        let has = |f: u32| has[f as usize];
        let point = |[p, f]: [u32; 2]| has(self.point_owner[p as usize]) || has(f);
        let edge = |[e, f]: [u32; 2]| has(self.edge_owner[e as usize]) || has(self.edge_owner[f as usize]);
        Some(self.kept.list.only(point, edge))
    }

    /// [`Self::find_around`] from the list, if that knows all about this motion; what belongs to the portion is swept.
    pub(super) fn find_around_known(
        &self,
        portion: &PointSubset,
        start: &[Vec3],
        end: &[Vec3],
        reach: f64,
        together: bool,
        skip: &(dyn Fn(PrimitivePair) -> bool + Sync),
    ) -> Option<Candidates> {
        let known = portion.known.as_ref()?;
        if portion.points.iter().any(|&p| self.kept.is_far(p as usize, start, end)) {
            return None;
        }
        Some(self.among(known, start, end, reach, together, &|quad, _, _| !skip(quad)))
    }
}

/// Two sorted lists without common entries as one.
fn merged(first: Vec<[u32; 2]>, second: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    let mut all = Vec::with_capacity(first.len() + second.len());
    let mut second = second.into_iter().peekable();
    for pair in first {
        while let Some(other) = second.next_if(|other| *other < pair) {
            all.push(other);
        }
        all.push(pair);
    }
    all.extend(second);
    all
}
