//! The description of a time integrator.

use crate::contact::Contact;
use crate::sim::integrator::stage::Stage;
use crate::sim::newton::{NewtonOptions, NewtonReport, Problem, Workspace};
use crate::sim::state::State;
use crease_geometry::math::Vec3;
use std::fmt;

/// Maximum ratio of a step's length to that of the step before [-]: variable-step BDF2 is unstable beyond 1 + sqrt 2.
pub const MAX_DT_GROWTH: f64 = 2.0;

/// Solver of the implicit problem of a stage.
#[derive(Clone, Copy)]
pub enum InnerSolver {
    /// Newton iterations until convergence.
    Newton,
    /// Function that decreases phi from the positions `x` in place [m], with a fixed amount of work and without a convergence
    /// criterion; its result is accepted as it is.
    FixedWork(fn(StageSolve, &mut [Vec3]) -> NewtonReport),
}

/// Problem of a stage and what its solver works with.
pub struct StageSolve<'a> {
    /// Problem of the stage.
    pub problem: &'a Problem<'a>,
    /// Contact, which has begun its step.
    pub contact: &'a mut Contact,
    /// Stopping criteria of Newton's method.
    pub options: NewtonOptions,
    /// Minimum of the tolerance that `rel_decrement_tol` gives [J]: see [`Problem::solve_again`].
    pub min_diffuse_tol: f64,
    /// Buffers that are kept between solves.
    pub work: &'a mut Workspace,
}

/// A step that was computed but not yet accepted, as input of the error estimate.
pub struct StepAttempt<'a> {
    /// State at the beginning.
    pub state: &'a State,
    /// State at the end.
    pub next: &'a State,
    /// Positions at the end of the stage before the last, one per point [m]; `None` with a single stage.
    pub stage_positions: Option<&'a [Vec3]>,
    /// Length of the step [s].
    pub h: f64,
}

/// Constructor of the stage of a step of h seconds from a state; later stages get the positions at the end of the one
/// before.
type MakeStage = fn(&State, f64, Option<&[Vec3]>) -> Stage;

/// A time integrator. Two are equal if they have the same name.
#[derive(Clone, Copy)]
pub struct MethodSpec {
    /// Name on the command line and in tables.
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

impl PartialEq for MethodSpec {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for MethodSpec {}

impl fmt::Debug for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name)
    }
}
