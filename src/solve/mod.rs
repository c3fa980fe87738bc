//! One time step: integrators, Newton, line search, assembly, linear solvers, step control.

mod block_matrix;
mod cholesky;
mod cloth;
mod conjugate_gradient;
mod damping;
mod follow;
mod integrator;
mod leeway;
mod moves;
mod newton;
mod places;
mod state;
mod step;
mod sweep;
mod unmet;

pub use block_matrix::{BlockMatrix, HELD, Visit};
pub use cholesky::{Cholesky, FactorError, SolveCost};
pub use cloth::Cloth;
pub use conjugate_gradient::{Solution, conjugate_gradient};
pub use integrator::{MOST_GROWTH, Method, Solver, Stage};
pub use leeway::Leeway;
pub use newton::{NewtonOptions, NewtonReport, Problem, Workspace};
pub use state::{Previous, State};
pub use step::{StepOptions, StepReport, Stepper};
pub use unmet::{Shortfall, Unmet};
