//! Primitive pairs: a point and a triangle, or two edges.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::ccd::{edge_edge_step, point_triangle_step, stay_apart_on_an_axis};
use crease_geometry::mesh::distance::{ClosestPoints, edge_edge, point_triangle};
use serde::{Deserialize, Serialize};

/// Kind of a primitive pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum PairKind {
    /// A point and a triangle.
    PointTriangle,
    /// Two edges.
    EdgeEdge,
}

/// A primitive pair as its four points: the point and the corners of the triangle, or the ends of the two edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitivePair {
    /// Kind of the pair that the points form.
    pub kind: PairKind,
    /// The four points.
    pub points: [PointIndex; 4],
}

impl PrimitivePair {
    /// Returns the entries of the four points in `field`, which has one per point.
    #[inline]
    pub fn gather(&self, field: &[Vec3]) -> [Vec3; 4] {
        self.points.map(|p| field[p.at()])
    }

    /// Returns the distance of the two primitives at `positions` \[m\].
    pub fn distance(&self, positions: &[Vec3]) -> f64 {
        self.kind.closest_points(&self.gather(positions)).distance
    }

    /// Returns the largest fraction of `displacement` \[m\] from `positions` \[m\] that keeps the pair farther apart than
    /// `min_distance` \[m\] (`mesh::ccd`).
    #[inline]
    pub fn collision_free_step_size(
        &self,
        positions: &[Vec3],
        displacement: &[Vec3],
        min_distance: f64,
    ) -> f64 {
        let (x, dx) = (self.gather(positions), self.gather(displacement));
        match self.kind {
            PairKind::PointTriangle => point_triangle_step(x, dx, min_distance),
            PairKind::EdgeEdge => edge_edge_step(x, dx, min_distance),
        }
    }
}

impl PairKind {
    /// Returns the closest points of a pair of this kind at `x` \[m\].
    #[inline]
    pub fn closest_points(self, x: &[Vec3; 4]) -> ClosestPoints {
        match self {
            Self::PointTriangle => point_triangle(&x[0], &x[1], &x[2], &x[3]),
            Self::EdgeEdge => edge_edge(&x[0], &x[1], &x[2], &x[3]),
        }
    }

    /// Whether the bounding boxes of the two primitives at `x` \[m\] are more than `distance` \[m\] apart along an axis. Then so are the
    /// primitives.
    #[inline]
    pub fn apart_on_an_axis(self, x: &[Vec3; 4], distance: f64) -> bool {
        stay_apart_on_an_axis(x, &[Vec3::zeros(); 4], distance, self == Self::PointTriangle)
    }
}
