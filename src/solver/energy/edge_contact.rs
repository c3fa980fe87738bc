//! One-sided contact of points and edges of a body with the triangles and edges of the cloth above them.
//!
//! ```text
//! E = k/2 (d - g)²  for g = n.(w_a x_a + w_b x_b + w_c x_c - c) < d
//! ```
//!
//! It complements [`PlaneContact`](crate::energy::PlaneContact), which covers the points of the cloth only. `c` and `n`
//! are a position on the body and its normal at the end of the step; the weights are the barycentric coordinates of the
//! position of the cloth above it at the beginning; d is the activation distance. The energy is convex; friction acts
//! at the points only. The pairs are found by `contact::body_edges`.

use crate::energy::term::Energy;
use crease_geometry::math::Vec3;
use crease_linear::BlockSink;

/// Contact of a position on an edge of the body with a triangle of the cloth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeContact {
    /// Ends of the edge, indices of points of the body.
    pub edge: [u32; 2],
    /// Weights of the two ends at the contact position.
    pub edge_weights: [f64; 2],
    /// Points of the triangle of the cloth.
    pub points: [u32; 3],
    /// Barycentric weights of these points at the contact position.
    pub weights: [f64; 3],
    /// Contact position on the body at the end of the step [m].
    pub anchor: Vec3,
    /// Outward unit normal of the body there.
    pub normal: Vec3,
    /// Activation distance [m]: the contact pushes below it.
    pub dhat: f64,
    /// Stiffness of the contact [N/m].
    pub stiffness: f64,
}

impl EdgeContact {
    /// Returns the height of the cloth above the contact position [m].
    pub fn gap(&self, x: &[Vec3]) -> f64 {
        let above: Vec3 = self.points.iter().zip(self.weights).map(|(p, w)| x[*p as usize] * w).sum();
        self.normal.dot(&(above - self.anchor))
    }

    /// Returns how far the cloth is inside the activation distance [m].
    fn depth(&self, x: &[Vec3]) -> f64 {
        (self.dhat - self.gap(x)).max(0.0)
    }
}

/// All contacts of one step as an energy term.
pub struct EdgeContacts<'a>(pub &'a [EdgeContact]);

impl Energy for EdgeContacts<'_> {
    fn name(&self) -> &'static str {
        "edge contacts"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        self.0.iter().map(|c| 0.5 * c.stiffness * c.depth(x).powi(2)).sum()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for c in self.0 {
            let force = c.normal * (c.stiffness * c.depth(x));
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
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match_in_and_out_of_contact() {
        let contact = |dhat, points| EdgeContact {
            edge: [0, 1],
            edge_weights: [1.0, 0.0],
            points,
            weights: [0.2, 0.5, 0.3],
            anchor: Vec3::new(0.4, 0.01, 0.3),
            normal: Vec3::new(0.1, 0.9, -0.3).normalize(),
            dhat,
            stiffness: 80.0,
        };
        let all = [contact(0.02, [0, 1, 2]), contact(0.03, [3, 1, 2]), contact(-0.5, [2, 1, 0])];
        let x = [[0.0, 0.0, 0.0], [1.0, 0.01, 0.1], [0.1, 0.003, 1.0], [0.2, 0.0, 0.05]].map(Vec3::from);
        check_gradient_and_hessian(&EdgeContacts(&all), &x, 1e-7);
        assert!(all[0].gap(&x) < 0.02 && all[2].depth(&x) == 0.0);
    }
}
