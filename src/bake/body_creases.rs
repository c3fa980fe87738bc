//! Where a body will crease the cloth: near the parts of it that deform, which is where its joints bend.

use crate::bake::tuning::TUNING;
use crate::body::{AnimatedBody, BodyPose};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, triangle};

/// The cloth that a body will crease.
pub(super) struct CreasedCloth {
    /// Corners and middles of its triangles [m]; empty where no part of the body deforms near the garment.
    pub positions: Vec<Vec3>,
    /// Mean edge of its triangles [m], that of the garment where there are none: a file is often fine only where it bends.
    pub mean_edge: f64,
}

impl CreasedCloth {
    /// Finds the triangles of `garment` near parts of the body that deform in any of `poses`: all of them where the poses are not known.
    pub fn new(garment: &Garment, animated: &AnimatedBody, poses: &[BodyPose]) -> Self {
        let corners = |t: &[PointIndex; 3]| triangle::corners(&garment.points, t);
        let middle = |[a, b, c]: [Vec3; 3]| (a + b + c) / 3.0;
        // The middles of triangles, too: those of a file may be long.
        let places = |t: &[PointIndex; 3]| {
            let corners = corners(t);
            corners.into_iter().chain([middle(corners)])
        };
        let mut creased: Vec<[PointIndex; 3]> = garment.triangles.clone();
        if !poses.is_empty() {
            let start = animated.rest_points();
            let deforming = deforming_triangles(animated, poses);
            if deforming.is_empty() {
                creased.clear();
            } else {
                let tree = TriangleBvh::new(start, &deforming, 0.0);
                let reach = TUNING.body_creases.max_body_distance;
                creased.retain(|t| places(t).any(|x| tree.nearest(start, x, reach).is_some()));
            }
        }
        let sides = |t| {
            let [a, b, c] = corners(t);
            [a - b, b - c, c - a].map(|side| side.norm()).iter().sum::<f64>() / 3.0
        };
        let mean_edge = match creased.len() {
            0 => garment.mean_edge(),
            count => creased.iter().map(sides).sum::<f64>() / count as f64,
        };
        Self { positions: creased.iter().flat_map(places).collect(), mean_edge }
    }
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
