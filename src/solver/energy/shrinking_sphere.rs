//! A shrinking sphere that encloses the cloth, as hands that crumple it: points outside are pushed towards the centre.
//! With the depth d_i = max(0, |x_i - c| - R), stiffness k_i and maximum force m_i,
//!
//! ```text
//! E = sum k_i/2 d_i²  up to the depth m_i / k_i, then m_i d_i - m_i²/(2 k_i)
//! ```

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// A spherical wall during one step.
pub struct ShrinkingSphere<'a> {
    /// Centre of the sphere [m].
    pub centre: Vec3,
    /// Radius of the sphere [m].
    pub radius: f64,
    /// Stiffness of the wall, one per point [N/m].
    pub stiffness: &'a [f64],
    /// Maximum force of the wall, one per point [N].
    pub max_force: &'a [f64],
}

impl ShrinkingSphere<'_> {
    /// Returns every point outside the sphere.
    fn outside<'b>(&'b self, x: &'b [Vec3]) -> impl Iterator<Item = OutsidePoint> + 'b {
        let all = x.iter().zip(self.stiffness).zip(self.max_force).enumerate();
        let outside = all.map(|(point, ((x, stiffness), max_force))| {
            let arm = x - self.centre;
            OutsidePoint { point, arm, distance: arm.norm(), stiffness: *stiffness, max_force: *max_force }
        });
        outside.filter(|o| o.distance > self.radius)
    }

    /// Returns the force on a point outside [N].
    fn force(&self, o: &OutsidePoint) -> f64 {
        (o.stiffness * (o.distance - self.radius)).min(o.max_force)
    }
}

/// A point outside the sphere.
struct OutsidePoint {
    point: usize,
    /// Vector from the centre to the point [m].
    arm: Vec3,
    /// Length of `arm` [m].
    distance: f64,
    /// [N/m].
    stiffness: f64,
    /// [N].
    max_force: f64,
}

impl Energy for ShrinkingSphere<'_> {
    fn name(&self) -> &'static str {
        "shrinking sphere"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let energy = |o: OutsidePoint| {
            let (depth, k, max) = (o.distance - self.radius, o.stiffness, o.max_force);
            if k * depth <= max { 0.5 * k * depth * depth } else { max * (depth - 0.5 * max / k) }
        };
        self.outside(x).map(energy).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for o in self.outside(x) {
            out[o.point] += o.arm * (self.force(&o) / o.distance);
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for o in self.outside(x) {
            let force = self.force(&o);
            let along = o.arm * o.arm.transpose() / (o.distance * o.distance);
            let across = (Mat3::identity() - along) * (force / o.distance);
            let spring = if force < o.max_force { along * o.stiffness } else { Mat3::zeros() };
            out.add(o.point as u32, o.point as u32, &(spring + across));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

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
        // Beyond its maximum the force stays constant, and the energy is continuously differentiable.
        let term = ShrinkingSphere { max_force: &[0.2, 9.0], ..term };
        check_gradient_and_hessian(&term, &x, 1e-6);
        let mut pushed = vec![Vec3::zeros(); 2];
        term.add_gradient(&x, &mut pushed);
        assert!((pushed[0].norm() - 0.2).abs() < 1e-12);
    }
}
