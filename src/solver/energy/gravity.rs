//! Gravity: E = -sum m_i g . x_i.

use crate::energy::term::Energy;
use crease_geometry::math::Vec3;
use crease_linear::BlockSink;

/// Uniform gravity on every point.
pub struct Gravity<'a> {
    /// Masses, one per point [kg].
    pub mass: &'a [f64],
    /// Acceleration of gravity [m/s²].
    pub acceleration: Vec3,
}

impl Energy for Gravity<'_> {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        -x.iter().zip(self.mass).map(|(x, m)| m * self.acceleration.dot(x)).sum::<f64>()
    }

    fn add_gradient(&self, _x: &[Vec3], out: &mut [Vec3]) {
        for (g, m) in out.iter_mut().zip(self.mass) {
            *g -= self.acceleration * *m;
        }
    }

    fn add_hessian(&self, _x: &[Vec3], _out: &mut dyn BlockSink) {}
}
