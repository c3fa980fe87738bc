//! Result of coarsening a garment: the coarse mesh and its relation to the source.

use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::PointIndex;

/// Coarser mesh of a garment.
#[derive(Debug, Clone)]
pub struct CoarseMesh {
    /// Coarse garment. Its `source_point` is empty: no vertex of the file has a point of it.
    pub garment: Garment,
    /// Per coarse point: its point of the source.
    pub source_point: Vec<PointIndex>,
    /// Per coarse triangle: the identical triangle of the source; `None` for triangles that were modified.
    pub unchanged_from: Vec<Option<u32>>,
    /// Per source point: the coarse triangle that contains it, or one of those around it if it remains.
    pub containing_triangle: Vec<u32>,
    /// Per source point: its position in that triangle.
    pub(super) barycentric: Vec<BarycentricPosition>,
}

/// Position in a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct BarycentricPosition {
    /// Corners.
    pub(super) corners: [PointIndex; 3],
    /// Weights of the corners, 0 to 1, with sum 1.
    pub(super) weights: [f64; 3],
}

impl CoarseMesh {
    /// Returns the positions [m] of all source points when the coarse points are at `x` [m]: points that were removed lie
    /// in their triangles.
    pub fn interpolate(&self, x: &[Vec3]) -> Vec<Vec3> {
        let position =
            |b: &BarycentricPosition| (0..3).map(|k| x[b.corners[k].at()] * b.weights[k]).sum::<Vec3>();
        self.barycentric.iter().map(position).collect()
    }
}
