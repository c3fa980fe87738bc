//! State of a running simulation: what a step reads and changes, its start from nothing or from a checkpoint, and the
//! checkpoint of it.

use crate::bake::body::coupling::{BodyCheckpoint, BodyCoupling, SteppedCloth};
use crate::bake::body::depenetration::depenetrate;
use crate::bake::body::leash::GarmentLeash;
use crate::bake::choose_mesh::RefinementRule;
use crate::bake::relax::garment_reading::GarmentFrames;
use crate::bake::report::{BakeReport, StageSeconds, StepConvergence};
use crate::bake::run::checkpoint::{Checkpoint, CheckpointPosition, FrameShape, RunCounts, fingerprint};
use crate::bake::run::frames::FrameSchedule;
use crate::bake::run::initial_intersections;
use crate::bake::run::setup::{BakeSetup, BodySetup};
use crate::bake::run::violation_log::ViolationLog;
use crate::bake::{MeshChoice, ModelPlan};
use crate::wear::PersistentState;
use crease_model::body::PosedBody;
use crease_model::error::Result;
use crease_model::remesh::SimulationMesh;
use crease_solver::memory::{Memory, MemoryModel};
use crease_solver::sim::{State, StepOptions, Stepper};
use std::time::Instant;

/// A running simulation.
pub(in crate::bake) struct Run<'a> {
    /// Inputs of the bake.
    setup: &'a BakeSetup<'a>,
    /// The models in use.
    plan: ModelPlan,
    /// The simulated mesh.
    pub mesh: SimulationMesh,
    /// How it is refined during the run, if it is.
    pub refinement: Option<RefinementRule>,
    /// Ends of the edges that were split so far, in order.
    pub splits: Vec<[u32; 2]>,
    /// Solver and contact.
    pub stepper: Stepper,
    /// Positions, velocities and time.
    pub state: State,
    /// Rest state and timers of the memory law.
    pub memory: Memory,
    /// The memory law; `None` for cloth without memory.
    pub model: Option<MemoryModel>,
    /// Options of the time steps outside long holds.
    pub step_options: StepOptions,
    /// Index of the action, in the flattened script, from which on the garment is only opened and rests.
    pub opening: Option<usize>,
    /// Whether the present action is part of that: the cloth remembers nothing of it.
    pub is_opening: bool,
    /// See [`crate::bake::BakeOptions`].
    pub event_dt_fraction: f64,
    /// See [`crate::bake::BakeOptions`].
    pub checkpoint_steps: u64,
    /// State that outlives actions: folds, the ground, the pose of the body.
    pub persistent: PersistentState,
    /// The body and its contact, if there is one.
    pub body: Option<BodyCoupling>,
    /// Counts and warnings so far.
    pub report: BakeReport,
    /// Wall time so far.
    pub seconds: StageSeconds,
    /// Times of frames.
    pub frames: FrameSchedule,
    /// Frames of the garment itself, where those are to be shown.
    pub of_garment: Option<GarmentFrames<'a>>,
    /// Hash of the inputs.
    pub fingerprint: String,
    /// Simulated time at the end of the script [s].
    pub total: f64,
    /// Convergence of the steps so far.
    pub convergence: StepConvergence,
    /// Violated constraints so far.
    pub violations: ViolationLog,
}

