//! Bounding-volume hierarchy over the triangles of a mesh, refitted while the mesh moves.
//!
//! This module wraps parry's hierarchy; nothing else uses that package. The hierarchy is built once and refitted as points move; it is rebuilt
//! once they have moved far, because boxes that were near in the old shape no longer are. Results never depend on the history of the hierarchy:
//! pairs are sorted, and of several triangles at the same distance the first counts. Only `overlaps` sees its order, which is the
//! same for any number of threads.
//!
//! A triangle with a corner that is not finite is left out: it overlaps nothing and nothing finds it. Whoever moves
//! points checks them. Motion within a step is covered by boxes swept from start to end; the exact tests are in
//! `ccd` and `intersections`.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::distance::{ClosestPoints, point_triangle};
use crate::mesh::tuning::TUNING;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhLeafUpdateStatus, BvhNode};
use rayon::prelude::*;

/// Half width \[m\] of the inside-out box of a triangle that is left out; far, but its cube is still finite.
const LEFT_OUT_HALF_WIDTH: f64 = 1e100;
/// Fewest triangles that one task searches overlaps for.
const TRIANGLES_PER_TASK: usize = 256;
/// Relative widening of a ray's interval in a box, so that rounding never loses one it grazes.
const RAY_SLACK: f64 = 1e-14;

/// A hierarchy of boxes over the triangles of one mesh.
#[derive(Clone)]
pub struct TriangleBvh {
    triangles: Vec<[PointIndex; 3]>,
    bvh: Bvh,
    /// Positions when the hierarchy was last built \[m\], one per point.
    built_at: Vec<Vec3>,
    /// Mean largest side of the boxes when the hierarchy was last built \[m\].
    box_size: f64,
    /// Buffer of new boxes.
    updates: Vec<(Aabb, u32, f64)>,
    /// Buffer of the states of updated leaves.
    updated: Vec<BvhLeafUpdateStatus>,
}

/// Intersection of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The triangle.
    pub triangle: u32,
    /// Position along the ray, in lengths of its direction [-].
    pub t: f64,
    /// Barycentric coordinates of the hit in the triangle.
    pub weights: [f64; 3],
}

/// Triangle closest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestTriangle {
    /// The triangle.
    pub triangle: u32,
    /// Closest points of the point and the triangle; weights `[1, -wa, -wb, -wc]`.
    pub closest: ClosestPoints,
}

impl NearestTriangle {
    /// Barycentric coordinates of the closest point on the triangle [-].
    pub fn weights(&self) -> [f64; 3] {
        let [_, a, b, c] = self.closest.weights;
        [-a, -b, -c]
    }
}

