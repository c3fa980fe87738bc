//! Conjugate gradients with a block-Jacobi preconditioner, for systems whose factor would not fit in memory and
//! as an independent check of the direct solver.

use crate::math::{Mat3, Vec3};
use crate::sim::BlockMatrix;

/// Outcome of a solve.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One per row.
    pub x: Vec<Vec3>,
    /// Iterations made.
    pub iterations: usize,
    /// Whether the residual fell below the tolerance.
    pub converged: bool,
}

/// Solves `matrix` x = `rhs` to |r| <= `tolerance` |rhs|. Stops early on a direction of negative curvature.
pub fn conjugate_gradient(
    matrix: &BlockMatrix,
    rhs: &[Vec3],
    tolerance: f64,
    most_iterations: usize,
) -> Solution {
    let n = rhs.len();
    let inverse: Vec<Mat3> = (0..n)
        .map(|r| matrix.blocks(r).last().and_then(|block| block.try_inverse()).unwrap_or_else(Mat3::identity))
        .collect();
    let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let goal = tolerance * tolerance * dot(rhs, rhs);
    let mut x = vec![Vec3::zeros(); n];
    let mut r = rhs.to_vec();
    let mut z: Vec<Vec3> = inverse.iter().zip(&r).map(|(m, r)| m * r).collect();
    let mut p = z.clone();
    let mut image = vec![Vec3::zeros(); n];
    let mut rz = dot(&r, &z);
    for iteration in 0..most_iterations {
        if dot(&r, &r) <= goal {
            return Solution { x, iterations: iteration, converged: true };
        }
        matrix.multiply(&p, &mut image);
        let curvature = dot(&p, &image);
        if curvature <= 0.0 || !curvature.is_finite() {
            return Solution { x, iterations: iteration, converged: false };
        }
        let step = rz / curvature;
        for k in 0..n {
            x[k] += p[k] * step;
            r[k] -= image[k] * step;
            z[k] = inverse[k] * r[k];
        }
        let next = dot(&r, &z);
        let share = next / rz;
        rz = next;
        for k in 0..n {
            p[k] = z[k] + p[k] * share;
        }
    }
    Solution { x, iterations: most_iterations, converged: false }
}
