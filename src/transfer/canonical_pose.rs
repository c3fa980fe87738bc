//! Canonical pose of a garment for comparison: upright, its box centred. The x axis points to the left of a person in it, y
//! up, z to the front.
//!
//! A garment that lies in its file (much lower than it is wide and long, as `lay` decides it) is turned upright, its
//! upper end first. Boxes can then be made equal axis by axis, so that a point keeps its fractions of the box, which is
//! also how wear scripts name positions. The depth of a garment that lies flat says nothing about a body: it is scaled
//! like the other axes.

use crate::transfer::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3, bounds};
use crease_model::garment::is_flat_across;
use crease_model::remesh::GarmentSurface;

/// Map from file coordinates to the canonical pose, and the box there.
#[derive(Debug, Clone, Copy)]
pub(super) struct CanonicalPose {
    /// Rotation from file directions to canonical ones.
    pub rotation: Mat3,
    /// Centre of the box after the rotation [m].
    pub centre: Vec3,
    /// Sides of the box after the rotation [m].
    pub size: Vec3,
    /// Whether the garment has no depth to speak of.
    pub flat: bool,
}

impl CanonicalPose {
    /// The canonical pose of `surface`.
    pub fn of(surface: &GarmentSurface) -> Self {
        let (low, high) = bounds(&surface.points);
        let size = high - low;
        let rotation = if is_flat_across(&size, 1) {
            Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
        } else {
            Mat3::identity()
        };
        let size = (rotation * size).abs();
        let flat = is_flat_across(&size, 2);
        Self { rotation, centre: rotation * (0.5 * (low + high)), size, flat }
    }

    /// Canonical coordinates of `point`, the centre of the box at the origin [m].
    pub fn canonical_point(&self, point: &Vec3) -> Vec3 {
        self.rotation * point - self.centre
    }

    /// Scale per axis that turns this garment's box into that of `target`.
    pub fn scale_to(&self, target: &Self) -> Vec3 {
        let min_size = Vec3::repeat(TUNING.min_box_side);
        let ratio = target.size.sup(&min_size).component_div(&self.size.sup(&min_size));
        let depth = if self.flat || target.flat { (ratio.x * ratio.y).sqrt() } else { ratio.z };
        Vec3::new(ratio.x, ratio.y, depth)
    }

    /// `surface` in canonical coordinates, scaled per axis by `scale`. Warp directions scale with the cloth.
    pub fn apply(&self, surface: &GarmentSurface, scale: Vec3) -> GarmentSurface {
        let point = |p: &Vec3| self.canonical_point(p).component_mul(&scale);
        let warp = |w: &Vec3| {
            let scaled = (self.rotation * w).component_mul(&scale);
            scaled.try_normalize(0.0).unwrap_or_else(Vec3::x)
        };
        GarmentSurface {
            points: surface.points.iter().map(point).collect(),
            warp: surface.warp.as_ref().map(|all| all.iter().map(warp).collect()),
            ..surface.clone()
        }
    }
}
