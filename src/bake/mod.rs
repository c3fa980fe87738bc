//! The main job: wear -> solve -> memory, step by step, then the garment brought home to its own pose.

mod active_region;
mod adaptive_mesh;
mod body_coupling;
pub mod checkpoint;
mod depenetration;
mod from_motion;
mod initial_intersections;
mod plan;
mod quality;
mod relax;
mod relax_to_source;
mod violation_log;

pub use adaptive_mesh::SimulationMesh;
pub use body_coupling::active_points;
pub use checkpoint::{Checkpoint, fingerprint};
pub use from_motion::{GarmentMotion, memory_from_motion};
pub use plan::{ModelDecision, ModelPlan};
pub use quality::Quality;
pub use relax::{RelaxResult, rest_mesh, settle};

use crate::bake::body_coupling::{BodyPenetrationStats, OnBody};
use crate::bake::relax_to_source::{Homeward, bring_home};
use crate::bake::violation_log::UnmetLog;
use crate::body::AnimatedBody;
use crate::contact::{BodyPlanes, Contact, ContactSettings};
use crate::error::{Error, Result};
use crate::fabric::Fabric;
use crate::garment::{Garment, RestState, WornGarment};
use crate::math::Vec3;
use crate::memory::{EventCount, Memory, MemoryModel, Strains};
use crate::mesh::intersections::self_intersections;
use crate::sim::GRAVITY;
use crate::sim::{Cloth, SolveCost, State, StepOptions, Stepper};
use crate::transfer::prolongate;
use crate::wear::{Action, ActionContext, ActionRunner, PersistentState, WearScript};
use checkpoint::Way;
use std::sync::Arc;
use std::time::Instant;

/// How to bake.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeOptions {
    /// Whether the cloth remembers.
    pub memory: bool,
    /// How steps are made.
    pub step: StepOptions,
    /// A step is converged when what energy is left to gain would not lift the garment by this [m]: single points that
    /// are still falling into a wrinkle go on in the next step.
    pub energy_tol_m: f64,
    /// Strain under the garment's own weight that a lower stretch stiffness than the fabric's may cost [-].
    pub max_weight_strain: f64,
    /// Share of the time from event to event that the step after one may take: the cloth answers each before the next is
    /// due [-].
    pub event_dt_fraction: f64,
    /// Every model on and at full size, short steps of one length, each solved for the whole garment: what a plan is
    /// compared with.
    pub full_fidelity: bool,
    /// Frames per simulated second for the observer; 0 for none.
    pub frames_per_second: f64,
    /// The body the garment is worn on.
    pub body: Option<Arc<AnimatedBody>>,
    /// Whether cloth that the body cannot stir sleeps.
    pub deactivate_static: bool,
    /// Whether cloth that the script does not crease is simulated on fewer points ([`SimulationMesh`]).
    pub adaptive_mesh: bool,
    /// Steps of an action between moments that a checkpoint may be of: what an interrupted run loses. At each the pattern of the
    /// linear system is made anew, and in a hold a factor, which the steps between share.
    pub checkpoint_steps: u64,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            memory: true,
            step: StepOptions::default(),
            energy_tol_m: Quality::Standard.energy_tol(),
            max_weight_strain: Quality::Standard.max_weight_strain(),
            event_dt_fraction: Quality::Standard.event_dt_fraction(),
            full_fidelity: false,
            frames_per_second: 0.0,
            body: None,
            deactivate_static: true,
            adaptive_mesh: true,
            checkpoint_steps: 32,
        }
    }
}

/// How far a bake is.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress<'a> {
    /// Name of the action under way.
    pub stage: &'a str,
    /// Simulated time [s].
    pub time: f64,
    /// Simulated time at the end of the script [s].
    pub total: f64,
    /// Steps made.
    pub steps: u64,
    /// Length of the last step [s].
    pub step: f64,
    /// Linear solves in the last step.
    pub iterations: usize,
    /// Events so far.
    pub events: EventCount,
}

