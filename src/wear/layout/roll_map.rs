//! The map of a roll: a stack of layers wound up into a spiral that rolls along the ground.
//!
//! In the plane across the axis, with `s` the distance along a layer from the side where the roll begins, `h` its height in the
//! stack and `u` the length rolled up so far, what is beyond (s >= u) lies flat and all else is on an Archimedean spiral around the
//! axis at (u, R(u)):
//!
//! ```text
//! R(u)² = R_0² + p u / pi                                        p: thickness of a winding, R_0: radius of the core
//! (forward, up) = (u, R(u)) - rho (sin a, cos a)                 rho = R(u) - h - p a / (2 pi)
//! a(s) = (2 pi / p) (R(u) - h - sqrt((R(u) - h)² - p (u - s) / pi))
//! ```
//!
//! The area of the stack stays what it is. Each layer keeps its own length: the inner ones reach farther around, as the pages of a
//! rolled book do. Layers at the same angle keep their order, and windings lie `p` apart: none cross. The map serves `roll` and
//! `unfold`.

use crate::wear::motion::motion_profile::PEAK_RATE;
use crate::wear::motion::springs::carry_spring;
use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_solver::energy::TargetSpring;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A roll along the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct RollMap {
    /// A point on the ground below the side where the roll begins [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Unit vector along the axis, level.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub along: Vec3,
    /// Unit vector in which the roll proceeds, level.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub forward: Vec3,
    /// Radius of the core [m].
    pub core: f64,
    /// Thickness of a winding [m].
    pub pitch: f64,
}

/// A point on a layer [m].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct RollCoords {
    /// Coordinate along the axis.
    pub along: f64,
    /// Distance along the layer from the side where the roll begins.
    pub s: f64,
    /// Height above the ground while the layer lies flat.
    pub height: f64,
}

impl RollCoords {
    /// The point in the middle between two.
    pub fn middle(a: &Self, b: &Self) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        Self { along: mean(a.along, b.along), s: mean(a.s, b.s), height: mean(a.height, b.height) }
    }
}

impl RollMap {
    /// Smallest radius of the core [m] with which the inmost layers of a stack of `length` and thickness `pitch` [m] have room.
    pub fn min_core(length: f64, pitch: f64) -> f64 {
        // R_0² >= 2 p R(L), solved for R_0².
        let squared = 2.0 * pitch * pitch + (4.0 * pitch.powi(4) + 4.0 * pitch.powi(3) * length / PI).sqrt();
        squared.sqrt()
    }

    /// Coordinates of a point at `p` [m] of the stack that lies flat.
    pub fn coords(&self, p: &Vec3) -> RollCoords {
        let arm = p - self.origin;
        RollCoords { along: arm.dot(&self.along), s: arm.dot(&self.forward), height: arm.y }
    }

    /// Radius of the outermost winding of a rolled length `u` [m].
    pub fn radius(&self, u: f64) -> f64 {
        (self.core * self.core + self.pitch * u.max(0.0) / PI).sqrt()
    }

    /// Angle [rad] behind the line of contact, and distance from the axis [m], of `at` with the length `u` [m] rolled up.
    fn polar(&self, at: &RollCoords, u: f64) -> (f64, f64) {
        let outer = self.radius(u) - at.height;
        let rolled = (u - at.s).max(0.0);
        // Cloth that stands up above the stack would come to the axis itself.
        let least = 0.25 * self.pitch * self.pitch;
        let rho = (outer * outer - self.pitch * rolled / PI).max(least).sqrt();
        (2.0 * PI / self.pitch * (outer - rho), rho)
    }

    /// Position [m] of `at` with the length `u` [m] rolled up.
    pub fn rolled(&self, at: &RollCoords, u: f64) -> Vec3 {
        let base = self.origin + self.along * at.along;
        if at.s >= u {
            return base + self.forward * at.s + Vec3::y() * at.height;
        }
        let (angle, rho) = self.polar(at, u);
        base + self.forward * (u - rho * angle.sin()) + Vec3::y() * (self.radius(u) - rho * angle.cos())
    }

    /// Unit normal of the layer at `at`, towards the axis, with the length `u` [m] rolled up.
    pub fn normal(&self, at: &RollCoords, u: f64) -> Vec3 {
        let angle = if at.s >= u { 0.0 } else { self.polar(at, u).0 };
        self.forward * angle.sin() + Vec3::y() * angle.cos()
    }
}

/// A roll that has been made and not opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RollRecord {
    /// The spiral.
    pub(crate) map: RollMap,
    /// Length that was rolled up [m].
    pub(crate) length: f64,
    /// Places in the roll, one per point.
    pub(crate) coords: Vec<RollCoords>,
}

impl RollRecord {
    /// The number of points that are rolled up: all of the garment.
    pub fn point_count(&self) -> usize {
        self.coords.len()
    }

    /// Adds the points in the middle between two points each, in order.
    pub fn add_middles(&mut self, splits: &[[u32; 2]]) {
        for [a, b] in splits {
            self.coords.push(RollCoords::middle(&self.coords[*a as usize], &self.coords[*b as usize]));
        }
    }

