//! One time step: integrators, Newton, line search, assembly, linear solvers, step control.

mod cloth;
mod integrator;
mod linear;
mod loads;
mod newton;
mod state;
mod step_relaxation;
mod stepper;
mod violations;

pub use cloth::Cloth;
pub use integrator::{MOST_GROWTH, Method, Solver, Stage};
pub use linear::block_matrix::{BlockMatrix, HELD, Visit};
pub use linear::cholesky::{Cholesky, FactorError, SolveCost};
pub use linear::conjugate_gradient::{Solution, conjugate_gradient};
pub use loads::{Ball, Drive, GRAVITY};
pub use newton::{NewtonOptions, NewtonReport, Problem, Workspace};
pub use state::{Previous, State};
pub use step_relaxation::Leeway;
pub use stepper::{StepOptions, StepReport, Stepper};
pub use violations::{Shortfall, Unmet};
