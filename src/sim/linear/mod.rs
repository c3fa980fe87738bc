//! Linear algebra of one Newton iteration: symmetric block matrix, sparse Cholesky factorisation, conjugate gradients.

pub mod block_matrix;
pub mod cholesky;
pub mod conjugate_gradient;
mod tuning;