/// Watches a bake.
pub trait Observer {
    /// After every step.
    fn progress(&mut self, _progress: &Progress) {}
    /// Before the first step: the mesh that is simulated, whose points frames are of. It is the garment's own unless that is
    /// graded ([`SimulationMesh`]).
    fn on_mesh(&mut self, _mesh: &Garment) {}
    /// A frame is due: positions, one per point of the mesh that is simulated [m].
    fn frame(&mut self, _x: &[Vec3]) -> Result<()> {
        Ok(())
    }
    /// Whether [`Observer::checkpoint`] shall be given anything.
    fn wants_checkpoints(&self) -> bool {
        false
    }
    /// The run can be taken up from here: before every action, after the last, and every few steps between.
    fn checkpoint(&mut self, _now: Checkpoint) -> Result<()> {
        Ok(())
    }
    /// Whether the bake shall stop here, with [`Error::Interrupted`]; asked after every step.
    fn should_stop(&mut self) -> bool {
        false
    }
}

/// Watches nothing.
impl Observer for () {}

/// Work and outcome of a bake.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BakeReport {
    /// Simulated time [s].
    pub simulated: f64,
    /// Points that were simulated.
    pub points: usize,
    /// Accepted steps.
    pub steps: u64,
    /// Thrown-away tries.
    pub rejected: u64,
    /// Linear solves of the whole.
    pub solves: u64,
    /// Linear solves of a few places.
    pub local_solves: u64,
    /// What they took.
    pub cost: SolveCost,
    /// Memory events.
    pub events: EventCount,
    /// Seconds by stage, in the order of a step.
    pub stages: Vec<(&'static str, f64)>,
    /// What went less well, with time and place.
    pub warnings: Vec<String>,
    /// Why what came out is no state of rest, if it is none: the last step, or the way home, did not converge. One bad step on
    /// the way is only a warning, as the cloth comes to rest after it.
    pub unconverged_reason: Option<String>,
    /// What was modelled, and why.
    pub decisions: Vec<ModelDecision>,
}

/// What a bake gives back.
#[derive(Debug, Clone)]
pub struct BakeResult {
    /// The garment in its own pose.
    pub worn: WornGarment,
    /// Positions at the end of the script [m].
    pub end: Vec<Vec3>,
    /// Work and outcome.
    pub report: BakeReport,
}

/// First step after anything starts or stops [s].
const FIRST_STEP: f64 = 1.0 / 120.0;
/// Whoever asks for frames more often than this wants every step [s].
const EVERY_STEP: f64 = 1e-5;
/// A garment that may end early is at rest below this speed, root mean square [m/s].
const REST_SPEED: f64 = 1e-4;

/// Wears `garment` in. `script_file` is the script's name in messages.
pub fn bake(
    garment: &Garment,
    fabric: &Fabric,
    script: &WearScript,
    script_file: &str,
    options: &BakeOptions,
    observer: &mut dyn Observer,
) -> Result<BakeResult> {
    bake_from(None, garment, fabric, script, script_file, options, observer)
}

