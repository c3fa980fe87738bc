//! A multiple of the identity added to the Hessian and to nothing else: equilibria of loose parts become well posed.

use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;
use crease_solver::energy::Energy;

/// Adds this to every diagonal entry of the Hessian [N/m]; value and gradient stay as they are.
pub struct HessianShift(pub f64);

impl Energy for HessianShift {
    fn name(&self) -> &'static str {
        "hessian shift"
    }

    fn value(&self, _x: &[Vec3]) -> f64 {
        0.0
    }

    fn add_gradient(&self, _x: &[Vec3], _out: &mut [Vec3]) {}

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        (0..x.len() as u32).for_each(|p| out.add(p, p, &(Mat3::identity() * self.0)));
    }
}
