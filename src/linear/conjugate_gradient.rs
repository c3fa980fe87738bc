//! Conjugate gradients with a block-Jacobi preconditioner, for systems whose factor does not fit in memory and as an
//! independent check of the direct solver.

use crate::block_matrix::BlockMatrix;
use crate::vector::{Mat3, Vec3, dot};

/// Outcome of conjugate gradients.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Solution, one per row.
    pub x: Vec<Vec3>,
    /// Number of iterations.
    pub iterations: usize,
    /// Whether the residual is below the tolerance.
    pub converged: bool,
}

/// Solves `matrix` x = `rhs` to |r| <= `tolerance` |rhs|. Stops early at a direction of negative curvature.
pub fn conjugate_gradient(
    matrix: &BlockMatrix,
    rhs: &[Vec3],
    tolerance: f64,
    max_iterations: usize,
) -> Solution {
    let n = rhs.len();
    let inverse: Vec<Mat3> = (0..n)
        .map(|r| matrix.blocks(r).last().and_then(|block| block.try_inverse()).unwrap_or_else(Mat3::identity))
        .collect();
    let goal = tolerance * tolerance * dot(rhs, rhs);
    let mut x = vec![Vec3::zeros(); n];
    let mut r = rhs.to_vec();
    let mut z: Vec<Vec3> = inverse.iter().zip(&r).map(|(m, r)| m * r).collect();
    let mut p = z.clone();
    let mut image = vec![Vec3::zeros(); n];
    let mut rz = dot(&r, &z);
    for iteration in 0..max_iterations {
        if dot(&r, &r) <= goal {
            return Solution { x, iterations: iteration, converged: true };
        }
        matrix.multiply(&p, &mut image);
        let curvature = dot(&p, &image);
        if curvature <= 0.0 || !curvature.is_finite() {
            return Solution { x, iterations: iteration, converged: false };
        }
        let alpha = rz / curvature;
        for k in 0..n {
            x[k] += p[k] * alpha;
            r[k] -= image[k] * alpha;
            z[k] = inverse[k] * r[k];
        }
        let next = dot(&r, &z);
        let beta = next / rz;
        rz = next;
        for k in 0..n {
            p[k] = z[k] + p[k] * beta;
        }
    }
    Solution { x, iterations: max_iterations, converged: false }
}
