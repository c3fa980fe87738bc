//! A ball that closes around the cloth (crumpling hands): points outside are pushed in,
//! E = sum k_i/2 max(0, |x_i - c| - R)².

use super::{BlockSink, Energy};
use crate::math::{Mat3, Vec3};

/// A spherical container.
pub struct Container<'a> {
    /// Centre [m].
    pub centre: Vec3,
    /// Radius [m].
    pub radius: f64,
    /// One per point [N/m].
    pub stiffness: &'a [f64],
}

impl Energy for Container<'_> {
    fn name(&self) -> &'static str {
        "container"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let outside = |x: &Vec3| ((x - self.centre).norm() - self.radius).max(0.0);
        x.iter().zip(self.stiffness).map(|(x, k)| 0.5 * k * outside(x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for ((x, k), g) in x.iter().zip(self.stiffness).zip(out) {
            let arm = x - self.centre;
            let distance = arm.norm();
            if distance > self.radius {
                *g += arm * (k * (distance - self.radius) / distance);
            }
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for (i, (x, k)) in x.iter().zip(self.stiffness).enumerate() {
            let arm = x - self.centre;
            let distance = arm.norm();
            if distance > self.radius {
                let along = arm * arm.transpose() / (distance * distance);
                let across = (Mat3::identity() - along) * (1.0 - self.radius / distance);
                out.add(i as u32, i as u32, &((along + across) * *k));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shelf_tests::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn passes_the_shelf() {
        let term = Container { centre: Vec3::new(0.1, 0.0, 0.0), radius: 0.2, stiffness: &[3.0, 4.0] };
        check_gradient_and_hessian(&term, &[Vec3::new(0.4, 0.1, -0.2), Vec3::new(0.2, 0.05, 0.0)], 1e-6);
    }
}