/// The same from a checkpoint, with the file's name: what comes out is what an uninterrupted bake gives, bit for bit.
pub fn bake_from(
    taken_up: Option<(&str, Checkpoint)>,
    garment: &Garment,
    fabric: &Fabric,
    script: &WearScript,
    script_file: &str,
    options: &BakeOptions,
    observer: &mut dyn Observer,
) -> Result<BakeResult> {
    let grading = SimulationMesh::choose(garment, fabric, script, options);
    let wear = Wear { fabric, script, script_file, options };
    let simulated = grading.mesh.as_ref().map_or(garment, |mesh| &mesh.garment);
    observer.on_mesh(simulated);
    let mut run = wear_through(taken_up, simulated, &wear, observer)?;
    run.report.decisions.push(grading.choice);
    let clock = Instant::now();
    let mut how = &Homeward::STEADILY;
    let mut end = std::mem::take(&mut run.state.x);
    let mut memory = run.memory.rest;
    if let Some(mesh) = &grading.mesh {
        end = mesh.interpolate(&end);
        memory = prolongate(mesh, &memory, garment);
        run.stepper = wear.stepper(garment, &ModelPlan::new(garment, fabric, script, options));
        how = &Homeward::SWIFTLY;
    }
    let displacement = bring_home(garment, fabric, &mut run.stepper, &memory, how, &mut run.report);
    run.seconds[4] += clock.elapsed().as_secs_f64();
    let home = |p: usize| garment.points[p] + displacement[p];
    let shown: Vec<Vec3> = match &grading.mesh {
        None => (0..garment.points.len()).map(home).collect(),
        Some(mesh) => mesh.source_point.iter().map(|p| home(p.at())).collect(),
    };
    observer.frame(&shown)?;
    run.report.points = simulated.points.len();
    run.report.simulated = run.state.time;
    run.report.events = run.memory.events;
    run.report.stages =
        ["assemble", "solve", "contact", "remember", "home"].into_iter().zip(run.seconds).collect();
    if run.dressing_s > 0.0 {
        run.report.stages.insert(0, ("dress", run.dressing_s));
    }
    Ok(BakeResult { worn: WornGarment { displacement, memory }, end, report: run.report })
}

/// What is done, to which cloth, and how.
struct Wear<'a> {
    fabric: &'a Fabric,
    script: &'a WearScript,
    script_file: &'a str,
    options: &'a BakeOptions,
}

impl Wear<'_> {
    /// The cloth and what keeps its layers apart, ready to be moved.
    fn stepper(&self, garment: &Garment, plan: &ModelPlan) -> Stepper {
        let (fabric, options) = (self.fabric, self.options);
        let mut cloth = Cloth::new(garment, fabric);
        cloth.membrane.set_stiffness(plan.stretch);
        if plan.layers_meet {
            cloth.bending.keep_apart();
        }
        let (dhat, stiffness) = (plan.contact_distance, plan.contact_stiffness);
        let settings = ContactSettings::for_fabric(fabric, dhat, stiffness, plan.layers_meet);
        let area = cloth.area.clone();
        let contact = Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, area);
        let mut step = options.effective_step();
        step.newton.decrement_tol = options.effective_energy_tol() * cloth.mass.iter().sum::<f64>() * GRAVITY;
        Stepper::new(cloth, contact, step)
    }
}

