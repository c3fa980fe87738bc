//! First phase of a bake: the script is run on the simulation mesh.

use crate::bake::report::{BakeReport, StageSeconds};
use crate::bake::run::checkpoint::Checkpoint;
use crate::bake::run::running_bake::Run;
use crate::bake::run::setup::BakeSetup;
use crate::bake::{MeshChoice, Observer};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::RestState;
use crease_model::remesh::SimulationMesh;
use crease_solver::sim::Stepper;

/// Result of the simulation, on the simulation mesh.
pub(in crate::bake) struct SimulationResult {
    /// The mesh at the end.
    pub mesh: SimulationMesh,
    /// Positions at the end of the script, one per point [m].
    pub positions: Vec<Vec3>,
    /// The rest state that the script left.
    pub rest: RestState,
    /// The rest state that it began with, where the cloth was not new.
    pub start: Option<RestState>,
    /// Counts and warnings.
    pub report: BakeReport,
    /// Wall time.
    pub seconds: StageSeconds,
    /// Solver and contact in their final state.
    pub stepper: Stepper,
}

/// Runs the script on `mesh`, from its beginning or from a checkpoint (with its file name).
pub(in crate::bake) fn simulate(
    resume_from: Option<(&str, Checkpoint)>,
    mesh: MeshChoice,
    setup: &BakeSetup,
    observer: &mut dyn Observer,
) -> Result<SimulationResult> {
    let (mut run, position) = Run::new(resume_from, mesh, setup)?;
    let first = position.action;
    let mut progress = position.into_progress();
    let mut actions = 0;
    for (number, action) in setup.script.flatten().enumerate().skip(first) {
        actions = number + 1;
        if run.skips_opening(number, &action) {
            continue;
        }
        let performed = run.perform_action(number, &action, setup.script_name, progress.take(), observer);
        if let Err(error) = performed {
            if run.report.stopped.is_some() {
                run.complete_report();
                run.report.stages = run.seconds.named();
                observer.on_early_stop(&run.report);
            }
            return Err(error);
        }
    }
    run.checkpoint_boundary(actions.max(first), observer)?;
    run.complete_report();
    run.report.inside_body_reason = run.reason_inside_body();
    run.report.unconverged_reason = run.convergence.unconverged_reason(run.state.time);
    run.show_last_frame(observer)?;
    run.report.warn(run.frames.warning());
    // The result has the shape of its file.
    run.stepper.cloth.membrane.set_rest_stretches(&[]);
    Ok(SimulationResult {
        mesh: run.mesh,
        positions: run.state.x,
        rest: run.memory.rest,
        start: run.memory.start,
        report: run.report,
        seconds: run.seconds,
        stepper: run.stepper,
    })
}
