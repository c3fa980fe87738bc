//! TargetSprings: springs that draw points to moving targets,
//!
//! ```text
//! E = k/2 (n . (x - target))² + k_s/2 |(I - n n^T) (x - target)|²
//! ```
//!
//! They are the hands of a wear action: stiff along their normal, to carry layers in order; soft across it, because
//! layers slide on one another. A point held exactly is not a guide but a pin (`solve`).

use crate::energy::{BlockSink, Energy};
use crate::math::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

/// One spring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TargetSpring {
    /// The point drawn.
    pub point: u32,
    /// Where to [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub target: Vec3,
    /// Unit direction of the stiff spring.
    #[serde(with = "crate::math::serde_vec::vector")]
    pub normal: Vec3,
    /// Stiffness along the normal [N/m].
    pub stiffness: f64,
    /// Stiffness across it [N/m].
    #[serde(rename = "slide")]
    pub tangential_stiffness: f64,
}

impl TargetSpring {
    /// A guide that is as stiff in every direction.
    pub fn isotropic(point: u32, target: Vec3, stiffness: f64) -> Self {
        Self { point, target, normal: Vec3::y(), stiffness, tangential_stiffness: stiffness }
    }

    /// The same with both springs scaled.
    pub fn scaled(self, share: f64) -> Self {
        Self {
            stiffness: share * self.stiffness,
            tangential_stiffness: share * self.tangential_stiffness,
            ..self
        }
    }

    /// The 3 x 3 stiffness [N/m].
    fn matrix(&self) -> Mat3 {
        Mat3::identity() * self.tangential_stiffness
            + self.normal * self.normal.transpose() * (self.stiffness - self.tangential_stiffness)
    }
}

/// All springs of one step.
pub struct TargetSprings<'a>(
    /// At most one per point.
    pub &'a [TargetSpring],
);

impl Energy for TargetSprings<'_> {
    fn name(&self) -> &'static str {
        "guides"
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
    use super::super::energy_checks::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn gradient_and_hessian_match() {
        let normal = Vec3::new(0.36, 0.48, 0.8);
        let guides = [TargetSpring {
            point: 1,
            target: Vec3::new(0.1, 0.2, 0.3),
            normal,
            stiffness: 5.0,
            tangential_stiffness: 0.1,
        }];
        check_gradient_and_hessian(&TargetSprings(&guides), &[Vec3::zeros(), Vec3::new(0.2, 0.1, 0.0)], 1e-5);
    }
}
