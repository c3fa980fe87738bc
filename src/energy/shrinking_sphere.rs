//! A ball that closes around the cloth (crumpling hands): points outside are pushed in, with the depth
//! d_i = max(0, |x_i - c| - R) and no more than hands can,
//!
//! ```text
//! E = sum k_i/2 d_i²  up to the depth m_i / k_i, then m_i d_i - m_i²/(2 k_i)
//! ```

use crate::energy::{BlockSink, Energy};
use crate::math::{Mat3, Vec3};

/// A spherical container.
pub struct ShrinkingSphere<'a> {
    /// Centre [m].
    pub centre: Vec3,
    /// Radius [m].
    pub radius: f64,
    /// One per point [N/m].
    pub stiffness: &'a [f64],
    /// Force at most, one per point [N].
    pub max_force: &'a [f64],
}

impl ShrinkingSphere<'_> {
    /// Every point outside: its number, its way from the centre [m], how long that is [m], its stiffness [N/m], and the
    /// force at most [N].
    fn outside<'b>(&'b self, x: &'b [Vec3]) -> impl Iterator<Item = (usize, Vec3, f64, f64, f64)> + 'b {
        let all = x.iter().zip(self.stiffness).zip(self.max_force).enumerate();
        let outside = all.map(|(i, ((x, k), most))| {
            let arm = x - self.centre;
            (i, arm, arm.norm(), *k, *most)
        });
        outside.filter(|(_, _, distance, ..)| *distance > self.radius)
    }
}

impl Energy for ShrinkingSphere<'_> {
    fn name(&self) -> &'static str {
        "container"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let energy = |distance: f64, k: f64, most: f64| {
            let depth = distance - self.radius;
            if k * depth <= most { 0.5 * k * depth * depth } else { most * (depth - 0.5 * most / k) }
        };
        self.outside(x).map(|(_, _, distance, k, most)| energy(distance, k, most)).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for (i, arm, distance, k, most) in self.outside(x) {
            out[i] += arm * ((k * (distance - self.radius)).min(most) / distance);
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for (i, arm, distance, k, most) in self.outside(x) {
            let force = (k * (distance - self.radius)).min(most);
            let along = arm * arm.transpose() / (distance * distance);
            let across = (Mat3::identity() - along) * (force / distance);
            let spring = if force < most { along * k } else { Mat3::zeros() };
            out.add(i as u32, i as u32, &(spring + across));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::energy_checks::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn gradient_and_hessian_match() {
        let term = ShrinkingSphere {
            centre: Vec3::new(0.1, 0.0, 0.0),
            radius: 0.2,
            stiffness: &[3.0, 4.0],
            max_force: &[9.0, 9.0],
        };
        let x = [Vec3::new(0.4, 0.1, -0.2), Vec3::new(0.2, 0.05, 0.0)];
        check_gradient_and_hessian(&term, &x, 1e-6);
        // Beyond its most the force stays as it is, and the energy joins smoothly.
        let term = ShrinkingSphere { max_force: &[0.2, 9.0], ..term };
        check_gradient_and_hessian(&term, &x, 1e-6);
        let mut pushed = vec![Vec3::zeros(); 2];
        term.add_gradient(&x, &mut pushed);
        assert!((pushed[0].norm() - 0.2).abs() < 1e-12);
    }
}
