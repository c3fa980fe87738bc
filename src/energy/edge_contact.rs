//! EdgeContacts and edges of the body under the cloth: each holds up the triangle or the edge that lies over it.
//!
//! ```text
//! E = k/2 (r - g)²  for g = n.(w_a x_a + w_b x_b + w_c x_c - c) < r
//! ```
//!
//! The other half of `energy::cushion`: points alone do not keep triangles out. `c` and `n` are a place of the body and its normal at the
//! end of the step; the weights are those of the place of the cloth over it at the beginning. Convex, as there; without
//! friction, which the points have. What is over what is `contact::body_support`'s.

use crate::energy::{BlockSink, Energy};
use crate::math::Vec3;

/// A place on an edge of the body, or one of its ends, under a triangle of cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeContact {
    /// The edge's ends, points of the body.
    pub edge: [u32; 2],
    /// Of the place between them.
    pub edge_weights: [f64; 2],
    /// The triangle's points.
    pub points: [u32; 3],
    /// Of the place of the cloth over it.
    pub weights: [f64; 3],
    /// The body's place at the end of the step [m].
    pub anchor: Vec3,
    /// The body's outward normal there, unit.
    pub normal: Vec3,
    /// It pushes nearer than this [m].
    pub dhat: f64,
    /// [N/m].
    pub stiffness: f64,
}

impl EdgeContact {
    /// Height of the cloth over it [m].
    pub fn gap(&self, x: &[Vec3]) -> f64 {
        let over: Vec3 = self.points.iter().zip(self.weights).map(|(p, w)| x[*p as usize] * w).sum();
        self.normal.dot(&(over - self.anchor))
    }

    fn press(&self, x: &[Vec3]) -> f64 {
        (self.dhat - self.gap(x)).max(0.0)
    }
}

/// All of them.
pub struct EdgeContacts<'a>(pub &'a [EdgeContact]);

impl Energy for EdgeContacts<'_> {
    fn name(&self) -> &'static str {
        "body supports"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.0.iter().map(|c| 0.5 * c.stiffness * c.press(x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for c in self.0 {
            let force = c.normal * (c.stiffness * c.press(x));
            c.points.iter().zip(c.weights).for_each(|(p, w)| out[*p as usize] -= force * w);
        }
    }

    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        for c in self.0.iter().filter(|c| c.gap(x) < c.dhat) {
            if !out.is_relevant(&c.points) {
                continue;
            }
            let along = c.normal * c.normal.transpose() * c.stiffness;
            for (i, v) in c.points.iter().zip(c.weights) {
                for (j, w) in c.points.iter().zip(c.weights).filter(|(j, _)| i >= *j) {
                    out.add(*i, *j, &(along * (v * w)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::energy_checks::check_gradient_and_hessian;
    use super::*;

    #[test]
    fn passes_the_shelf_pressing_and_not() {
        let support = |reach, points| EdgeContact {
            edge: [0, 1],
            edge_weights: [1.0, 0.0],
            points,
            weights: [0.2, 0.5, 0.3],
            anchor: Vec3::new(0.4, 0.01, 0.3),
            normal: Vec3::new(0.1, 0.9, -0.3).normalize(),
            dhat: reach,
            stiffness: 80.0,
        };
        let all = [support(0.02, [0, 1, 2]), support(0.03, [3, 1, 2]), support(-0.5, [2, 1, 0])];
        let x = [[0.0, 0.0, 0.0], [1.0, 0.01, 0.1], [0.1, 0.003, 1.0], [0.2, 0.0, 0.05]].map(Vec3::from);
        check_gradient_and_hessian(&EdgeContacts(&all), &x, 1e-7);
        assert!(all[0].gap(&x) < 0.02 && all[2].press(&x) == 0.0);
    }
}
