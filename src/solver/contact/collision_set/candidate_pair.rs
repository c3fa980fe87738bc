//! A primitive pair that may come near, with what its barrier depends on.

use crate::contact::broad_phase::{PairKind, PrimitivePair};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::distance::ClosestPoints;

/// A pair that may come near.
#[derive(Debug, Clone, Copy)]
pub(super) struct CandidatePair {
    pub points: [u32; 4],
    pub kind: PairKind,
    /// Activation distance [m]: shorter for pairs that are near by construction (beside a seam) or were at the start.
    pub dhat: f64,
    /// Area that the pair stands for [m²].
    pub area: f64,
    /// Whether barrier and step bounds leave it out because it intersects.
    pub ignored: bool,
}

impl CandidatePair {
    /// Returns the positions of the four points.
    #[inline]
    pub fn gather(&self, x: &[Vec3]) -> [Vec3; 4] {
        self.points.map(|p| x[p as usize])
    }

    /// Returns the closest points at `x` [m].
    #[inline]
    pub fn closest_points(&self, x: &[Vec3]) -> ClosestPoints {
        self.kind.closest_points(&self.gather(x))
    }

    /// Returns the primitives alone.
    pub fn primitives(&self) -> PrimitivePair {
        PrimitivePair { kind: self.kind, points: self.points.map(PointIndex) }
    }
}