impl TriangleBvh {
    /// A hierarchy over `triangles`; every box is grown by `inflate` \[m\] on all sides. `points` \[m\], one per point.
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]], inflate: f64) -> Self {
        let mut bvh = Self {
            triangles: triangles.to_vec(),
            bvh: Bvh::new(),
            built_at: Vec::new(),
            box_size: 0.0,
            updates: Vec::new(),
            updated: Vec::new(),
        };
        bvh.build(points);
        bvh.fit(points, points, inflate);
        bvh
    }

    /// Makes `known` a hierarchy over `triangles`, as [`Self::new`] does: refitted where it is one already. Returns it.
    pub fn fitted<'a>(
        known: &'a mut Option<Self>,
        points: &[Vec3],
        triangles: &[[PointIndex; 3]],
        inflate: f64,
    ) -> &'a Self {
        let mut bvh = match known.take() {
            Some(bvh) if bvh.is_over(triangles) => bvh,
            _ => return known.insert(Self::new(points, triangles, inflate)),
        };
        bvh.refit(points, points, inflate);
        known.insert(bvh)
    }

    /// Returns whether it is over exactly these triangles, in this order.
    pub fn is_over(&self, triangles: &[[PointIndex; 3]]) -> bool {
        self.triangles == triangles
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Fits the boxes to points that move from `start` to `end` \[m\] in straight lines, grown by `inflate` \[m\].
    pub fn refit(&mut self, start: &[Vec3], end: &[Vec3], inflate: f64) {
        let limit = TUNING.bvh_rebuild_motion * self.box_size;
        let moved = |(now, then): (&Vec3, &Vec3)| (now - then).norm_squared() > limit * limit;
        if start.len() != self.built_at.len() || start.iter().zip(&self.built_at).any(moved) {
            self.build(start);
        }
        self.fit(start, end, inflate);
    }

    fn build(&mut self, points: &[Vec3]) {
        self.built_at = points.to_vec();
        let boxes: Vec<Aabb> = self.triangles.par_iter().map(|t| swept_box(t, points, points, 0.0)).collect();
        let sizes = boxes.iter().map(|b| (b.maxs - b.mins).max_element()).filter(|&size| size >= 0.0);
        let (sum, count) = sizes.fold((0.0, 0usize), |(sum, count), size| (sum + size, count + 1));
        self.box_size = sum / count.max(1) as f64;
        let growth = Vector::splat(TUNING.bvh_build_growth * self.box_size);
        let grown = boxes.into_iter().map(|b| Aabb::new(b.mins - growth, b.maxs + growth)).enumerate();
        self.bvh = Bvh::from_iter(BvhBuildStrategy::Binned, grown);
    }

    fn fit(&mut self, start: &[Vec3], end: &[Vec3], inflate: f64) {
        // A margin of zero: the box is taken as it is. It is always present, as the hierarchy was built over all triangles.
        let update = |f: u32| (swept_box(&self.triangles[f as usize], start, end, inflate), f, 0.0);
        let all = (0..self.triangles.len() as u32).into_par_iter();
        all.map(update).collect_into_vec(&mut self.updates);
        self.bvh.insert_or_update_batch_partially_parallel(&self.updates, &mut self.updated);
        self.bvh.refit_without_opt();
    }

    /// Returns all pairs of different triangles whose boxes overlap, each once, in no order to rely on.
    pub fn overlaps(&self) -> Vec<(u32, u32)> {
        self.bvh.traverse_bvtt_single_tree_parallel::<false>()
    }

    /// Returns all pairs of different triangles whose boxes overlap, lower index first, sorted.
    pub fn overlapping_pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs: Vec<_> = self.overlaps().into_iter().map(|(a, b)| [a.min(b), a.max(b)]).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Returns all pairs (own, other) whose boxes overlap, sorted.
    pub fn overlapping_pairs_with(&self, other: &Self) -> Vec<[u32; 2]> {
        let of_own = |own: u32| {
            let own_box = self.bvh.leaf_node(own);
            let overlaps = |node: &BvhNode| own_box.is_some_and(|own| own.intersects(node));
            // The traversal does not test the children of the root.
            let is_leaf_near = |f: &u32| other.bvh.leaf_node(*f).is_some_and(overlaps);
            let mut others: Vec<u32> = other.bvh.leaves(overlaps).filter(is_leaf_near).collect();
            others.sort_unstable();
            others.into_iter().map(move |other| [own, other])
        };
        let own = (0..self.triangles.len() as u32).into_par_iter().with_min_len(TRIANGLES_PER_TASK);
        own.flat_map_iter(of_own).collect()
    }

    /// Returns the first triangle that the ray from `origin` \[m\] along `direction` (any length) meets within `max_t` lengths of
    /// the direction. `points` are those of the last fit. A hit on a common side belongs to the first triangle.
    pub fn first_hit(&self, points: &[Vec3], origin: Vec3, direction: Vec3, max_t: f64) -> Option<RayHit> {
        let ray = Ray::new(origin, direction)?;
        let at = |f: u32| ray.intersection(f, self.corners(points, f)).map(|hit| hit.t);
        let (found, nearest) =
            self.bvh.find_best(just_above(max_t), |n, best| ray.enters(n, best), |f, _| at(f))?;
        let reached = |node: &BvhNode| ray.enters(node, just_above(nearest)) < f64::MAX;
        let first = self.lowest_leaf(reached, |f| at(f) == Some(nearest)).unwrap_or(found);
        ray.intersection(first, self.corners(points, first))
    }

    /// Whether the ray meets any triangle within `max_t` lengths of the direction.
    pub fn any_hit(&self, points: &[Vec3], origin: Vec3, direction: Vec3, max_t: f64) -> bool {
        let Some(ray) = Ray::new(origin, direction) else { return false };
        let reached = |node: &BvhNode| ray.enters(node, just_above(max_t)) < f64::MAX;
        let hits = |f: u32| ray.intersection(f, self.corners(points, f)).is_some_and(|hit| hit.t <= max_t);
        self.bvh.leaves(reached).any(hits)
    }

    /// Returns the triangle closest to `point` \[m\], if one lies within `max_distance` \[m\]. `points` are those of the last fit.
    pub fn nearest(&self, points: &[Vec3], point: Vec3, max_distance: f64) -> Option<NearestTriangle> {
        self.nearest_where(points, point, max_distance, |_| true)
    }

    /// Returns the same among the triangles for which `accept` is true.
    pub fn nearest_where(
        &self,
        points: &[Vec3],
        point: Vec3,
        max_distance: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<NearestTriangle> {
        let closest = |f: u32| {
            let [a, b, c] = self.corners(points, f);
            point_triangle(&point, a, b, c)
        };
        let box_distance = |node: &BvhNode, _: f64| box_distance(node, &point);
        let distance_of = |f: u32| accept(f).then(|| closest(f).distance);
        let (found, distance) =
            self.bvh.find_best(just_above(max_distance), box_distance, |f, _| distance_of(f))?;
        let first = self
            .lowest_leaf(|node| box_distance(node, 0.0) <= distance, |f| distance_of(f) == Some(distance));
        let triangle = first.unwrap_or(found);
        Some(NearestTriangle { triangle, closest: closest(triangle) })
    }

    /// Returns the lowest triangle that passes `test`, among the boxes that pass `enter`.
    fn lowest_leaf(&self, enter: impl Fn(&BvhNode) -> bool, test: impl Fn(u32) -> bool) -> Option<u32> {
        self.bvh.leaves(enter).filter(|&f| test(f)).min()
    }

    fn corners<'a>(&self, points: &'a [Vec3], triangle: u32) -> [&'a Vec3; 3] {
        self.triangles[triangle as usize].map(|p| &points[p.at()])
    }
}

