//! The description of a time integrator.

use crate::sim::integrator::stage::Stage;
use crate::sim::state::State;
use crease_geometry::math::Vec3;

/// Maximum ratio of a step's length to that of the step before [-]: variable-step BDF2 is unstable beyond 1 + sqrt 2.
pub const MAX_DT_GROWTH: f64 = 2.0;

/// Solver of the implicit problem of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InnerSolver {
    /// Newton iterations until convergence.
    Newton,
    /// One Newton iteration.
    SingleNewton,
    /// Vertex block descent, a fixed number of sweeps: does not converge, for previews only.
    Vbd,
}

/// A step that was computed but not yet accepted, as input of the error estimate.
pub(in crate::sim) struct StepAttempt<'a> {
    /// State at the beginning.
    pub(in crate::sim) state: &'a State,
    /// State at the end.
    pub(in crate::sim) next: &'a State,
    /// Positions at the end of the stage before the last, one per point [m]; `None` with a single stage.
    pub(in crate::sim) stage_positions: Option<&'a [Vec3]>,
    /// Length of the step [s].
    pub(in crate::sim) h: f64,
}

/// Constructor of the stage of a step of h seconds from a state; later stages get the positions at the end of the one
/// before.
type MakeStage = fn(&State, f64, Option<&[Vec3]>) -> Stage;

/// A time integrator.
#[derive(Clone, Copy)]
pub(super) struct MethodSpec {
    /// Name on the command line.
    pub name: &'static str,
    /// One line on the method and its purpose.
    pub description: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// End times of its stages as fractions of the step, increasing to 1.
    pub stage_times: &'static [f64],
    /// Solver of every stage.
    pub solver: InnerSolver,
    /// Constructor of its stages.
    pub stage: MakeStage,
    /// Estimate of the local error of one step, root mean square over the points [m].
    pub error: fn(&StepAttempt) -> f64,
}
