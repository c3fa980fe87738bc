//! Time stepping of the cloth: integrators, step control, Newton's method and linear solvers.

mod cloth;
mod integrator;
mod loads;
mod newton;
mod stage_terms;
mod state;
mod step_relaxation;
mod stepper;
mod tuning;
mod violations;

pub use cloth::{Cloth, Sewing, SewnStrips};
pub use integrator::{InnerSolver, MAX_DT_GROWTH, Method, MethodSpec, Stage, StageSolve, StepAttempt};
pub use loads::{GRAVITY, LoadSource, Loads, SphereLoad};
pub use newton::{Inertia, NewtonOptions, NewtonReport, NewtonSeconds, Problem, Workspace};
pub use state::{PreviousState, State};
pub use step_relaxation::StepRelaxation;
pub use stepper::{StepOptions, StepReport, Stepper};
pub use violations::{Violation, Violations};
