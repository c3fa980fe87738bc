//! First phase of a bake: the script is run on the simulation mesh.

use crate::bake::Observer;
use crate::bake::checkpoint::Checkpoint;
use crate::bake::report::{BakeReport, StageSeconds};
use crate::bake::run::Run;
use crate::bake::setup::BakeSetup;
use crate::error::Result;
use crate::garment::{CoarseMesh, Garment, RestState};
use crate::math::Vec3;
use crate::sim::Stepper;
use crate::transfer::prolongate;

/// Result of the simulation, on the simulation mesh.
pub(super) struct SimulationResult {
    /// Positions at the end of the script, one per point [m].
    pub positions: Vec<Vec3>,
    /// The rest state that the script left.
    pub rest: RestState,
    /// Counts and warnings.
    pub report: BakeReport,
    /// Wall time.
    pub seconds: StageSeconds,
    /// Solver and contact in their final state.
    pub stepper: Stepper,
}

impl SimulationResult {
    /// The same on every point of `garment`, of which `coarse` was simulated; `stepper` is that of `garment`.
    pub fn prolongate(self, coarse: &CoarseMesh, garment: &Garment, stepper: Stepper) -> Self {
        let rest = prolongate(coarse, &self.rest, garment);
        Self { positions: coarse.interpolate(&self.positions), rest, stepper, ..self }
    }
}

/// Runs the script on `mesh`, from its beginning or from a checkpoint (with its file name).
pub(super) fn simulate(
    resume_from: Option<(&str, Checkpoint)>,
    mesh: &Garment,
    setup: &BakeSetup,
    observer: &mut dyn Observer,
) -> Result<SimulationResult> {
    let (mut run, position) = Run::new(resume_from, mesh, setup)?;
    let first = position.action;
    let mut progress = position.into_progress();
    let mut actions = 0;
    for (number, action) in setup.script.flatten().enumerate().skip(first) {
        run.perform_action(number, action, setup.script_name, progress.take(), observer)?;
        actions = number + 1;
    }
    run.checkpoint_boundary(actions.max(first), observer)?;
    let time = run.state.time;
    let report = &mut run.report;
    report.warnings.extend(run.convergence.warning(report.steps));
    report.unconverged_reason = run.convergence.unconverged_reason(time);
    report.warnings.extend(run.violations.warnings());
    if let Some(body) = &run.body {
        report.warnings.extend(body.penetration.warnings());
    }
    report.points = mesh.points.len();
    report.simulated = time;
    report.events = run.memory.events;
    run.frames.show(&run.state.x, &mut |x| observer.frame(x))?;
    Ok(SimulationResult {
        positions: run.state.x,
        rest: run.memory.rest,
        report: run.report,
        seconds: run.seconds,
        stepper: run.stepper,
    })
}
