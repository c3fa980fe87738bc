//! Linear air drag: a force -c m v, as the incremental potential E = c/(2 h) sum m_i |x_i - start_i|² of a step of h
//! seconds.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

/// Air drag during one step.
pub struct Drag<'a> {
    /// Masses, one per point [kg].
    pub mass: &'a [f64],
    /// Positions from which velocities are measured, one per point [m].
    pub start: &'a [Vec3],
    /// Drag rate over the effective time step: c / h [1/s²].
    pub rate: f64,
}

impl Energy for Drag<'_> {
    fn name(&self) -> &'static str {
        "drag"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        x.iter()
            .zip(self.start)
            .zip(self.mass)
            .map(|((x, s), m)| 0.5 * self.rate * m * (x - s).norm_squared())
            .sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for (((x, s), m), g) in x.iter().zip(self.start).zip(self.mass).zip(out) {
            *g += (x - s) * (self.rate * m);
        }
    }

    fn add_hessian(&self, _x: &[Vec3], out: &mut dyn BlockSink) {
        for (p, m) in self.mass.iter().enumerate() {
            out.add(p as u32, p as u32, &(Mat3::identity() * (self.rate * m)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match() {
        let start = [Vec3::zeros(), Vec3::new(0.1, 0.0, 0.0)];
        let x = [Vec3::new(0.01, 0.02, 0.0), Vec3::new(0.1, -0.01, 0.03)];
        check_gradient_and_hessian(&Drag { mass: &[1.0, 2.0], start: &start, rate: 5.0 }, &x, 1e-5);
    }
}
