//! Filter of primitive pairs of two triangles whose boxes overlap: boxes of single points and edges first, then distances.

use crate::contact::broad_phase::candidates::{Candidates, sorted};
use crate::contact::broad_phase::primitives::{MeshPrimitives, PrimitiveBoxes};
use crate::contact::broad_phase::search_query::SearchQuery;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::aabb::SweptBox;
use crease_geometry::mesh::distance::{edge_edge_squared, point_triangle_squared};
use crease_geometry::mesh::static_bvh::TrianglePairs;
use rayon::prelude::*;

/// A mesh with its boxes fitted to a query.
pub(super) struct PairFilter<'a> {
    mesh: &'a MeshPrimitives,
    boxes: &'a PrimitiveBoxes,
    query: SearchQuery<'a>,
    /// The distance of the query for boxes.
    box_distance: f32,
    /// Ends of the displacements, where all points move by the same fraction of theirs.
    uniform_end: Option<&'a [Vec3]>,
}

impl<'a> PairFilter<'a> {
    /// A filter for `query`, to whose motion `boxes` are fitted.
    pub fn new(mesh: &'a MeshPrimitives, boxes: &'a PrimitiveBoxes, query: SearchQuery<'a>) -> Self {
        let uniform_end = (query.uniform_step && !query.is_at_rest()).then_some(query.end);
        Self { mesh, boxes, query, box_distance: SweptBox::limit(query.distance), uniform_end }
    }

    /// Whether the boxes are the same at both ends of the motion: they were swept along it, or nothing moves.
    #[inline(always)]
    fn boxes_are_static(&self) -> bool {
        self.uniform_end.is_none()
    }

    /// Returns the candidates among the primitives of `pairs` of triangles.
    pub fn compare(&self, pairs: &[TrianglePairs]) -> Candidates {
        let compare = |part: &TrianglePairs| {
            let [mut points, mut edges] = [3, 6].map(|room| Shortlist::with_room(room * part.len()));
            for &(a, b) in part {
                self.shortlist_points(a, b, &mut points);
                self.shortlist_points(b, a, &mut points);
                self.shortlist_edges(a, b, &mut edges);
            }
            edges.order_pairs();
            let skip = self.query.skip;
            let points =
                points.retain(|p, f| self.is_point_near(p, f) && !skip(self.mesh.point_triangle_pair(p, f)));
            let edges = edges.retain(|e, f| self.is_edge_near(e, f) && !skip(self.mesh.edge_edge_pair(e, f)));
            (points, edges)
        };
        let found: Vec<_> = pairs.par_iter().with_max_len(1).map(compare).collect();
        let (point_parts, edge_parts): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let (point_triangle, edge_edge) = rayon::join(
            || sorted(&point_parts, self.query.start.len()),
            || sorted(&edge_parts, self.mesh.edges.len()),
        );
        Candidates { point_triangle, edge_edge }
    }

    /// Returns the candidates of `list` that are near during the motion and that `keep` takes. `keep` is asked with the triangles that own
    /// the two primitives; of a point-triangle pair the second is the triangle.
    pub fn filter(&self, list: &Candidates, keep: &(dyn Fn(u32, u32) -> bool + Sync)) -> Candidates {
        let (mesh, boxes, skip) = (self.mesh, self.boxes, self.query.skip);
        let point = |[p, f]: [u32; 2]| {
            let near = boxes.points[p as usize].near(
                &boxes.triangles[f as usize],
                self.box_distance,
                self.boxes_are_static(),
            );
            near && self.is_point_near(p, f)
                && keep(mesh.point_owner[p as usize], f)
                && !skip(mesh.point_triangle_pair(p, f))
        };
        let edge = |[e, f]: [u32; 2]| {
            let [a, b] = [e, f].map(|e| mesh.edge_owner[e as usize]);
            let near = boxes.edges[e as usize].near(
                &boxes.edges[f as usize],
                self.box_distance,
                self.boxes_are_static(),
            );
            near && self.is_edge_near(e, f) && keep(a, b) && !skip(mesh.edge_edge_pair(e, f))
        };
        list.filter(point, edge)
    }

    /// Adds the points of `triangle` whose boxes are near triangle `other`.
    #[inline(always)]
    fn shortlist_points(&self, triangle: u32, other: u32, list: &mut Shortlist) {
        let other_box = &self.boxes.triangles[other as usize];
        list.reserve(3);
        for p in self.mesh.triangles[triangle as usize].points() {
            let near =
                self.boxes.points[p as usize].near(other_box, self.box_distance, self.boxes_are_static());
            list.add_if([p, other], near);
        }
    }

