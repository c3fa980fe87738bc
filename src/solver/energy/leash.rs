//! Leashes: points that may move freely within a distance of an anchor and are drawn back outside it,
//!
//! ```text
//! E = k/2 max(0, |x - a| - r)²
//! ```
//!
//! for the anchor a and the radius r; a radius of 0 holds the point. The energy is convex. Engines call r the maximum
//! distance of a skinned cloth. `bake::leash` chooses anchors and radii.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// Leash of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leash {
    /// Index of the point.
    pub point: u32,
    /// Centre of the sphere in which the point is free [m].
    pub anchor: Vec3,
    /// Radius of that sphere [m].
    pub radius: f64,
    /// Stiffness outside it [N/m].
    pub stiffness: f64,
}

impl Leash {
    /// Returns the distance of `x` outside the sphere [m], and the unit vector from the anchor; `None` within it.
    pub fn excess(&self, x: &Vec3) -> Option<(f64, Vec3)> {
        let arm = x - self.anchor;
        let length = arm.norm();
        (length > self.radius).then(|| (length - self.radius, arm / length))
    }

    fn hessian(&self, x: &Vec3) -> Option<Mat3> {
        if self.radius == 0.0 {
            return Some(Mat3::identity() * self.stiffness);
        }
        let (excess, along) = self.excess(x)?;
        let outer = along * along.transpose();
        let across = excess / (excess + self.radius);
        Some((outer + (Mat3::identity() - outer) * across) * self.stiffness)
    }
}

/// All leashes of one step as an energy term.
pub struct Leashes<'a>(pub &'a [Leash]);

impl Energy for Leashes<'_> {
    fn name(&self) -> &'static str {
        "leashes"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let excess = |leash: &Leash| Some((leash.stiffness, leash.excess(&x[leash.point as usize])?.0));
        self.0.iter().filter_map(excess).map(|(stiffness, excess)| 0.5 * stiffness * excess * excess).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for leash in self.0 {
            if let Some((excess, along)) = leash.excess(&x[leash.point as usize]) {
                out[leash.point as usize] += along * (leash.stiffness * excess);
            }
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for leash in self.0 {
            if let Some(block) = leash.hessian(&x[leash.point as usize]) {
                out.add(leash.point, leash.point, &block);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match() {
        let leash = |point, radius| Leash { point, anchor: Vec3::new(0.1, 0.2, 0.3), radius, stiffness: 7.0 };
        let all = [leash(0, 0.05), leash(1, 0.0), leash(2, 0.5)];
        let x = [Vec3::new(0.2, 0.1, 0.25), Vec3::new(0.13, 0.2, 0.31), Vec3::zeros()];
        check_gradient_and_hessian(&Leashes(&all), &x, 1e-6);
        let mut gradient = [Vec3::zeros(); 3];
        Leashes(&all).add_gradient(&x, &mut gradient);
        assert_eq!(gradient[2], Vec3::zeros(), "within its leash a point is free");
    }

    /// A point on its anchor has no direction, and no force.
    #[test]
    fn a_held_point_in_place_has_no_energy() {
        let held = [Leash { point: 0, anchor: Vec3::x(), radius: 0.0, stiffness: 1.0 }];
        let mut gradient = [Vec3::zeros()];
        Leashes(&held).add_gradient(&[Vec3::x()], &mut gradient);
        assert_eq!((Leashes(&held).value(&[Vec3::x()]), gradient[0]), (0.0, Vec3::zeros()));
    }
}