/// Returns the limit of a search that includes `limit`: searches look strictly below theirs.
fn just_above(limit: f64) -> f64 {
    if limit.is_finite() { limit.next_up() } else { f64::MAX }
}

/// Returns the box of a triangle whose corners move from `start` to `end`. An end that is not finite does not count: such a
/// point is kept where it is (`contact::step_bounds`).
fn swept_box(triangle: &[PointIndex; 3], start: &[Vec3], end: &[Vec3], inflate: f64) -> Aabb {
    let (mut low, mut high) = (Vector::splat(f64::INFINITY), Vector::splat(f64::NEG_INFINITY));
    let mut include = |x: &Vec3| {
        let x = Vector::new(x.x, x.y, x.z);
        (low, high) = (low.min(x), high.max(x));
    };
    for corner in triangle {
        let (from, to) = (&start[corner.at()], &end[corner.at()]);
        if !from.sum().is_finite() {
            return Aabb::new(Vector::splat(LEFT_OUT_HALF_WIDTH), Vector::splat(-LEFT_OUT_HALF_WIDTH));
        }
        include(from);
        if to.sum().is_finite() {
            include(to);
        }
    }
    Aabb::new(low - Vector::splat(inflate), high + Vector::splat(inflate))
}

fn box_distance(node: &BvhNode, point: &Vec3) -> f64 {
    let p = Vector::new(point.x, point.y, point.z);
    (node.mins() - p).max(p - node.maxs()).max(Vector::ZERO).length()
}

