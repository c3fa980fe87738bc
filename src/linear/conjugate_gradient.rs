//! Conjugate gradients with a block-Jacobi preconditioner, for systems whose factor does not fit in memory and as an
//! independent check of the direct solver.

use crate::block_matrix::BlockMatrix;
use crate::conjugate_gradients::{ResidualTolerance, conjugate_gradients};
use crate::vector::{Mat3, Vec3};

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
    let mut x = vec![Vec3::zeros(); n];
    let outcome = conjugate_gradients(
        &mut x,
        rhs,
        |x, product| matrix.multiply(x, product),
        |row, r| inverse[row] * r,
        ResidualTolerance::Length(tolerance),
        max_iterations,
    );
    Solution { x, iterations: outcome.iterations, converged: outcome.converged }
}
