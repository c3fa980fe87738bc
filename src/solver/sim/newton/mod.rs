//! Newton's method on the incremental potential of a stage (or on the energy alone, for equilibria):
//!
//! ```text
//! phi(x) = |x - inertial|²_M / (2 effective_dt²) + sum of energies(x)
//! ```
//!
//! `solve.rs` has the iterations; the other files are their parts. Integrators and wear scripts are outside its scope.

mod context;
mod descend;
mod elimination;
mod levenberg_marquardt;
mod line_search;
mod linear_system;
mod local_solve;
mod options;
mod problem;
mod report;
mod solve;
mod tuning;
mod workspace;

pub use options::NewtonOptions;
pub use problem::{Inertia, Problem};
pub use report::{NewtonReport, NewtonSeconds};
pub use workspace::Workspace;
