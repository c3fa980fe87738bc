//! Tether that keeps a shape in its source pose, soft over small displacements and stiff beyond,
//!
//! ```text
//! E = sum_i k_i (r_i²/2 + c max(r_i - f, 0)³ / (3 f)),     r_i = |x_i - X_i|
//! ```
//!
//! with the free distance f: up to there it is a linear spring, so that cloth beside a crease stays flat.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// Tether between points and their source positions.
#[derive(Debug, Clone, Copy)]
pub struct PoseTether<'a> {
    /// Source positions, one per point [m].
    pub source: &'a [Vec3],
    /// Stiffness of small displacements, one per point [N/m].
    pub stiffness: &'a [f64],
    /// Displacement up to which the tether is linear [m]; 0 or an infinite one for a linear tether.
    pub free: f64,
    /// Growth c of the stiffness beyond that [-].
    pub growth: f64,
}

impl PoseTether<'_> {
    /// Displacement of point `p`, with its length and the part of that beyond the free one [m].
    fn arm(&self, p: usize, x: &Vec3) -> (Vec3, f64, f64) {
        let arm = x - self.source[p];
        let length = arm.norm();
        let beyond = if self.free > 0.0 { (length - self.free).max(0.0) } else { 0.0 };
        (arm, length, beyond)
    }

    fn growth_per_free(&self) -> f64 {
        if self.free > 0.0 { self.growth / self.free } else { 0.0 }
    }
}

impl Energy for PoseTether<'_> {
    fn name(&self) -> &'static str {
        "pose tether"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let growth = self.growth_per_free();
        let of_point = |(p, x): (usize, &Vec3)| {
            let (_, length, beyond) = self.arm(p, x);
            self.stiffness[p] * (0.5 * length * length + growth * beyond.powi(3) / 3.0)
        };
        x.iter().enumerate().map(of_point).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        let growth = self.growth_per_free();
        for (p, x) in x.iter().enumerate() {
            let (arm, length, beyond) = self.arm(p, x);
            let more = if beyond > 0.0 { growth * beyond * beyond / length } else { 0.0 };
            out[p] += arm * (self.stiffness[p] * (1.0 + more));
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        let growth = self.growth_per_free();
        for (p, x) in x.iter().enumerate() {
            let (arm, length, beyond) = self.arm(p, x);
            let mut block = Mat3::identity();
            if beyond > 0.0 {
                let across = growth * beyond * beyond / length;
                let unit = arm / length;
                block +=
                    Mat3::identity() * across + unit * unit.transpose() * (2.0 * growth * beyond - across);
            }
            out.add(p as u32, p as u32, &(block * self.stiffness[p]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match() {
        let source = [Vec3::zeros(), Vec3::new(0.1, 0.2, 0.3)];
        let (stiffness, free, growth) = ([5.0, 2.0], 0.01, 6.0);
        let tether = PoseTether { source: &source, stiffness: &stiffness, free, growth };
        let x = [Vec3::new(2e-3, -4e-3, 1e-3), Vec3::new(0.11, 0.19, 0.32)];
        check_gradient_and_hessian(&tether, &x, 1e-6);
    }

    #[test]
    fn a_displacement_beyond_the_free_one_is_held_harder() {
        let source = [Vec3::zeros()];
        let force = |free: f64| {
            let tether = PoseTether { source: &source, stiffness: &[1.0], free, growth: 6.0 };
            let mut out = [Vec3::zeros()];
            tether.add_gradient(&[Vec3::x() * 0.02], &mut out);
            out[0].norm()
        };
        assert!((force(0.01) - 0.08).abs() < 1e-12, "{}", force(0.01));
        assert_eq!((force(0.0), force(0.03), force(f64::INFINITY)), (0.02, 0.02, 0.02));
    }
}
