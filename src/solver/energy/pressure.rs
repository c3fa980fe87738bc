//! Pressure of a soft plate from above: a downward force on every uncovered triangle, E = p sum_f A_f^xz h_f. The
//! projected area A_f^xz is constant during a step, so that the term is linear.

use crate::energy::term::Energy;
use crease_geometry::math::Vec3;
use crease_linear::BlockSink;

/// Downward forces on points.
pub struct Pressure<'a> {
    /// Force towards -y, one per point [N].
    pub force: &'a [f64],
}

impl Energy for Pressure<'_> {
    fn name(&self) -> &'static str {
        "pressure"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.force.iter().zip(x).map(|(f, x)| f * x.y).sum()
    }

    fn add_gradient(&self, _x: &[Vec3], out: &mut [Vec3]) {
        for (g, f) in out.iter_mut().zip(self.force) {
            g.y += f;
        }
    }

    fn add_hessian(&self, _x: &[Vec3], _out: &mut dyn BlockSink) {}
}
