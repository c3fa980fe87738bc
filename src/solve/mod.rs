//! One time step.

mod block_matrix;
mod cholesky;
mod conjugate_gradient;
mod ordering;

pub use block_matrix::{BlockMatrix, HELD};
pub use cholesky::{Cholesky, FactorError};
pub use conjugate_gradient::{Solution, conjugate_gradient};
