//! Where a body will crease the cloth: near the parts of it that deform, which is where its joints bend.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, triangle};
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::garment::Garment;
use crease_model::remesh::Seed;
use rustc_hash::FxHashSet;

/// The cloth that a body will crease.
pub(in crate::bake) struct CreasedCloth {
    /// Corners of its triangles [m]; empty where no part of the body deforms near the garment.
    pub triangles: Vec<[Vec3; 3]>,
}

impl CreasedCloth {
    /// Finds the triangles of `garment` near parts of the body that deform in any of `poses`: all of them where the poses are not known.
    pub fn new(garment: &Garment, animated: &AnimatedBody, poses: &[BodyPose]) -> Self {
        let triangles = match poses {
            [] => garment.triangles.clone(),
            _ => near_deforming(garment, animated, &deforming_triangles(animated, poses)),
        };
        Self { triangles: triangles.iter().map(|t| triangle::corners(&garment.points, t)).collect() }
    }

    /// Length of edges with which it has at most `count` points [m].
    pub fn edge_for(&self, count: usize) -> f64 {
        let twice_area: f64 = self.triangles.iter().map(|x| triangle::area_vector(x).norm()).sum();
        // Equilateral triangles of side l have one point per sqrt(3)/2 l² of area.
        (twice_area / (3f64.sqrt() * count as f64)).sqrt()
    }

    /// Seeds of edges of `length` [m] all over it, one in each cell of a grid of that width.
    pub fn seeds(&self, length: f64) -> Vec<Seed> {
        let mut taken = FxHashSet::default();
        let mut seeds = Vec::new();
        for [a, b, c] in &self.triangles {
            let count = (triangle::longest_side(&[*a, *b, *c]) / length).ceil().max(1.0);
            for i in 0..=count as u32 {
                for j in 0..=count as u32 - i {
                    let position = a + (b - a) * (f64::from(i) / count) + (c - a) * (f64::from(j) / count);
                    if taken.insert([position.x, position.y, position.z].map(|x| (x / length).floor() as i64))
                    {
                        seeds.push(Seed { position, length });
                    }
                }
            }
        }
        seeds
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
