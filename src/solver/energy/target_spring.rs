//! Springs that pull points towards moving targets,
//!
//! ```text
//! E = k/2 (n . (x - target))² + k_s/2 |(I - n n^T) (x - target)|²
//! ```
//!
//! Wear actions move cloth with them: stiff along the normal n, which keeps layers in order, and soft across it,
//! because layers slide on one another. A point with a prescribed position is a fixed point of the Newton problem
//! instead.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;
use serde::{Deserialize, Serialize};

/// A spring between one point and a target position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TargetSpring {
    /// Index of the point.
    pub point: u32,
    /// Target position [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub target: Vec3,
    /// Unit vector along which `stiffness` acts.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub normal: Vec3,
    /// Stiffness along `normal` [N/m].
    pub stiffness: f64,
    /// Stiffness across `normal` [N/m].
    pub tangential_stiffness: f64,
}

impl TargetSpring {
    /// Returns a spring with the same `stiffness` [N/m] in every direction.
    pub fn isotropic(point: u32, target: Vec3, stiffness: f64) -> Self {
        Self { point, target, normal: Vec3::y(), stiffness, tangential_stiffness: stiffness }
    }

    /// Returns the spring with both stiffnesses multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            stiffness: factor * self.stiffness,
            tangential_stiffness: factor * self.tangential_stiffness,
            ..self
        }
    }

    /// Returns the 3 x 3 stiffness matrix [N/m].
    fn matrix(&self) -> Mat3 {
        Mat3::identity() * self.tangential_stiffness
            + self.normal * self.normal.transpose() * (self.stiffness - self.tangential_stiffness)
    }
}

/// All springs of one step as an energy term.
pub struct TargetSprings<'a>(
    /// The springs, at most one per point.
    pub &'a [TargetSpring],
);

impl Energy for TargetSprings<'_> {
    fn name(&self) -> &'static str {
        "target springs"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let energy = |g: &TargetSpring| {
            let arm = x[g.point as usize] - g.target;
            let along = g.normal.dot(&arm);
            0.5 * (g.tangential_stiffness * arm.norm_squared()
                + (g.stiffness - g.tangential_stiffness) * along * along)
        };
        self.0.iter().map(energy).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for g in self.0 {
            let arm = x[g.point as usize] - g.target;
            out[g.point as usize] += arm * g.tangential_stiffness
                + g.normal * ((g.stiffness - g.tangential_stiffness) * g.normal.dot(&arm));
        }
    }

    fn add_hessian(&self, _x: &[Vec3], out: &mut dyn BlockSink) {
        for g in self.0 {
            out.add(g.point, g.point, &g.matrix());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match() {
        let normal = Vec3::new(0.36, 0.48, 0.8);
        let springs = [TargetSpring {
            point: 1,
            target: Vec3::new(0.1, 0.2, 0.3),
            normal,
            stiffness: 5.0,
            tangential_stiffness: 0.1,
        }];
        check_gradient_and_hessian(
            &TargetSprings(&springs),
            &[Vec3::zeros(), Vec3::new(0.2, 0.1, 0.0)],
            1e-5,
        );
    }
}
