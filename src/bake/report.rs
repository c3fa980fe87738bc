//! Result and report of a bake.

use crate::bake::ModelDecision;
use crease_geometry::math::Vec3;
use crease_linear::SolveCost;
use crease_model::error::{Diagnostic, Message};
use crease_model::garment::{Garment, WornGarment};
use crease_solver::memory::EventCount;
use crease_solver::sim::StepReport;
use serde::{Deserialize, Serialize};

/// Work and outcome of a bake.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct BakeReport {
    /// Simulated time [s].
    pub simulated: f64,
    /// Number of points that were simulated.
    pub points: usize,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected step attempts.
    pub rejected: u64,
    /// Linear solves of global Newton iterations.
    pub solves: u64,
    /// Linear solves of local Newton iterations.
    pub local_solves: u64,
    /// Floating-point cost of all linear solves.
    pub cost: SolveCost,
    /// Memory events.
    pub events: EventCount,
    /// Wall time by stage [s], in the order of a step.
    pub stages: Vec<(&'static str, f64)>,
    /// Warnings, with time and position where they have one.
    pub warnings: Vec<Message>,
    /// Reason why the result is no equilibrium, if it is none: the last step, or the relaxation to the source pose, did not
    /// converge. One unconverged step before the last is only a warning, as the cloth comes to rest after it.
    pub unconverged_reason: Option<String>,
    /// Reason why the garment does not end on its body, if much of it lies deep inside.
    pub inside_body_reason: Option<String>,
    /// The first action that did not take place, with the reason and the cure: a flap that did not turn over, a garment that does not
    /// lie. The actions after it were performed on the garment as it was.
    pub not_performed: Option<Diagnostic>,
    /// The end of the run before the end of its script, if it could not recover: [`crate::bake::Observer::on_early_stop`].
    pub stopped: Option<EarlyStop>,
    /// Reason why nothing is remembered, if a wear that should leave something left nothing.
    pub empty_reason: Option<Message>,
    /// The models that were chosen, and why.
    pub decisions: Vec<ModelDecision>,
}

impl BakeReport {
    /// Adds warnings.
    pub(super) fn warn(&mut self, warnings: impl IntoIterator<Item = impl Into<Message>>) {
        self.warnings.extend(warnings.into_iter().map(Into::into));
    }
}

/// End of a run before the end of its script: the cloth is torn or stuck, has fallen off the body, or is
/// broken through by it.
#[derive(Debug, Clone, PartialEq)]
pub struct EarlyStop {
    /// The action during which it ended, as a location in the script: `actions[2] (bend)`.
    pub action: String,
    /// Simulated time [s].
    pub time: f64,
    /// What happened, since when, and the cure.
    pub cause: StopCause,
}

/// Cause of an early end of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct StopCause {
    /// What happened, since when, and the cure.
    pub reason: Message,
    /// Position where it happened [m].
    pub position: Vec3,
}

/// Result of a bake.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct BakeResult {
    /// The worn garment, in its source pose.
    pub worn: WornGarment,
    /// Positions at the end of the script, one per point of the garment [m]: folded, where it only opens the garment at its end and neither
    /// frames nor full fidelity ask for that (the decision "opening at the end"). Read off the simulated mesh: triangles too coarse for a
    /// fold may cross there, which those of a frame do not.
    pub end: Vec<Vec3>,
    /// The mesh that was simulated, with the memory that it earned.
    pub simulated: SimulatedGarment,
    /// Work and outcome.
    pub report: BakeReport,
}

/// A simulated mesh with what the wear made of it.
#[derive(Debug, Clone)]
pub struct SimulatedGarment {
    /// The mesh as a garment of its own, in the source pose.
    pub garment: Garment,
    /// Its memory and its displacement in the source pose, per hinge, triangle and point of the mesh.
    pub worn: WornGarment,
}

/// Wall time by stage [s].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageSeconds {
    /// Pushing the garment out of the body before the script.
    pub depenetrate: f64,
    /// Assembly of gradients and Hessians.
    pub assembly: f64,
    /// Linear solves.
    pub linear_solve: f64,
    /// Collision detection and step bounds.
    pub contact: f64,
    /// The memory law.
    pub memory: f64,
    /// Relaxation to the source pose.
    pub relax: f64,
}

impl StageSeconds {
    /// Adds what one step took.
    pub(super) fn add_step(&mut self, step: &StepReport) {
        let seconds = step.newton.seconds;
        self.assembly += seconds.assembly;
        self.linear_solve += seconds.linear_solve;
        self.contact += seconds.contact;
    }

    /// Names and seconds in the order of a step; `depenetrate` only if it took any time.
    pub fn named(&self) -> Vec<(&'static str, f64)> {
        let mut all = vec![
            ("assembly", self.assembly),
            ("linear_solve", self.linear_solve),
            ("contact", self.contact),
            ("memory", self.memory),
            ("relax", self.relax),
        ];
        if self.depenetrate > 0.0 {
            all.insert(0, ("depenetrate", self.depenetrate));
        }
        all
    }
}

/// Convergence of the accepted steps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepConvergence {
    /// Steps accepted before Newton had converged.
    pub unconverged_steps: u64,
    /// Largest displacement that such a step still asked for [m].
    pub max_unconverged_move: f64,
    /// Displacement that the last step still asked for [m], if it did not converge.
    pub last_unconverged_move: Option<f64>,
}

impl StepConvergence {
    /// Records an accepted step.
    pub(super) fn record(&mut self, step: &StepReport) {
        self.last_unconverged_move = (!step.converged).then_some(step.newton.max_displacement);
        if !step.converged {
            self.unconverged_steps += 1;
            self.max_unconverged_move = self.max_unconverged_move.max(step.newton.max_displacement);
        }
    }

    /// A warning if any of `steps` did not converge.
    pub(super) fn warning(&self, steps: u64) -> Option<String> {
        (self.unconverged_steps > 0).then(|| {
            format!(
                "{} of {steps} steps were accepted before Newton had converged (largest residual displacement {:.1} mm): \
                 layers pressed against one another; none of them crossed",
                self.unconverged_steps,
                1e3 * self.max_unconverged_move
            )
        })
    }

    /// Reason why the state at `time` [s] is no equilibrium, if the last step did not converge.
    pub(super) fn unconverged_reason(&self, time: f64) -> Option<String> {
        self.last_unconverged_move.map(|left| {
            format!(
                "last step (t = {time:.3} s) stopped unconverged; residual displacement {:.1} mm",
                1e3 * left
            )
        })
    }
}
