//! Tether of a shape to a target that spreads what keeps it away from there evenly,
//!
//! ```text
//! E = sum_i k_i/2 |u_i|² + sum_(ij) s/2 |u_i - u_j|²,     u_i = x_i - X_i
//! ```
//!
//! over points i and edges ij: neighbours of a point that cannot reach its target stay beside it.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_linear::BlockSink;

/// Tether between points and their target positions.
#[derive(Debug, Clone, Copy)]
pub struct EvenTether<'a> {
    /// Target positions X, one per point [m].
    pub target: &'a [Vec3],
    /// Stiffness k, one per point [N/m].
    pub stiffness: &'a [f64],
    /// Edges of the mesh.
    pub edges: &'a [[PointIndex; 2]],
    /// Stiffness s of an edge [N/m].
    pub edge_stiffness: f64,
}

impl EvenTether<'_> {
    fn shift(&self, x: &[Vec3], p: PointIndex) -> Vec3 {
        x[p.at()] - self.target[p.at()]
    }
}

impl Energy for EvenTether<'_> {
    fn name(&self) -> &'static str {
        "even tether"
    }

    fn value(&self, x: &[Vec3]) -> f64 {
        let points = x.iter().zip(self.target).zip(self.stiffness);
        let of_points: f64 = points.map(|((x, target), k)| 0.5 * k * (x - target).norm_squared()).sum();
        let apart = |[a, b]: &[PointIndex; 2]| (self.shift(x, *a) - self.shift(x, *b)).norm_squared();
        of_points + 0.5 * self.edge_stiffness * self.edges.iter().map(apart).sum::<f64>()
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for (((out, x), target), k) in out.iter_mut().zip(x).zip(self.target).zip(self.stiffness) {
            *out += (x - target) * *k;
        }
        for [a, b] in self.edges {
            let force = (self.shift(x, *a) - self.shift(x, *b)) * self.edge_stiffness;
            out[a.at()] += force;
            out[b.at()] -= force;
        }
    }

    fn add_hessian(&self, _x: &[Vec3], out: &mut dyn BlockSink) {
        for (p, k) in self.stiffness.iter().enumerate() {
            out.add(p as u32, p as u32, &(Mat3::identity() * *k));
        }
        let block = Mat3::identity() * self.edge_stiffness;
        for [a, b] in self.edges {
            out.add(a.0, a.0, &block);
            out.add(b.0, b.0, &block);
            out.add(b.0, a.0, &-block);
        }
    }

    fn visit_stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.edges.iter().for_each(|[a, b]| visit(&[a.0, b.0]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::energy_checks::check_gradient_and_hessian;

    #[test]
    fn gradient_and_hessian_match() {
        let target = [Vec3::zeros(), Vec3::new(0.1, 0.2, 0.3), Vec3::x()];
        let edges = [[0, 1], [1, 2]].map(|edge| edge.map(PointIndex));
        let tether =
            EvenTether { target: &target, stiffness: &[5.0, 2.0, 1.0], edges: &edges, edge_stiffness: 3.0 };
        let x = [Vec3::new(2e-3, -4e-3, 1e-3), Vec3::new(0.11, 0.19, 0.32), Vec3::new(1.0, 0.02, 0.0)];
        check_gradient_and_hessian(&tether, &x, 1e-6);
    }
}