    /// The spring that carries point `p` of `mass` [kg] with the length `u` [m] rolled up.
    pub(crate) fn spring(&self, p: usize, u: f64, mass: f64) -> TargetSpring {
        let at = &self.coords[p];
        carry_spring(p as u32, self.map.rolled(at, u), self.map.normal(at, u), mass)
    }

    /// Mean distance [m] of the points at `x` [m] from their places with the length `u` [m] rolled up, weighted with
    /// `masses` [kg].
    pub(crate) fn mean_distance(&self, x: &[Vec3], u: f64, masses: &[f64]) -> f64 {
        let points = self.coords.iter().zip(x).zip(masses);
        let sum: f64 = points.map(|((at, x), m)| m * (self.map.rolled(at, u) - x).norm()).sum();
        sum / masses.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// Fraction of the path from the roll to where they lay before it that the points at `x` [m] have covered, weighted with `masses`
    /// \[kg\] \[-\]; 1 for a path of no length.
    pub(crate) fn unrolled_fraction(&self, x: &[Vec3], masses: &[f64]) -> f64 {
        let rolled: Vec<Vec3> = self.coords.iter().map(|at| self.map.rolled(at, self.length)).collect();
        let path = self.mean_distance(&rolled, 0.0, masses);
        if path > 0.0 { 1.0 - self.mean_distance(x, 0.0, masses) / path } else { 1.0 }
    }

    /// Longest step [s] of rolling all of it within `over` seconds.
    pub(crate) fn max_dt(&self, over: f64) -> f64 {
        TUNING.roll.max_turn_per_step * self.map.core * over / (PEAK_RATE * self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> RollMap {
        RollMap {
            origin: Vec3::new(0.1, 0.0, 0.2),
            along: Vec3::z(),
            forward: Vec3::x(),
            core: 0.03,
            pitch: 0.004,
        }
    }

    #[test]
    fn layers_keep_their_length() {
        let map = map();
        for height in [0.0, 0.0015, 0.003] {
            for u in [0.02, 0.15, 0.5] {
                let at = |s: f64| map.rolled(&RollCoords { along: 0.0, s, height }, u);
                let steps = 20_000;
                let ds = 0.5 / f64::from(steps);
                let length: f64 =
                    (0..steps).map(|k| (at(ds * f64::from(k + 1)) - at(ds * f64::from(k))).norm()).sum();
                // A spiral is longer than its angle times its radius by (p / 2 pi rho)² / 2.
                assert!((length - 0.5).abs() < 4e-4, "{height} {u}: {length}");
            }
        }
    }

    #[test]
    fn windings_and_layers_stay_apart_above_the_ground() {
        let map = map();
        let u = 0.6;
        let points: Vec<(f64, f64, Vec3)> = [0.0, 0.0015, 0.003]
            .iter()
            .flat_map(|&height| (0..600).map(move |k| (height, 0.001 * f64::from(k))))
            .map(|(height, s)| (height, s, map.rolled(&RollCoords { along: 0.0, s, height }, u)))
            .collect();
        for (height, s, x) in &points {
            assert!(x.y >= *height - 1e-12, "{height} {s}");
            let others = points.iter().filter(|(other, t, _)| other != height || (t - s).abs() > 0.01);
            let nearest = others.map(|(_, _, y)| (x - y).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest > 0.0008, "{height} {s}: {nearest}");
        }
    }

    #[test]
    fn a_layer_goes_on_where_the_roll_ends_and_its_normal_points_to_the_axis() {
        let map = map();
        let u = 0.3;
        let at = |s: f64| RollCoords { along: 0.05, s, height: 0.001 };
        assert!((map.rolled(&at(u - 1e-9), u) - map.rolled(&at(u), u)).norm() < 1e-8);
        let axis = map.origin + map.along * 0.05 + map.forward * u + Vec3::y() * map.radius(u);
        for s in [0.0, 0.1, 0.29] {
            let x = map.rolled(&at(s), u);
            assert!(((axis - x).normalize() - map.normal(&at(s), u)).norm() < 1e-9);
            let back = map.coords(&map.rolled(&at(s), 0.0));
            assert!((back.s - s).abs() < 1e-12 && (back.height - 0.001).abs() < 1e-12);
        }
    }

    #[test]
    fn points_that_come_lie_between_their_neighbours() {
        let at = |s: f64| RollCoords { along: 0.1, s, height: 0.001 };
        let mut record = RollRecord { map: map(), length: 0.5, coords: vec![at(0.1), at(0.12)] };
        // The second split is of an edge that the first has made.
        record.add_middles(&[[0, 1], [1, 2]]);
        assert_eq!(record.point_count(), 4);
        for (p, s) in [(2, 0.11), (3, 0.115)] {
            let there = record.map.rolled(&at(s), 0.5);
            assert!((record.map.rolled(&record.coords[p], 0.5) - there).norm() < 1e-9);
        }
    }

    #[test]
    fn a_thick_stack_needs_a_wide_core() {
        for (length, pitch) in [(0.7, 0.004), (0.5, 0.01), (2.0, 0.02)] {
            let map = RollMap { core: RollMap::min_core(length, pitch), pitch, ..map() };
            // The top of the inmost end is off the axis.
            let (_, rho) = map.polar(&RollCoords { along: 0.0, s: 0.0, height: pitch }, length);
            assert!(rho >= pitch * 0.9, "{length} {pitch}: {rho}");
        }
    }
}
