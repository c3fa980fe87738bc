//! Sparse linear algebra of systems with 3 unknowns per point: a symmetric matrix of 3 x 3 blocks ([`BlockMatrix`]), its
//! multifrontal Cholesky factorisation ([`Cholesky`]), faer's sparse factorisation for systems of one number per point
//! ([`ScalarCholesky`]), and conjugate gradients. No physics; results are bit-identical for any number of threads.
//!
//! ```
//! use crease_linear::{BlockMatrix, BlockSink, Cholesky};
//! use nalgebra::{Matrix3, Vector3};
//! // Two points with unit diagonal blocks, coupled by a quarter.
//! let mut matrix = BlockMatrix::new(2, &[false, false], &mut |visit| visit(&[0, 1]));
//! matrix.fill(&mut |sink: &mut dyn BlockSink| {
//!     sink.add(0, 0, &Matrix3::identity());
//!     sink.add(1, 1, &Matrix3::identity());
//!     sink.add(1, 0, &(Matrix3::identity() * 0.25));
//! });
//! # let _ = (Cholesky::default(), Vector3::<f64>::zeros());
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