impl<'a> Run<'a> {
    /// A run on `mesh` from the beginning, or from a checkpoint (with its file name), and the position to start from.
    /// Fails for a checkpoint or a body that does not fit.
    pub fn new(
        resume_from: Option<(&str, Checkpoint)>,
        mesh: MeshChoice,
        setup: &'a BakeSetup<'a>,
    ) -> Result<(Self, CheckpointPosition)> {
        let &BakeSetup { fabric, script, options, earlier, .. } = setup;
        let MeshChoice { mut mesh, refinement, .. } = mesh;
        let fingerprint = fingerprint(&mesh.garment, fabric, script, options, earlier);
        // The models are those of the mesh at the start, also after a refinement.
        let mut plan = ModelPlan::new(&mesh.garment, fabric, script, options);
        if earlier.is_some() {
            plan.apply_earlier(options);
        }
        let mut splits = Vec::new();
        if let Some((file, checkpoint)) = &resume_from {
            splits.clone_from(&checkpoint.splits);
            mesh = checkpoint.refined_mesh(file, mesh, &fingerprint)?;
            checkpoint.check(file, &mesh.garment, script, options.body.as_deref())?;
        }
        let garment = &mesh.garment;
        let body = BodySetup::prepare(garment, setup)?;
        if let Some(body) = &body {
            plan.apply_body(fabric, &body.animated, &body.inactive, options.full_fidelity);
            plan.decisions.extend(body.leash.as_ref().map(GarmentLeash::decision));
        }
        let stepper = setup.stepper(garment, &plan);
        let source_angle = stepper.cloth.bending.angles(&garment.points, &[]);
        let model = MemoryModel::new(garment, fabric, stepper.cloth.bending.width(), plan.reference_length);
        let mut run = Run {
            setup,
            stepper,
            state: State::at_rest(garment.points.clone(), source_angle.clone()),
            memory: setup.start_memory(&mesh, source_angle),
            refinement,
            splits,
            model: plan.remembers.then_some(model),
            step_options: options.effective_step(),
            opening: script.opening().filter(|_| !options.full_fidelity),
            is_opening: false,
            event_dt_fraction: options.effective_event_dt_fraction(),
            checkpoint_steps: options.checkpoint_steps,
            persistent: PersistentState::default(),
            body: None,
            report: BakeReport { decisions: plan.decisions.clone(), ..BakeReport::default() },
            plan,
            seconds: StageSeconds::default(),
            frames: FrameSchedule::new(options.frames_per_second),
            of_garment: options.shows_garment().then(|| GarmentFrames::new(setup.garment)),
            fingerprint,
            total: script.duration_with_body(options.body.as_deref()),
            convergence: StepConvergence::default(),
            violations: ViolationLog::default(),
            mesh,
        };
        if run.splits.is_empty() {
            run.report.warn(initial_intersections::warning(setup.garment));
        }
        if let Some(body) = body {
            run.report.warn(body.animated.notes().iter().cloned());
            run.report.warn(script.body_notes(&body.animated));
            run.put_on(body, resume_from.as_ref().and_then(|(_, checkpoint)| checkpoint.body.as_ref()));
        }
        let position = match resume_from {
            None => CheckpointPosition::before_action(0),
            Some((_, checkpoint)) => run.restore(checkpoint),
        };
        Ok((run, position))
    }

    /// Goes on with another mesh: what belongs to the elements of one is made anew.
    pub fn set_mesh(&mut self, mesh: SimulationMesh) {
        self.stepper = self.setup.stepper(&mesh.garment, &self.plan);
        let width = self.stepper.cloth.bending.width();
        let model = MemoryModel::new(&mesh.garment, self.setup.fabric, width, self.plan.reference_length);
        self.model = self.model.take().map(|_| model);
        self.mesh = mesh;
        self.apply_cut();
    }

    /// Gives the cloth the rest shape of its cut.
    pub fn apply_cut(&mut self) {
        self.stepper.cloth.membrane.set_rest_stretches(&self.persistent.cut);
    }

    /// Puts the garment on the body: by depenetration at the beginning, as it was in a checkpoint.
    fn put_on(&mut self, body: BodySetup, resume_from: Option<&BodyCheckpoint>) {
        let clock = Instant::now();
        let BodySetup { animated, depths, inactive, leash } = body;
        let settings = self.stepper.contact.settings();
        let mut coupling =
            BodyCoupling::new(&self.mesh.garment, &animated, settings, self.stepper.cloth.area.clone());
        if let Some(checkpoint) = resume_from {
            // That it fits was checked with the rest of the checkpoint.
            coupling.restore(checkpoint);
            self.persistent.body = Some(PosedBody::new(&animated, checkpoint.pose.clone()));
        } else {
            // Points that will be inactive take part here.
            let cloth = SteppedCloth {
                garment: &self.mesh.garment,
                stepper: &mut self.stepper,
                state: &mut self.state,
                rest: &self.memory.effective_rest,
            };
            let done = depenetrate(&mut coupling.planes, cloth, &animated, &depths);
            self.report.solves += done.solves;
            self.report.local_solves += done.local_solves;
            coupling.penetration.begin_with(done.crossing_after);
            self.report.warn(done.warnings());
            self.persistent.body = Some(PosedBody::new(&animated, animated.rest()));
            self.seconds.depenetrate = clock.elapsed().as_secs_f64();
        }
        coupling.inactive = inactive;
        if let Some(leash) = leash {
            let stiffness = self.stepper.contact.settings().stiffness;
            coupling.hold(leash, &self.stepper.cloth.area, stiffness, &depths);
        }
        self.body = Some(coupling);
    }

