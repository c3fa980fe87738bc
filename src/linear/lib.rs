//! Sparse linear algebra of systems with 3 unknowns per point: a symmetric matrix of 3 x 3 blocks ([`BlockMatrix`]), its
//! multifrontal Cholesky factorisation ([`Cholesky`]), faer's sparse factorisation for systems of one number per point
//! ([`ScalarCholesky`]), and conjugate gradients. No physics; results are bit-identical for any number of threads.
//!
//! ```
//! use crease_linear::{BlockMatrix, BlockSink, Cholesky};
//! use nalgebra::{Matrix3, Vector3};
//! // 2 points whose diagonal blocks are 1, coupled by a quarter.
//! let unit = Matrix3::identity();
//! let mut matrix = BlockMatrix::with_pattern(vec![0, 1], &mut |visit| visit(&[0, 1]));
//! matrix.fill(&|sink: &mut dyn BlockSink| {
//!     sink.add(0, 0, &unit);
//!     sink.add(1, 1, &unit);
//!     sink.add(1, 0, &(0.25 * unit));
//! });
//! let mut x = vec![Vector3::new(1.0, 0.0, 0.0), Vector3::zeros()];
//! let mut solver = Cholesky::default();
//! solver.factorise(&matrix, &[Vector3::zeros(), Vector3::x()]).expect("is positive definite");
//! solver.solve(&matrix, &mut x).expect("is solved");
//! assert!((x[0].x - 1.0 / (1.0 - 0.0625)).abs() < 1e-9);
//! ```

mod block_matrix;
mod block_sink;
mod cholesky;
mod conjugate_gradient;
mod conjugate_gradients;
mod tuning;
mod vector;

pub use block_matrix::{BlockMatrix, INVALID, StencilVisitor};
pub use block_sink::{BlockSink, add_symmetric};
pub use cholesky::{Cholesky, FactorError, FactorSize, ScalarCholesky, SolveCost};
pub use conjugate_gradient::{Solution, conjugate_gradient};
pub use conjugate_gradients::{
    IterationOutcome, ResidualTolerance, Unknown, by_diagonal, conjugate_gradients,
};
