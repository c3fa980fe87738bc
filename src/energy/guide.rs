//! Guides: springs that draw points to moving targets, E = k/2 |x - target|².
//!
//! They are the hands of a wear action: soft enough that layers may slide on one another, stiff enough to carry
//! their weight. A point held exactly is not a guide but a pin (`solve`).

use super::{BlockSink, Energy};
use crate::math::{Mat3, Vec3};

/// One spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide {
    /// The point drawn.
    pub point: u32,
    /// Where to [m].
    pub target: Vec3,
    /// Stiffness [N/m].
    pub stiffness: f64,
}

/// All springs of one step.
pub struct Guides<'a>(
    /// At most one per point.
    pub &'a [Guide],
);

impl Energy for Guides<'_> {
    fn name(&self) -> &'static str {
        "guides"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.0.iter().map(|g| 0.5 * g.stiffness * (x[g.point as usize] - g.target).norm_squared()).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for g in self.0 {
            out[g.point as usize] += (x[g.point as usize] - g.target) * g.stiffness;
        }
    }

    fn add_hessian(&self, _x: &[Vec3], out: &mut dyn BlockSink) {
        for g in self.0 {
            out.add(g.point, g.point, &(Mat3::identity() * g.stiffness));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shelf_tests::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn passes_the_shelf() {
        let guides = [Guide { point: 1, target: Vec3::new(0.1, 0.2, 0.3), stiffness: 5.0 }];
        check_gradient_and_hessian(&Guides(&guides), &[Vec3::zeros(), Vec3::new(0.2, 0.1, 0.0)], 1e-5);
    }
}