    /// Adds the edges of `triangle` with the edges of triangle `other` whose boxes are near.
    #[inline(always)]
    fn shortlist_edges(&self, triangle: u32, other: u32, list: &mut Shortlist) {
        let others = &self.mesh.triangles[other as usize];
        list.reserve(9);
        for e in self.mesh.triangles[triangle as usize].edges() {
            let own_box = &self.boxes.edges[e as usize];
            for f in others.edges() {
                let near =
                    own_box.near(&self.boxes.edges[f as usize], self.box_distance, self.boxes_are_static());
                list.add_if([e, f], near);
            }
        }
    }

    /// Whether a point and a triangle can come near; a shared point excludes the pair.
    #[inline(always)]
    fn is_point_near(&self, point: u32, triangle: u32) -> bool {
        let corners = self.mesh.triangles[triangle as usize].corners;
        let squared = |[p]: [&Vec3; 1], [a, b, c]: [&Vec3; 3]| point_triangle_squared(p, a, b, c);
        !corners.contains(&point) && self.can_come_near([point], corners, squared)
    }

    /// Whether two edges can come near; a shared point excludes the pair.
    #[inline(always)]
    fn is_edge_near(&self, edge: u32, other: u32) -> bool {
        let (ends, others) = (self.mesh.edges[edge as usize], self.mesh.edges[other as usize]);
        let squared = |[a, b]: [&Vec3; 2], [c, d]: [&Vec3; 2]| edge_edge_squared(a, b, c, d);
        let shared = ends.iter().any(|p| others.contains(p));
        !shared && self.can_come_near(ends, others, squared)
    }

    /// Whether two primitives can come within the distance of the query: their distance now, less the longest displacement of a point of
    /// either. The longest is that of a corner, since inner points move by averages of corners. The two count separately and common
    /// motion is not deducted, because each point may move by another fraction of its displacement.
    #[inline(always)]
    fn can_come_near<const M: usize, const N: usize>(
        &self,
        own: [u32; M],
        others: [u32; N],
        squared: impl Fn([&Vec3; M], [&Vec3; N]) -> f64,
    ) -> bool {
        let limit = self.query.distance
            + match self.uniform_end {
                Some(end) => self.relative_displacement(end, &own, &others),
                None => self.max_displacement(&own) + self.max_displacement(&others),
            };
        let x = own.map(|p| &self.query.start[p as usize]);
        let y = others.map(|p| &self.query.start[p as usize]);
        squared(x, y) <= limit * limit
    }

    /// Returns the longest displacement of one of the points relative to one of the others \[m\], where all move by the same fraction.
    #[inline(always)]
    fn relative_displacement(&self, end: &[Vec3], own: &[u32], others: &[u32]) -> f64 {
        let start = self.query.start;
        let mut longest: f64 = 0.0;
        for &p in own {
            let displacement = end[p as usize] - start[p as usize];
            for &q in others {
                let relative = (displacement - (end[q as usize] - start[q as usize])).norm_squared();
                longest = longest.max(if relative.is_finite() { relative } else { 0.0 });
            }
        }
        longest.sqrt()
    }

    /// Returns the longest displacement of these points \[m\].
    #[inline(always)]
    fn max_displacement(&self, points: &[u32]) -> f64 {
        let lengths = &self.boxes.lengths;
        if lengths.is_empty() {
            return 0.0;
        }
        points.iter().map(|&p| lengths[p as usize]).fold(0.0, f64::max)
    }
}

/// Pairs whose boxes are near, before the exact test. They are collected first and tested then, and added without a branch, because which
/// box test passes cannot be predicted and a wrong guess costs more than the test.
struct Shortlist {
    pairs: Vec<[u32; 2]>,
    count: usize,
}

impl Shortlist {
    /// An empty list with room for that many pairs.
    fn with_room(pairs: usize) -> Self {
        Self { pairs: vec![[0; 2]; pairs], count: 0 }
    }

    /// Makes room for that many calls of [`Shortlist::add_if`].
    #[inline(always)]
    fn reserve(&mut self, more: usize) {
        if self.count + more > self.pairs.len() {
            self.pairs.resize(2 * self.pairs.len() + more, [0; 2]);
        }
    }

    #[inline(always)]
    fn add_if(&mut self, pair: [u32; 2], yes: bool) {
        self.pairs[self.count] = pair;
        self.count += usize::from(yes);
    }

    /// Puts the lower index of each pair first.
    fn order_pairs(&mut self) {
        self.pairs[..self.count]
            .iter_mut()
            .for_each(|pair| *pair = [pair[0].min(pair[1]), pair[0].max(pair[1])]);
    }

    /// Returns the pairs that pass the test.
    #[inline(always)]
    fn retain(mut self, test: impl Fn(u32, u32) -> bool) -> Vec<[u32; 2]> {
        let mut kept = 0;
        for k in 0..self.count {
            let pair = self.pairs[k];
            self.pairs[kept] = pair;
            kept += usize::from(test(pair[0], pair[1]));
        }
        self.pairs.truncate(kept);
        self.pairs
    }
}
