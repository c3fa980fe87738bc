//! Search for the triangle of a surface that is nearest to a place on the same side of the cloth.

use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::triangle::{self, corners};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;

/// Triangles of a surface that are searched, with their sides.
pub(super) struct SidedSearch<'a> {
    points: &'a [Vec3],
    bvh: TriangleBvh,
    normals: Vec<Option<Vec3>>,
}

impl<'a> SidedSearch<'a> {
    pub fn new(points: &'a [Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        let normal = |t: &[PointIndex; 3]| triangle::normal(&corners(points, t));
        let bvh = TriangleBvh::new(points, triangles, 0.0);
        Self { points, bvh, normals: triangles.iter().map(normal).collect() }
    }

    /// The triangle nearest to `x` within `max_distance` [m] that faces about as `normal` does; any where one of both is unknown.
    pub fn nearest(&self, x: Vec3, max_distance: f64, normal: Option<Vec3>) -> Option<u32> {
        let agrees = |f: u32| match (self.normals[f as usize], normal) {
            (Some(a), Some(b)) => a.dot(&b) > TUNING.min_start_cosine,
            _ => true,
        };
        self.bvh.nearest_where(self.points, x, max_distance, agrees).map(|nearest| nearest.triangle)
    }

    /// The triangle nearest to `x`, whatever its side.
    pub fn nearest_of_any_side(&self, x: Vec3) -> Option<u32> {
        self.bvh.nearest(self.points, x, f64::INFINITY).map(|nearest| nearest.triangle)
    }
}
