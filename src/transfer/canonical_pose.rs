//! Garments set up to be compared: both standing (x to the wearer's left, y up, front to +z), the source's box laid over
//! the target's.
//!
//! A garment that lies in its file (as `lay` decides it: much lower than it is wide and long) is stood up, its upper end
//! first. Boxes are then made equal axis by axis, so that a place keeps its fractions of the box, which is also how wear
//! scripts name places. The depth of a garment that lies flat says nothing about a body: it is scaled like the rest.

use crate::garment::{Footprint, is_lying};
use crate::math::{Mat3, Vec3, bounds};
use crate::transfer::GarmentSurface;

/// Thinner than this share of its other sides, a garment is flat, and lying if that side is upright.
const FLAT: f64 = 0.25;
/// Least side that is scaled [m].
const LEAST: f64 = 1e-6;

/// How a garment stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stance {
    /// Takes file directions to standing ones.
    pub(super) turn: Mat3,
    /// Middle of the box once standing [m].
    pub(super) middle: Vec3,
    /// Sides of the box once standing [m].
    pub(super) size: Vec3,
    /// Whether it has no depth to speak of.
    pub(super) flat: bool,
}

impl Stance {
    /// How `sheet` stands.
    pub(super) fn of(sheet: &GarmentSurface) -> Self {
        let (low, high) = bounds(&sheet.points);
        let size = high - low;
        let turn = if is_lying(&size, Footprint::Shorter, FLAT) {
            Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)
        } else {
            Mat3::identity()
        };
        let size = (turn * size).abs();
        Self { turn, middle: turn * (0.5 * (low + high)), size, flat: size.z < FLAT * size.x.min(size.y) }
    }

    /// `point` standing, the box's middle at the origin [m].
    pub(super) fn place(&self, point: &Vec3) -> Vec3 {
        self.turn * point - self.middle
    }

    /// Scale by which this garment's box becomes that of `target`.
    pub(super) fn scale_to(&self, target: &Self) -> Vec3 {
        let ratio = target.size.sup(&Vec3::repeat(LEAST)).component_div(&self.size.sup(&Vec3::repeat(LEAST)));
        let depth = if self.flat || target.flat { (ratio.x * ratio.y).sqrt() } else { ratio.z };
        Vec3::new(ratio.x, ratio.y, depth)
    }
}

/// `sheet` standing, its box's middle at the origin, scaled by `scale`.
pub(super) fn stand(sheet: &GarmentSurface, stance: &Stance, scale: Vec3) -> GarmentSurface {
    let place = |p: &Vec3| stance.place(p).component_mul(&scale);
    // Directions of the warp scale with the cloth.
    let turn_warp = |w: &Vec3| {
        let scaled = (stance.turn * w).component_mul(&scale);
        scaled.try_normalize(0.0).unwrap_or_else(Vec3::x)
    };
    GarmentSurface {
        points: sheet.points.iter().map(place).collect(),
        warp: sheet.warp.as_ref().map(|all| all.iter().map(turn_warp).collect()),
        ..sheet.clone()
    }
}
