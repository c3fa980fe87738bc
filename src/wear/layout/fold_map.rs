//! The map of a fold: a stack of layers wrapped around an axis, every layer kept at its own length.
//!
//! In the plane across the fold line, with `s` the distance from the line along the layer and `r` its depth below the
//! axis, a layer turned by `phi` runs on a circle of radius r around the axis up to s = phi r and goes on straight:
//!
//! ```text
//! (outward, up) = r (sin a, -cos a), a = s / r                              s <= phi r
//! (outward, up) = r (sin phi, -cos phi) + (s - phi r) (cos phi, sin phi)    else
//! ```
//!
//! Layers of different depth stay concentric, so none cross at any angle and none stretch; they slide on one another as
//! the pages of a bent book do. The map and its inverse serve `fold` and `unfold`.

use crease_geometry::math::Vec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Distance of the middle of the bend of a layer at `depth` [m] below the axis, turned by half a turn, from the line where the
/// bend begins [m].
pub(crate) fn bend_middle(depth: f64) -> f64 {
    0.5 * PI * depth
}

/// Distance by which bends begin before the fold line, so that the middle of the bend of a stack of `height` [m] lies on it [m]: the
/// stack bends over half its circumference.
pub(crate) fn line_shift(height: f64) -> f64 {
    0.25 * PI * height
}

/// The axis that layers are turned around.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct FoldAxis {
    /// A point of the axis [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Unit vector along it, level.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub along: Vec3,
    /// Unit vector towards the flap at angle 0, level.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub outward: Vec3,
    /// Smallest depth [m]: a layer at the axis itself would have a corner.
    pub min_depth: f64,
}

/// A point on a layer [m].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct FoldCoords {
    /// Coordinate along the axis.
    along: f64,
    /// Distance from the line along the layer.
    pub s: f64,
    /// Depth of the layer below the axis.
    pub depth: f64,
}

impl FoldAxis {
    /// Coordinates of a point at `p` [m], when the layers are turned by `phi` [rad].
    pub fn to_fold_coords(self, p: &Vec3, phi: f64) -> FoldCoords {
        let arm = p - self.origin;
        let (outward, up) = (arm.dot(&self.outward), arm.y);
        let along = arm.dot(&self.along);
        let depth = outward * phi.sin() - up * phi.cos();
        let beyond = outward * phi.cos() + up * phi.sin();
        if beyond >= 0.0 {
            let depth = depth.max(self.min_depth);
            FoldCoords { along, s: beyond + phi * depth, depth }
        } else {
            let angle = outward.atan2(-up).clamp(0.0, phi);
            let depth = outward.hypot(up).max(self.min_depth);
            FoldCoords { along, s: angle * depth, depth }
        }
    }

    /// Unit normal of the layer at `coords`, when the layers are turned by `phi` [rad].
    pub fn normal(&self, coords: &FoldCoords, phi: f64) -> Vec3 {
        let angle = if coords.s < phi * coords.depth { coords.s / coords.depth } else { phi };
        self.outward * angle.sin() - Vec3::y() * angle.cos()
    }

    /// Position [m] of `coords`, when the layers are turned by `phi` [rad].
    pub fn folded(&self, coords: &FoldCoords, phi: f64) -> Vec3 {
        let r = coords.depth;
        let angle = if coords.s < phi * r { coords.s / r } else { phi };
        let straight = (coords.s - phi * r).max(0.0);
        let outward = r * angle.sin() + straight * phi.cos();
        let up = -r * angle.cos() + straight * phi.sin();
        self.origin + self.along * coords.along + self.outward * outward + Vec3::y() * up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> FoldAxis {
        FoldAxis { origin: Vec3::new(0.2, 0.01, 0.0), along: Vec3::z(), outward: Vec3::x(), min_depth: 1e-4 }
    }

    #[test]
    fn the_inverse_returns_the_point() {
        let axis = axis();
        for phi in [0.0, 0.7, 2.0, std::f64::consts::PI] {
            for (s, depth) in [(0.001, 0.002), (0.004, 0.002), (0.3, 0.008), (0.05, 0.0001)] {
                let flat = axis.origin + Vec3::new(s, -depth, 0.3);
                let folded = axis.folded(&axis.to_fold_coords(&flat, 0.0), phi);
                let back = axis.folded(&axis.to_fold_coords(&folded, phi), 0.0);
                assert!((back - flat).norm() < 1e-12, "{phi} {s} {depth}: {back} {flat}");
            }
        }
    }

    #[test]
    fn layers_keep_their_length_and_their_order() {
        let axis = axis();
        let at = |s: f64, depth: f64, phi: f64| {
            axis.folded(&axis.to_fold_coords(&(axis.origin + Vec3::new(s, -depth, 0.0)), 0.0), phi)
        };
        let phi = std::f64::consts::PI;
        for depth in [0.001, 0.004] {
            let length: f64 = (0..1000)
                .map(|k| {
                    (at(f64::from(k + 1) * 1e-4, depth, phi) - at(f64::from(k) * 1e-4, depth, phi)).norm()
                })
                .sum();
            assert!((length - 0.1).abs() < 1e-5, "{length}");
        }
        // The deeper layer ends up outside: higher after half a turn.
        assert!(at(0.1, 0.004, phi).y - at(0.1, 0.001, phi).y > 0.0029);
    }
}
