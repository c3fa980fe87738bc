//! Where a body will crease the cloth: near the parts of it that deform, which is where its joints bend.

use crate::bake::tuning::TUNING;
use crate::body::{AnimatedBody, BodyPose};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::triangle_bvh::TriangleBvh;

/// Positions on `garment` [m] that lie near parts of the body that deform in any of `poses`. All of them where the poses are not known.
pub(super) fn creased_positions(garment: &Garment, animated: &AnimatedBody, poses: &[BodyPose]) -> Vec<Vec3> {
    if poses.is_empty() {
        return garment.points.clone();
    }
    let tuning = &TUNING.body_creases;
    let start = animated.rest_points();
    let mut deforms = vec![false; animated.triangles().len()];
    for pose in poses {
        let posed = animated.points(pose);
        for (deforms, triangle) in deforms.iter_mut().zip(animated.triangles()) {
            *deforms = *deforms || strain(start, &posed, triangle) > tuning.min_body_strain;
        }
    }
    let triangles: Vec<[PointIndex; 3]> =
        animated.triangles().iter().zip(&deforms).filter(|(_, deforms)| **deforms).map(|(t, _)| *t).collect();
    if triangles.is_empty() {
        return Vec::new();
    }
    let tree = TriangleBvh::new(start, &triangles, 0.0);
    // The middles of triangles, too: those of a file may be long.
    let corners = garment.triangles.iter().map(|t| t.map(|p| garment.points[p.at()]));
    let middles = corners.map(|[a, b, c]| (a + b + c) / 3.0);
    let all = garment.points.iter().copied().chain(middles);
    all.filter(|x| tree.nearest(start, *x, tuning.max_body_distance).is_some()).collect()
}

/// Largest relative change of an edge of a triangle between two sets of positions [-].
fn strain(from: &[Vec3], to: &[Vec3], triangle: &[PointIndex; 3]) -> f64 {
    let edge = |x: &[Vec3], k: usize| (x[triangle[k].at()] - x[triangle[(k + 1) % 3].at()]).norm();
    let change = |k: usize| (edge(to, k) / edge(from, k).max(f64::MIN_POSITIVE) - 1.0).abs();
    (0..3).map(change).fold(0.0, f64::max)
}