    /// The checkpoint at `position`, with the garment as it was left by the actions before: in `persistent`.
    pub fn checkpoint(&self, position: CheckpointPosition, persistent: &PersistentState) -> Checkpoint {
        let standing = persistent.body.as_ref();
        Checkpoint {
            fingerprint: self.fingerprint.clone(),
            position,
            persistent: PersistentState { body: None, ..persistent.clone() },
            splits: self.splits.clone(),
            state: self.state.clone(),
            memory: self.memory.clone(),
            friction: self.stepper.contact.friction_state(),
            frame: self.of_garment.as_ref().and_then(GarmentFrames::state).map(FrameShape::from),
            body: self.body.as_ref().zip(standing).map(|(body, standing)| body.checkpoint(&standing.pose)),
            counts: RunCounts {
                steps: self.report.steps,
                rejected: self.report.rejected,
                solves: self.report.solves,
                local_solves: self.report.local_solves,
                cost: self.report.cost,
                warnings: self.report.warnings.clone(),
                not_performed: self.report.not_performed.clone(),
                convergence: self.convergence,
                violations: self.violations.clone(),
                seconds: self.seconds,
                frames: self.frames,
            },
        }
    }

    /// Restores the cloth, its memory and the counts of a checkpoint that fits. Returns its position.
    fn restore(&mut self, from: Checkpoint) -> CheckpointPosition {
        let counts = from.counts;
        // The body was put on before.
        let body = self.persistent.body.take();
        self.persistent = PersistentState { body, ..from.persistent };
        self.apply_cut();
        self.state = from.state;
        self.memory = from.memory;
        self.stepper.contact.restore_friction_state(&from.friction);
        if let Some((frames, shape)) = self.of_garment.as_mut().zip(from.frame) {
            frames.restore(shape.into());
        }
        self.report.steps = counts.steps;
        self.report.rejected = counts.rejected;
        self.report.solves = counts.solves;
        self.report.local_solves = counts.local_solves;
        self.report.cost = counts.cost;
        self.report.warnings = counts.warnings;
        self.report.not_performed = counts.not_performed;
        self.convergence = counts.convergence;
        self.violations = counts.violations;
        self.seconds = counts.seconds;
        self.frames = counts.frames;
        from.position
    }

    /// Adds to the report what is known when the run ends.
    pub fn complete_report(&mut self) {
        let report = &mut self.report;
        report.warn(self.convergence.warning(report.steps));
        report.warn(self.violations.warnings());
        report.warn(self.body.iter().flat_map(|body| body.penetration.warnings()));
        report.points = self.mesh.garment.points.len();
        report.simulated = self.state.time;
        report.events = self.memory.events;
    }

    /// Reason why the garment, as it is, does not count as worn on its body, if it is on one.
    pub fn reason_inside_body(&self) -> Option<String> {
        let (body, posed) = self.body.as_ref().zip(self.persistent.body.as_ref())?;
        body.reason_inside(&self.mesh.garment, &posed.body, &self.state.x)
    }

    /// Drops what is cached between steps for speed alone, as a resumed run has none of it.
    pub fn clear_caches(&mut self) {
        self.stepper.clear_caches();
        if let Some(frames) = &mut self.of_garment {
            frames.clear_caches();
        }
        if let Some(body) = &mut self.body {
            body.clear_caches();
        }
    }
}