/// A ray prepared for many triangles: Woop, Benthin, Wald, "Watertight ray/triangle intersection" (2013).
struct Ray {
    origin: Vec3,
    direction: Vec3,
    /// Axes: the two minor ones, then the one along which the direction is largest.
    axes: [usize; 3],
    /// Direction along the minor axes over that along the major one [-].
    shear: [f64; 2],
}

impl Ray {
    /// A ray from `origin` \[m\]; `None` when the direction is zero or anything is not finite.
    fn new(origin: Vec3, direction: Vec3) -> Option<Self> {
        let major = direction.iamax();
        let axes = [(major + 1) % 3, (major + 2) % 3, major];
        let shear = [direction[axes[0]] / direction[major], direction[axes[1]] / direction[major]];
        let usable = (origin.sum() + direction.sum() + shear[0] + shear[1]).is_finite();
        usable.then_some(Self { origin, direction, axes, shear })
    }

    /// Returns the intersection with a triangle. Each corner is sheared on its own into the plane across the ray, and the sign of a difference of two products
    /// is never wrong, only sometimes zero, which counts: no ray slips between two triangles or past a point.
    fn intersection(&self, triangle: u32, corners: [&Vec3; 3]) -> Option<RayHit> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|corner| {
            let from = corner - self.origin;
            [from[x] - self.shear[0] * from[z], from[y] - self.shear[1] * from[z], from[z]]
        });
        let turn = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[1] - a[1] * b[0];
        let [a, b, c] = &sheared;
        let areas = [turn(b, c), turn(c, a), turn(a, b)];
        let sum: f64 = areas.iter().sum();
        let facing = if sum > 0.0 { 1.0 } else { -1.0 };
        if sum == 0.0 || !areas.iter().all(|area| area * facing >= 0.0) {
            return None;
        }
        let weights = areas.map(|area| area / sum);
        let t = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / self.direction[z];
        (t >= 0.0).then_some(RayHit { triangle, t, weights })
    }

    /// Returns the position where the ray enters the box, in lengths of its direction; `f64::MAX` when it misses it or enters beyond `max_t`.
    fn enters(&self, node: &BvhNode, max_t: f64) -> f64 {
        let (low, high) = (node.mins(), node.maxs());
        let (mut near, mut far) = (0.0f64, max_t);
        for axis in 0..3 {
            let (from, along) = (self.origin[axis], self.direction[axis]);
            if along == 0.0 {
                if !(low[axis] <= from && from <= high[axis]) {
                    return f64::MAX;
                }
                continue;
            }
            let (one, other) = ((low[axis] - from) / along, (high[axis] - from) / along);
            let (first, last) = if along > 0.0 { (one, other) } else { (other, one) };
            near = near.max(first - first.abs() * RAY_SLACK);
            far = far.min(last + last.abs() * RAY_SLACK);
        }
        if near <= far { near } else { f64::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;

    /// Loose triangles of size `size` in a unit cube.
    fn soup(rng: &mut Rng, count: usize, size: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let mut points = Vec::new();
        for _ in 0..count {
            let at = rng.in_unit_cube();
            points.extend((0..3).map(|_| at + rng.in_unit_cube() * size));
        }
        let triangles = (0..count as u32).map(|f| [0, 1, 2].map(|k| PointIndex(3 * f + k))).collect();
        (points, triangles)
    }

    /// A flat sheet of n x n squares of side 1/n.
    fn sheet(n: usize) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let points = (0..(n + 1) * (n + 1))
            .map(|i| Vec3::new((i % (n + 1)) as f64 / n as f64, (i / (n + 1)) as f64 / n as f64, 0.0))
            .collect();
        let mut triangles = Vec::new();
        for i in 0..n * n {
            let a = (i / n * (n + 1) + i % n) as u32;
            let (b, c, d) = (a + 1, a + n as u32 + 1, a + n as u32 + 2);
            triangles.push([a, b, d].map(PointIndex));
            triangles.push([a, d, c].map(PointIndex));
        }
        (points, triangles)
    }

    fn boxes_overlap(a: &Aabb, b: &Aabb) -> bool {
        a.mins.cmple(b.maxs).all() && b.mins.cmple(a.maxs).all()
    }

    fn brute(one: &[Aabb], other: Option<&[Aabb]>) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for i in 0..one.len() {
            let start = if other.is_some() { 0 } else { i + 1 };
            for j in start..other.unwrap_or(one).len() {
                if boxes_overlap(&one[i], &other.unwrap_or(one)[j]) {
                    pairs.push([i as u32, j as u32]);
                }
            }
        }
        pairs
    }

    #[test]
    fn overlaps_are_those_of_every_box_with_every_box() {
        let mut rng = Rng::from_state(3);
        for count in [0, 1, 2, 3, 7, 300] {
            let (start, triangles) = soup(&mut rng, count, 0.1);
            let (mut tree, other_count) = (TriangleBvh::new(&start, &triangles, 0.0), count / 2 + 1);
            let (other_points, other_triangles) = soup(&mut rng, other_count, 0.2);
            let other = TriangleBvh::new(&other_points, &other_triangles, 0.01);
            let other_boxes: Vec<Aabb> =
                other_triangles.iter().map(|t| swept_box(t, &other_points, &other_points, 0.01)).collect();
            let mut at = start;
            for _ in 0..6 {
                let end: Vec<Vec3> =
                    at.iter().map(|x| x + (rng.in_unit_cube() - rng.in_unit_cube()) * 0.1).collect();
                tree.refit(&at, &end, 0.02);
                let boxes: Vec<Aabb> = triangles.iter().map(|t| swept_box(t, &at, &end, 0.02)).collect();
                assert_eq!(tree.overlapping_pairs(), brute(&boxes, None));
                assert_eq!(tree.overlapping_pairs_with(&other), brute(&boxes, Some(&other_boxes)));
                at = end;
            }
        }
    }

    /// A flat sheet has boxes without volume, by which the package judges its splits.
    #[test]
    fn a_flat_sheet_meets_only_its_neighbours() {
        let (points, triangles) = sheet(40);
        let pairs = TriangleBvh::new(&points, &triangles, 0.0).overlapping_pairs();
        assert!(pairs.len() < 14 * triangles.len(), "{} of {}", pairs.len(), triangles.len());
        assert_eq!(pairs.len(), pairs.iter().collect::<std::collections::BTreeSet<_>>().len());
    }

    #[test]
    fn what_is_not_finite_is_left_out_and_harms_nobody() {
        let (mut points, triangles) = sheet(8);
        let whole = TriangleBvh::new(&points, &triangles, 0.0).overlapping_pairs();
        points[0].y = f64::NAN;
        let gone = |f: u32| triangles[f as usize].contains(&PointIndex(0));
        let expected: Vec<_> = whole.iter().filter(|p| !gone(p[0]) && !gone(p[1])).copied().collect();
        let tree = TriangleBvh::new(&points, &triangles, 0.0);
        assert_eq!(tree.overlapping_pairs(), expected);
        assert_eq!(tree.overlapping_pairs_with(&tree).len(), 2 * expected.len() + triangles.len() - 2);
        assert!(tree.nearest(&points, Vec3::new(0.0, 0.0, 1.0), f64::INFINITY).is_some());
        assert!(tree.first_hit(&points, Vec3::new(0.5, 0.4, 1.0), -Vec3::z(), f64::INFINITY).is_some());
        let nowhere = vec![Vec3::repeat(f64::INFINITY); points.len()];
        let empty = TriangleBvh::new(&nowhere, &triangles, 1.0);
        assert!(empty.overlapping_pairs().is_empty());
        assert!(empty.nearest(&nowhere, Vec3::zeros(), f64::INFINITY).is_none());
    }

    #[test]
    fn nearest_is_that_of_all_triangles_and_keeps_to_its_limit() {
        let mut rng = Rng::from_state(4);
        let (points, triangles) = soup(&mut rng, 500, 0.1);
        let tree = TriangleBvh::new(&points, &triangles, 0.03);
        for _ in 0..300 {
            let p = rng.in_unit_cube() * 1.4;
            let all: Vec<f64> = (0..500)
                .map(|f| point_triangle(&p, &points[3 * f], &points[3 * f + 1], &points[3 * f + 2]).distance)
                .collect();
            let least = all.iter().copied().fold(f64::INFINITY, f64::min);
            let found = tree.nearest(&points, p, f64::INFINITY).map(|n| (n.triangle, n.closest.distance));
            let index = all.iter().position(|&d| d == least).map(|i| (i as u32, least));
            assert_eq!(found, index);
            assert_eq!(tree.nearest(&points, p, least).map(|n| n.triangle), index.map(|i| i.0));
            assert_eq!(tree.nearest(&points, p, least * 0.999), None);
        }
        let (points, triangles) = sheet(4);
        let corner = Vec3::new(0.5, 0.5, 0.2);
        let first = triangles.iter().position(|t| t.iter().any(|p| points[p.at()].xy() == corner.xy()));
        let found = TriangleBvh::new(&points, &triangles, 0.0).nearest(&points, corner, 1.0);
        assert_eq!(found.map(|n| n.triangle as usize), first, "of equals the first");
    }

    #[test]
    fn rays_find_the_first_triangle_and_never_slip_through_a_sheet() {
        let (mut points, triangles) = sheet(20);
        let mut rng = Rng::from_state(5);
        points.iter_mut().for_each(|x| x.z = 0.05 * rng.uniform());
        let tree = TriangleBvh::new(&points, &triangles, 0.0);
        for k in 0..2_000 {
            // Many aimed exactly at points and sides.
            let target = match k % 3 {
                0 => points[22 + k % 300],
                1 => (points[22 + k % 300] + points[23 + k % 300]) / 2.0,
                _ => Vec3::new(0.1 + 0.8 * rng.uniform(), 0.1 + 0.8 * rng.uniform(), 0.0),
            };
            if !(0.04..0.96).contains(&target.x) || !(0.04..0.96).contains(&target.y) {
                continue;
            }
            let direction = if k % 2 == 0 { -Vec3::z() } else { (target - rng.in_unit_cube()) - Vec3::z() };
            let origin = target - direction * 2.0;
            let hit = tree.first_hit(&points, origin, direction, f64::INFINITY);
            let Some(hit) = hit else { panic!("slipped through at {target}") };
            let at: Vec3 =
                (0..3).map(|i| points[triangles[hit.triangle as usize][i].at()] * hit.weights[i]).sum();
            assert!((origin + direction * hit.t - at).norm() < 1e-12);
            let ray = Ray::new(origin, direction);
            let all = (0..triangles.len() as u32)
                .filter_map(|f| ray.as_ref().and_then(|r| r.intersection(f, tree.corners(&points, f))));
            let least = all.map(|h| h.t).fold(f64::INFINITY, f64::min);
            assert_eq!(hit.t, least);
            assert!(tree.any_hit(&points, origin, direction, least));
            assert!(!tree.any_hit(&points, origin, direction, least * 0.999));
            assert!(tree.first_hit(&points, origin, direction, least * 0.999).is_none());
            assert!(tree.first_hit(&points, origin, -direction, f64::INFINITY).is_none());
        }
    }

    #[test]
    fn far_motion_builds_the_tree_anew() {
        let (points, triangles) = sheet(30);
        let mut tree = TriangleBvh::new(&points, &triangles, 0.0);
        // Rolled up, so that points far apart come near.
        let rolled: Vec<Vec3> = points
            .iter()
            .map(|x| {
                Vec3::new(
                    (0.1 + 0.02 * x.x) * (25.0 * x.x).cos(),
                    x.y,
                    (0.1 + 0.02 * x.x) * (25.0 * x.x).sin(),
                )
            })
            .collect();
        tree.refit(&rolled, &rolled, 0.001);
        assert_eq!(tree.built_at, rolled);
        assert_eq!(
            tree.overlapping_pairs(),
            TriangleBvh::new(&rolled, &triangles, 0.001).overlapping_pairs()
        );
    }
}