/// The script from its beginning, or from a checkpoint, to its end.
fn wear_through<'a>(
    taken_up: Option<(&str, Checkpoint)>,
    garment: &'a Garment,
    wear: &Wear,
    observer: &mut dyn Observer,
) -> Result<Run<'a>> {
    let &Wear { fabric, script, script_file, options } = wear;
    let key = fingerprint(garment, fabric, script, options);
    if let Some((file, checkpoint)) = &taken_up {
        checkpoint.check(file, garment, script, options.body.as_deref(), &key)?;
    }
    let on_body = OnBody::prepare(garment, script, script_file, options)?;
    let mut plan = ModelPlan::new(garment, fabric, script, options);
    if let Some(on_body) = &on_body {
        plan.wear_on(fabric, &on_body.wearer, &on_body.asleep);
    }
    let stepper = wear.stepper(garment, &plan);
    let source_angle = stepper.cloth.bending.angles(&garment.points, &[]);
    let law = MemoryModel::new(garment, fabric, stepper.cloth.bending.width());
    let mut run = Run {
        garment,
        stepper,
        state: State::at_rest(garment.points.clone(), source_angle.clone()),
        memory: Memory::new(RestState::new(source_angle, garment.triangles.len())),
        law: options.memory.then_some(law),
        event_dt_fraction: options.event_dt_fraction,
        checkpoint_steps: options.checkpoint_steps,
        posture: PersistentState::default(),
        report: BakeReport { decisions: plan.decisions, ..BakeReport::default() },
        seconds: [0.0; 5],
        frame_every: if options.frames_per_second > 0.0 {
            1.0 / options.frames_per_second
        } else {
            f64::INFINITY
        },
        next_frame: 0.0,
        frames: 0,
        key,
        unconverged: 0,
        unmet: UnmetLog::default(),
        largest_rest: 0.0,
        last_rest: None,
        total: script.duration_with_body(options.body.as_deref()),
        asleep: Vec::new(),
        field: None,
        pinch: BodyPenetrationStats::default(),
        dressing_s: 0.0,
    };
    run.report.warnings.extend(initial_intersections::crossing_warning(garment));
    if let Some(on_body) = on_body {
        run.put_on(on_body, taken_up.as_ref().and_then(|(_, checkpoint)| checkpoint.body.as_ref()));
    }
    let (mut first, mut way) = (0, None);
    if let Some((_, checkpoint)) = taken_up {
        (first, way) = (checkpoint.action, checkpoint.way.clone());
        run.restore(checkpoint);
    }
    let mut actions = 0;
    for (number, action) in script.flatten().enumerate().skip(first) {
        run.act(number, action, script_file, way.take(), observer)?;
        actions = number + 1;
    }
    run.moment(actions.max(first), observer)?;
    if run.unconverged > 0 {
        run.report.warnings.push(format!(
            "{} of {} steps were accepted before Newton had converged (largest move left {:.1} mm): \
             layers pressed against one another; none of them crossed",
            run.unconverged,
            run.report.steps,
            1e3 * run.largest_rest
        ));
    }
    run.report.unconverged_reason = run.last_rest.map(|rest| {
        format!("the last step, at {:.3} s (it asked for {:.1} mm more)", run.state.time, 1e3 * rest)
    });
    run.report.warnings.extend(run.unmet.warnings());
    run.report.warnings.extend(run.pinch.warnings());
    run.frame(observer)?;
    Ok(run)
}

/// An action under way: its number and name, the cloth, the posture and the time it began with.
struct ActiveAction {
    number: usize,
    name: &'static str,
    start: Vec<Vec3>,
    begin: f64,
    before: PersistentState,
}

/// A bake under way.
struct Run<'a> {
    garment: &'a Garment,
    stepper: Stepper,
    state: State,
    memory: Memory,
    /// `None` when the cloth does not remember.
    law: Option<MemoryModel>,
    /// See [`BakeOptions`].
    event_dt_fraction: f64,
    checkpoint_steps: u64,
    posture: PersistentState,
    report: BakeReport,
    /// Assemble, solve, contact, remember, home.
    seconds: [f64; 5],
    frame_every: f64,
    next_frame: f64,
    /// Frames given to the observer.
    frames: u64,
    /// Says which run this is.
    key: String,
    total: f64,
    /// Steps accepted before Newton had converged, and the largest move it still asked for [m].
    unconverged: u64,
    largest_rest: f64,
    /// The move that the last step still asked for, if it did not converge [m].
    last_rest: Option<f64>,
    /// Points that a moving body cannot stir, one flag per point; empty for none.
    asleep: Vec<bool>,
    /// The body, if there is one.
    field: Option<BodyPlanes>,
    pinch: BodyPenetrationStats,
    /// Time that dressing took [s].
    dressing_s: f64,
    /// Demands that could not be met.
    unmet: UnmetLog,
}

