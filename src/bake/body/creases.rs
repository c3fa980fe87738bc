//! Where a body will crease the cloth: near the parts of it that deform, which is where its joints bend.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, triangle};
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::garment::Garment;

/// The cloth that a body will crease.
pub(in crate::bake) struct CreasedCloth {
    /// Corners and middles of its triangles [m]; empty where no part of the body deforms near the garment.
    pub positions: Vec<Vec3>,
    /// Mean edge of its triangles [m], that of the garment where there are none: a file is often fine only where it bends.
    pub mean_edge: f64,
}

impl CreasedCloth {
    /// Finds the triangles of `garment` near parts of the body that deform in any of `poses`: all of them where the poses are not known.
    pub fn new(garment: &Garment, animated: &AnimatedBody, poses: &[BodyPose]) -> Self {
        let triangles = match poses {
            [] => garment.triangles.clone(),
            _ => near_deforming(garment, animated, &deforming_triangles(animated, poses)),
        };
        let corners = |t| triangle::corners(&garment.points, t);
        let mean_edge = match triangles.len() {
            0 => garment.mean_edge(),
            count => triangles.iter().map(|t| triangle::mean_side(&corners(t))).sum::<f64>() / count as f64,
        };
        let mut is_corner = vec![false; garment.points.len()];
        triangles.iter().flatten().for_each(|p| is_corner[p.at()] = true);
        let own = garment.points.iter().zip(&is_corner).filter(|(_, is_corner)| **is_corner).map(|(x, _)| *x);
        let positions = own.chain(triangles.iter().map(|t| middle(&corners(t)))).collect();
        Self { positions, mean_edge }
    }
}

/// Triangles of `garment` with a corner or their middle near one of the triangles `deforming` of the body. Middles count, too, as
/// triangles of a file may be long.
fn near_deforming(
    garment: &Garment,
    animated: &AnimatedBody,
    deforming: &[[PointIndex; 3]],
) -> Vec<[PointIndex; 3]> {
    if deforming.is_empty() {
        return Vec::new();
    }
    let start = animated.rest_points();
    let tree = TriangleBvh::new(start, deforming, 0.0);
    let is_near = |x: &Vec3| tree.nearest(start, *x, TUNING.body_creases.max_body_distance).is_some();
    let near: Vec<bool> = garment.points.iter().map(is_near).collect();
    let is_creased = |t: &&[PointIndex; 3]| {
        t.iter().any(|p| near[p.at()]) || is_near(&middle(&triangle::corners(&garment.points, t)))
    };
    garment.triangles.iter().filter(is_creased).copied().collect()
}

fn middle([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (a + b + c) / 3.0
}

/// Triangles of the body that any of `poses` strains.
fn deforming_triangles(animated: &AnimatedBody, poses: &[BodyPose]) -> Vec<[PointIndex; 3]> {
    let start = animated.rest_points();
    let mut deforms = vec![false; animated.triangles().len()];
    for pose in poses {
        let posed = animated.points(pose);
        for (deforms, triangle) in deforms.iter_mut().zip(animated.triangles()) {
            *deforms = *deforms || strain(start, &posed, triangle) > TUNING.body_creases.min_body_strain;
        }
    }
    animated.triangles().iter().zip(&deforms).filter(|(_, deforms)| **deforms).map(|(t, _)| *t).collect()
}

/// Largest relative change of an edge of a triangle between two sets of positions [-].
fn strain(from: &[Vec3], to: &[Vec3], triangle: &[PointIndex; 3]) -> f64 {
    let edge = |x: &[Vec3], k: usize| (x[triangle[k].at()] - x[triangle[(k + 1) % 3].at()]).norm();
    let change = |k: usize| (edge(to, k) / edge(from, k).max(f64::MIN_POSITIVE) - 1.0).abs();
    (0..3).map(change).fold(0.0, f64::max)
}
