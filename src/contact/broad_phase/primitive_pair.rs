//! A point and a triangle, or two edges: how far apart they are, and how far they may go.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::ccd::{edge_edge_step, point_triangle_step, stay_apart_on_an_axis};
use crate::mesh::distance::{ClosestPoints, edge_edge, point_triangle};
use serde::{Deserialize, Serialize};

/// The two kinds of primitive pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum PairKind {
    /// A point and a triangle.
    PointTriangle,
    /// Two edges.
    EdgeEdge,
}

/// A primitive pair as its four points: the point and the triangle's corners, or the ends of the two edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitivePair {
    /// Which pair the points form.
    pub kind: PairKind,
    /// Into positions of one array: when two meshes meet, those of the second follow those of the first.
    pub points: [PointIndex; 4],
}

impl PrimitivePair {
    /// The values of the four points in `field`, one per point.
    #[inline]
    pub fn gather(&self, field: &[Vec3]) -> [Vec3; 4] {
        self.points.map(|p| field[p.at()])
    }

    /// The closest points at positions `points` \[m\].
    #[inline]
    pub fn gap(&self, points: &[Vec3]) -> ClosestPoints {
        self.kind.gap(&self.gather(points))
    }

    /// The largest safe fraction of the motion `displacement` \[m\] (`mesh::motion`) that keeps the pair above `floor`
    /// \[m\].
    #[inline]
    pub fn step(&self, points: &[Vec3], displacement: &[Vec3], floor: f64) -> f64 {
        self.kind.step(self.gather(points), self.gather(displacement), floor)
    }
}

impl PairKind {
    /// The closest points of a pair of this kind at `x` \[m\].
    #[inline]
    pub fn gap(self, x: &[Vec3; 4]) -> ClosestPoints {
        match self {
            Self::PointTriangle => point_triangle(&x[0], &x[1], &x[2], &x[3]),
            Self::EdgeEdge => edge_edge(&x[0], &x[1], &x[2], &x[3]),
        }
    }

    /// Whether the boxes of the two pieces at `x` \[m\] are more than `reach` \[m\] apart on some axis: then so are they.
    #[inline]
    pub fn apart_on_an_axis(self, x: &[Vec3; 4], reach: f64) -> bool {
        stay_apart_on_an_axis(x, &[Vec3::zeros(); 4], reach, self == Self::PointTriangle)
    }

    /// The largest safe fraction of the motion `dx` \[m\] of a pair of this kind at `x` \[m\] (`mesh::motion`).
    #[inline]
    pub fn step(self, x: [Vec3; 4], dx: [Vec3; 4], floor: f64) -> f64 {
        match self {
            Self::PointTriangle => point_triangle_step(x, dx, floor),
            Self::EdgeEdge => edge_edge_step(x, dx, floor),
        }
    }
}

/// Distance \[m\] of a pair in the rest shape. Where it is less than the contact distance the pair lies close together
/// within the cloth itself, and contact must act from a smaller distance only, or it would push at rest.
pub fn rest_distance(kind: PairKind, points: [PointIndex; 4], rest_points: &[Vec3]) -> f64 {
    PrimitivePair { kind, points }.gap(rest_points).distance
}
