//! The map of a fold: a stack of sheets wrapped around an axis, every sheet kept at its own length.
//!
//! In the plane across the fold line, with `s` the way from the line along the sheet and `r` its depth below the
//! axis, a sheet turned by `phi` runs on a circle of radius r around the axis up to s = phi r and goes on straight:
//!
//! ```text
//! (out, up) = r (sin a, -cos a), a = s / r                              s <= phi r
//! (out, up) = r (sin phi, -cos phi) + (s - phi r) (cos phi, sin phi)    else
//! ```
//!
//! Sheets of different depth stay concentric, so none cross at any angle and none stretch; they slide on one
//! another as the pages of a bent book do. The map and its inverse serve `fold` and `unfold`.

use crate::math::Vec3;
use serde::{Deserialize, Serialize};

/// An axis to turn sheets around.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Axis {
    /// A point of the axis [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Unit vector along it, level.
    #[serde(with = "crate::math::serde_vec::vector")]
    pub along: Vec3,
    /// Unit vector towards the flap at angle 0, level.
    #[serde(with = "crate::math::serde_vec::vector")]
    pub out: Vec3,
    /// Least depth [m]: a sheet at the axis itself would have a corner.
    pub least_depth: f64,
}

/// A place on a sheet: along the axis, along the sheet, below the axis [m].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct OnSheet {
    along: f64,
    pub s: f64,
    pub depth: f64,
}

impl Axis {
    /// Where on its sheet a point at `p` is, when the sheets are turned by `phi` [rad].
    pub fn on_sheet(&self, p: &Vec3, phi: f64) -> OnSheet {
        let arm = p - self.origin;
        let (out, up) = (arm.dot(&self.out), arm.y);
        let along = arm.dot(&self.along);
        let depth = out * phi.sin() - up * phi.cos();
        let beyond = out * phi.cos() + up * phi.sin();
        if beyond >= 0.0 {
            let depth = depth.max(self.least_depth);
            OnSheet { along, s: beyond + phi * depth, depth }
        } else {
            let angle = out.atan2(-up).clamp(0.0, phi);
            let depth = out.hypot(up).max(self.least_depth);
            OnSheet { along, s: angle * depth, depth }
        }
    }

    /// Unit normal of the sheet at a place, when the sheets are turned by `phi` [rad].
    pub fn normal(&self, place: &OnSheet, phi: f64) -> Vec3 {
        let angle = if place.s < phi * place.depth { place.s / place.depth } else { phi };
        self.out * angle.sin() - Vec3::y() * angle.cos()
    }

    /// Where a place on a sheet is when the sheets are turned by `phi` [rad].
    pub fn turned(&self, place: &OnSheet, phi: f64) -> Vec3 {
        let r = place.depth;
        let angle = if place.s < phi * r { place.s / r } else { phi };
        let straight = (place.s - phi * r).max(0.0);
        let out = r * angle.sin() + straight * phi.cos();
        let up = -r * angle.cos() + straight * phi.sin();
        self.origin + self.along * place.along + self.out * out + Vec3::y() * up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Axis {
        Axis { origin: Vec3::new(0.2, 0.01, 0.0), along: Vec3::z(), out: Vec3::x(), least_depth: 1e-4 }
    }

    #[test]
    fn the_inverse_brings_points_back() {
        let axis = axis();
        for phi in [0.0, 0.7, 2.0, std::f64::consts::PI] {
            for (s, depth) in [(0.001, 0.002), (0.004, 0.002), (0.3, 0.008), (0.05, 0.0001)] {
                let flat = axis.origin + Vec3::new(s, -depth, 0.3);
                let place = axis.on_sheet(&flat, 0.0);
                let there = axis.turned(&place, phi);
                let back = axis.turned(&axis.on_sheet(&there, phi), 0.0);
                assert!((back - flat).norm() < 1e-12, "{phi} {s} {depth}: {back} {flat}");
            }
        }
    }

    #[test]
    fn sheets_keep_their_length_and_their_order() {
        let axis = axis();
        let at = |s: f64, depth: f64, phi: f64| {
            axis.turned(&axis.on_sheet(&(axis.origin + Vec3::new(s, -depth, 0.0)), 0.0), phi)
        };
        let phi = std::f64::consts::PI;
        for depth in [0.001, 0.004] {
            let way: f64 = (0..1000)
                .map(|k| {
                    (at(f64::from(k + 1) * 1e-4, depth, phi) - at(f64::from(k) * 1e-4, depth, phi)).norm()
                })
                .sum();
            assert!((way - 0.1).abs() < 1e-5, "{way}");
        }
        // The deeper sheet ends up outside: higher after a half turn.
        assert!(at(0.1, 0.004, phi).y - at(0.1, 0.001, phi).y > 0.0029);
    }
}