impl Run<'_> {
    /// Performs the action `number`, or the rest of it.
    fn act(
        &mut self,
        number: usize,
        action: &Action,
        script_file: &str,
        way: Option<Way>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        if way.is_none() {
            self.moment(number, observer)?;
        }
        let place = format!("actions[{number}] ({})", action.name());
        let before = self.posture.clone();
        let start = way.as_ref().map_or(&self.state.x, |way| &way.start).clone();
        let scene = ActionContext {
            positions: &start,
            source_positions: &self.garment.points,
            masses: &self.stepper.cloth.mass,
            thickness: self.stepper.contact.settings().dhat,
            script_file,
            location: &place,
        };
        let mut begun = action.as_wear_action().start_action(&scene, &mut self.posture)?;
        match &way {
            Some(way) => {
                if !begun.runner.restore_state(&way.memo, start.len()) {
                    return Err(scene.refuse("the checkpoint does not fit this action", "leave out --resume"));
                }
            }
            None => {
                if let Some(placed) = begun.start_positions {
                    self.state.x = placed;
                    self.state.stop();
                }
            }
        }
        let begin = way.as_ref().map_or(self.state.time, |way| way.begin);
        let under_way = ActiveAction { number, start, begin, before, name: action.name() };
        let duration = begun.duration.unwrap_or_else(|| action.as_wear_action().duration());
        self.perform(under_way, begun.runner, duration, way, observer)
    }

    /// Forgets what is kept between steps for speed alone, as a run that is taken up has none of it.
    fn forget(&mut self) {
        self.stepper.clear_caches();
        if let Some(field) = &mut self.field {
            field.clear_caches();
        }
    }

    /// A moment before the action `number`, from which the run can be taken up.
    fn moment(&mut self, number: usize, observer: &mut dyn Observer) -> Result<()> {
        self.forget();
        if observer.wants_checkpoints() {
            observer.checkpoint(self.checkpoint(number, &self.posture, None))?;
        }
        Ok(())
    }

    /// The same between two steps of an action, every few steps.
    fn moment_between(
        &mut self,
        action: &ActiveAction,
        gesture: &dyn ActionRunner,
        part: usize,
        wished: f64,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        if !self.report.steps.is_multiple_of(self.checkpoint_steps) {
            return Ok(());
        }
        let Some(memo) = gesture.save_state() else { return Ok(()) };
        self.forget();
        if observer.wants_checkpoints() {
            let way = Way { start: action.start.clone(), begin: action.begin, part, wished, memo };
            observer.checkpoint(self.checkpoint(action.number, &action.before, Some(way)))?;
        }
        Ok(())
    }

    /// Performs one gesture to its end, from `way` if there is one.
    fn perform(
        &mut self,
        action: ActiveAction,
        mut gesture: Box<dyn ActionRunner>,
        duration: f64,
        way: Option<Way>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let begin = action.begin;
        let mut breaks = gesture.event_times();
        breaks.retain(|stop| *stop < duration);
        breaks.push(duration);
        let mut wished = way.as_ref().map_or(FIRST_STEP, |way| way.wished);
        let first = way.as_ref().map_or(0, |way| way.part);
        for (part, stop) in breaks.into_iter().enumerate().skip(first) {
            if way.is_none() || part > first {
                wished = wished.min(FIRST_STEP);
                // What acts changes here: a two-step method starts anew.
                self.state.previous = None;
            }
            while begin + stop - self.state.time > 1e-9 {
                self.moment_between(&action, gesture.as_ref(), part, wished, observer)?;
                let left = begin + stop - self.state.time;
                // Two equal steps rather than one and a remainder.
                let mut h = if wished >= left { left } else { wished.min(0.5 * left.max(wished)) };
                let now = self.state.time;
                h = h.min(self.stepper.max_dt_under(&gesture.loads_at(now - begin + h, &self.state.x)));
                if gesture.apply_map(now - begin + h, &mut self.state.x) {
                    self.state.stop();
                    self.state.angle = self.stepper.cloth.bending.angles(&self.state.x, &self.state.angle);
                }
                wished = self.step(gesture.as_mut(), begin, h, action.name, observer)?;
                if observer.should_stop() {
                    return Err(Error::Interrupted);
                }
                if gesture.may_end_early() && self.at_rest() {
                    break;
                }
            }
        }
        gesture.finish(&mut self.posture, &self.state.x);
        Ok(())
    }

    /// Shows the cloth at the times of frames that the last step passed, from `before`: where it began [s], [m]. Frames are
    /// evenly spaced, steps are not; where several steps are wanted in a frame's time, or the other way round, each shows once.
    /// Straight between two accepted places layers may run through one another: then the later place is shown.
    fn frames_due(&mut self, before: &Option<(f64, Vec<Vec3>)>, observer: &mut dyn Observer) -> Result<()> {
        let Some((start, from)) = before else { return Ok(()) };
        let step = self.state.time - start;
        if self.frame_every < EVERY_STEP {
            return self.frame(observer);
        }
        while self.next_frame <= self.state.time + 1e-9 {
            let share = ((self.next_frame - start) / step.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let between: Vec<Vec3> =
                from.iter().zip(&self.state.x).map(|(a, b)| a + (b - a) * share).collect();
            let crossing = |x: &[Vec3]| self_intersections(x, &self.garment.triangles).len();
            let count = if share < 1.0 { crossing(&between) } else { 0 };
            let crosses = count > 0 && count > crossing(&self.state.x);
            observer.frame(if crosses { &self.state.x } else { &between })?;
            self.frames += 1;
            self.next_frame += self.frame_every;
        }
        Ok(())
    }

    /// Shows the cloth as it is.
    fn frame(&mut self, observer: &mut dyn Observer) -> Result<()> {
        observer.frame(&self.state.x)?;
        self.frames += 1;
        Ok(())
    }

    /// One accepted step: solve, then remember. Returns the length the next should have.
    fn step(
        &mut self,
        gesture: &mut dyn ActionRunner,
        begin: f64,
        h: f64,
        name: &str,
        observer: &mut dyn Observer,
    ) -> Result<f64> {
        let remembers_length = self.law.as_ref().is_some_and(MemoryModel::remembers_length);
        let measure = |run: &Self| {
            if remembers_length { run.stepper.cloth.membrane.measure(&run.state.x) } else { Vec::new() }
        };
        let (angle, stretch) = (self.state.angle.clone(), measure(self));
        let before = self.frame_every.is_finite().then(|| (self.state.time, self.state.x.clone()));
        let step = match self.field.take() {
            Some(field) => self.step_on_body(field, gesture, begin, h),
            None => {
                let mut drive_at = |time: f64, state: &State| gesture.loads_at(time - begin, &state.x);
                self.stepper.advance(&mut self.state, &self.memory.effective_rest, &mut drive_at, h)
            }
        };
        let seconds = step.newton.seconds;
        let stages = [seconds.assembly, seconds.linear_solve, seconds.contact];
        for (total, s) in self.seconds.iter_mut().zip(stages) {
            *total += s;
        }
        self.report.steps += 1;
        self.report.rejected += step.rejected as u64;
        self.report.solves += step.newton.global_iterations as u64;
        self.report.local_solves += step.newton.local_iterations as u64;
        self.report.cost += step.newton.cost;
        self.last_rest = (!step.converged).then_some(step.newton.max_displacement);
        if !step.converged {
            self.unconverged += 1;
            self.largest_rest = self.largest_rest.max(step.newton.max_displacement);
        }
        self.unmet.note(self.state.time, &step.violations);
        let clock = Instant::now();
        let mut next = step.next_dt;
        if let (Some(law), true) = (&self.law, gesture.accumulates_memory()) {
            let stretch_after = measure(self);
            let earlier = Strains { angle: &angle, stretch: &stretch };
            let after = Strains { angle: &self.state.angle, stretch: &stretch_after };
            let events = self.memory.commit(law, &earlier, &after, step.dt);
            next = next
                .min(law.max_dt_after_events(events, self.event_dt_fraction))
                .max(self.stepper.options.min_dt);
        }
        self.seconds[3] += clock.elapsed().as_secs_f64();
        observer.progress(&Progress {
            stage: name,
            time: self.state.time,
            total: self.total,
            steps: self.report.steps,
            step: step.dt,
            iterations: step.newton.global_iterations,
            events: self.memory.events,
        });
        self.frames_due(&before, observer)?;
        Ok(next)
    }

    fn at_rest(&self) -> bool {
        let sum: f64 = self.state.v.iter().map(|v| v.norm_squared()).sum();
        (sum / self.garment.points.len() as f64).sqrt() < REST_SPEED
    }
}
