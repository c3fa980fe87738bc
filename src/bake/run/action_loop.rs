//! The loop over the steps of an action: loads -> solve -> memory.

use crate::bake::body::coupling::{StepRange, SteppedCloth};
use crate::bake::plan::laid_out;
use crate::bake::relax::garment_reading::{GarmentFrame, GarmentFrames};
use crate::bake::run::checkpoint::{ActionProgress, CheckpointPosition};
use crate::bake::run::frames::StepStart;
use crate::bake::run::running_bake::Run;
use crate::bake::tuning::TUNING;
use crate::bake::{BakeProgress, EarlyStop, ModelDecision, Observer, StopCause};
use crate::wear::{Action, ActionContext, ActionRunner, LaidOut, MAX_CUT_STRAIN, PersistentState};
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::remesh::SimulationMesh;
use crease_solver::memory::{MemoryModel, Strains};
use crease_solver::sim::{State, StepReport};
use std::time::Instant;

/// The action that is being performed.
struct ActiveAction {
    /// Index in the flattened script.
    number: usize,
    name: &'static str,
    /// Positions on which it began, one per point [m].
    start: Vec<Vec3>,
    /// Simulated time at which it began [s].
    begin: f64,
    /// Duration [s].
    duration: f64,
    /// State that outlives the actions before it.
    before: PersistentState,
}

/// Limits of the length of a step.
#[derive(Debug, Clone, Copy)]
struct StepLimits {
    /// The step itself at most [s].
    dt: f64,
    /// What the step may take after memory events, and beyond the usual maximum [s]: it grows in long holds.
    growing_dt: f64,
}

impl Run<'_> {
    /// Notes whether the action `number` only opens the garment at the end of the script, which leaves no memory, and skips it where no
    /// frames show it; returns whether it does.
    pub(in crate::bake) fn skips_opening(&mut self, number: usize, action: &Action) -> bool {
        let opens = match action {
            Action::Unfold(unfold) => unfold.opens_all(&self.persistent),
            _ => self.persistent.turns.is_empty(),
        };
        self.is_opening = opens && self.opening.is_some_and(|first| number >= first);
        let skips = self.is_opening && !self.frames.is_wanted();
        if skips {
            self.state.time += action.as_wear_action().duration();
            self.persistent.turns.clear();
            if self.opening == Some(number) {
                self.report.decisions.push(ModelDecision {
                    name: "opening at the end",
                    on: false,
                    why: "nothing that the cloth could remember comes after it: only frames show it".into(),
                });
            }
        }
        skips
    }

    /// Performs the action `number`, from its beginning or from `progress`.
    pub(in crate::bake) fn perform_action(
        &mut self,
        number: usize,
        action: &Action,
        script_name: &str,
        progress: Option<ActionProgress>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        if progress.is_none() {
            self.checkpoint_boundary(number, observer)?;
        }
        let mut next = Some(progress);
        while let Some(progress) = next {
            // A refined mesh goes on with the action where it was.
            next = self.perform_until_refined(number, action, script_name, progress, observer)?.map(Some);
        }
        Ok(())
    }

    /// Performs the action `number` to its end, or until the mesh was refined: then returns the progress on the new mesh.
    fn perform_until_refined(
        &mut self,
        number: usize,
        action: &Action,
        script_name: &str,
        progress: Option<ActionProgress>,
        observer: &mut dyn Observer,
    ) -> Result<Option<ActionProgress>> {
        let location = format!("actions[{number}] ({})", action.name());
        let before = self.persistent.clone();
        let start = progress.as_ref().map_or(&self.state.x, |progress| &progress.start).clone();
        let scene = ActionContext {
            positions: &start,
            source_positions: &self.mesh.garment.points,
            triangles: &self.mesh.garment.triangles,
            masses: &self.stepper.cloth.mass,
            thickness: self.stepper.contact.settings().dhat,
            script_file: script_name,
            location: &location,
        };
        let mut begun = action.as_wear_action().start_action(&scene, &mut self.persistent)?;
        if let (Some(laid), Some(_)) = (&begun.start_positions, &begun.laid_out) {
            let membrane = &self.stepper.cloth.membrane;
            self.persistent.cut = membrane.stretches_to(laid, MAX_CUT_STRAIN);
        }
        self.stepper.cloth.membrane.set_rest_stretches(&self.persistent.cut);
        match &progress {
            Some(progress) => {
                if !begun.runner.restore_state(&progress.runner_state, start.len()) {
                    let help = Message::from("leave out ") + Setting::Resume;
                    return Err(scene.refuse("the checkpoint does not fit this action", help));
                }
            }
            None => {
                if let Some(LaidOut { quality, .. }) = &begun.laid_out {
                    self.report.decisions.push(laid_out(quality));
                    self.report.warnings.extend(quality.warning());
                }
                self.report.warnings.extend(begun.note.take());
                if let Some(placed) = begun.start_positions {
                    self.state.x = placed;
                    self.state.stop();
                    if let Some(frames) = self.of_garment.as_mut().filter(|_| self.frames.is_wanted()) {
                        frames.put(&self.mesh, &self.state.x);
                    }
                    if begun.runner.accumulates_memory() {
                        // The move as a whole is no bend.
                        let angle = self.stepper.cloth.bending.angles(&self.state.x, &self.state.angle);
                        self.state.angle = angle;
                    }
                }
            }
        }
        let begin = progress.as_ref().map_or(self.state.time, |progress| progress.begin);
        let duration = begun.duration.unwrap_or_else(|| action.as_wear_action().duration());
        let active = ActiveAction { number, start, begin, duration, before, name: action.name() };
        if let Some(progress) = self.perform_segments(&active, begun.runner.as_mut(), progress, observer)? {
            return Ok(Some(progress));
        }
        if let Some(failure) = begun.runner.failure(&self.state.x) {
            let failure = failure.into_diagnostic(script_name, &location);
            self.report.warnings.push(Message::from("did not take place: ") + failure.to_message());
            self.report.not_performed.get_or_insert(failure);
        }
        self.report.warn(begun.runner.note().map(|what| format!("{location}: {what}")));
        begun.runner.finish(&mut self.persistent, &self.state.x);
        if !begun.runner.accumulates_memory() {
            let rest = &self.memory.rest;
            let bends = self.state.angle.iter().zip(&rest.source_angle).map(|(angle, source)| angle - source);
            self.persistent.laid_bend =
                bends.zip(rest.angle_changes()).map(|(b, own)| b - towards(b, own)).collect();
        }
        Ok(None)
    }

    /// Reports the checkpoint before the action `number`.
    pub(in crate::bake) fn checkpoint_boundary(
        &mut self,
        number: usize,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        self.clear_caches();
        if observer.wants_checkpoints() {
            let position = CheckpointPosition::before_action(number);
            observer.checkpoint(self.checkpoint(position, &self.persistent))?;
        }
        Ok(())
    }

    /// Reports a checkpoint within an action, every few steps.
    fn maybe_checkpoint(
        &mut self,
        action: &ActiveAction,
        runner: &dyn ActionRunner,
        segment: usize,
        dt_request: f64,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        if !self.report.steps.is_multiple_of(self.checkpoint_steps) {
            return Ok(());
        }
        let Some(runner_state) = runner.save_state() else { return Ok(()) };
        self.clear_caches();
        if observer.wants_checkpoints() {
            let progress = ActionProgress {
                start: action.start.clone(),
                begin: action.begin,
                segment,
                dt_request,
                runner_state,
            };
            let position = CheckpointPosition::within_action(action.number, progress);
            observer.checkpoint(self.checkpoint(position, &action.before))?;
        }
        Ok(())
    }

    /// Refines the mesh if that is due and the action can go on after it; then returns its progress on the new mesh.
    fn maybe_refine(
        &mut self,
        action: &ActiveAction,
        runner: &mut dyn ActionRunner,
        segment: usize,
        dt_request: f64,
        observer: &mut dyn Observer,
    ) -> Option<ActionProgress> {
        let marked = self.triangles_to_bisect(action.number);
        if marked.is_empty() {
            return None;
        }
        let refinement = self.mesh.bisect(&marked);
        let runner_state = runner.save_state()?;
        // An action that keeps something of every point goes on with the points it began with.
        if !runner.restore_state(&runner_state, refinement.mesh.garment.points.len()) {
            return None;
        }
        let (start, begin) = (action.start.clone(), action.begin);
        let progress = ActionProgress { start, begin, segment, dt_request, runner_state };
        let progress = self.refine(refinement, progress, &action.before);
        if self.of_garment.is_none() {
            observer.on_mesh(&self.mesh.garment);
        }
        Some(progress)
    }

    /// Makes the steps of an action, segment by segment between its event times, from `progress` if there is one; returns the
    /// progress when the mesh was refined before the end.
    fn perform_segments(
        &mut self,
        action: &ActiveAction,
        runner: &mut dyn ActionRunner,
        progress: Option<ActionProgress>,
        observer: &mut dyn Observer,
    ) -> Result<Option<ActionProgress>> {
        let begin = action.begin;
        let first_dt = TUNING.stepping.first_dt;
        let mut ends = runner.event_times();
        ends.retain(|stop| *stop < action.duration);
        ends.push(action.duration);
        let mut dt_request = progress.as_ref().map_or(first_dt, |progress| progress.dt_request);
        let first = progress.as_ref().map_or(0, |progress| progress.segment);
        for (segment, stop) in ends.iter().copied().enumerate().skip(first) {
            let segment_start = segment.checked_sub(1).map_or(0.0, |before| ends[before]);
            if progress.is_none() || segment > first {
                dt_request = dt_request.min(first_dt);
                // The loads change here: a two-step method restarts.
                self.state.previous = None;
            }
            while begin + stop - self.state.time > 1e-9 {
                self.maybe_checkpoint(action, runner, segment, dt_request, observer)?;
                let left = begin + stop - self.state.time;
                // Two equal steps rather than one and a remainder.
                let mut dt =
                    if dt_request >= left { left } else { dt_request.min(0.5 * left.max(dt_request)) };
                let now = self.state.time;
                dt = dt.min(self.stepper.max_dt_under(&runner.loads_at(now - begin + dt, &self.state.x)));
                // Under loads that have not changed for long only memory changes, ever more slowly.
                let unchanged = now - begin - segment_start;
                let growing_dt =
                    TUNING.stepping.hold_dt_growth * (unchanged - TUNING.stepping.long_hold).max(0.0);
                dt_request = self.step(runner, action, StepLimits { dt, growing_dt }, observer)?;
                if observer.should_stop() {
                    return Err(Error::Interrupted);
                }
                if runner.may_end_early() && self.is_at_rest() {
                    break;
                }
                let refined = self.maybe_refine(action, runner, segment, dt_request, observer);
                if refined.is_some() {
                    return Ok(refined);
                }
            }
        }
        Ok(None)
    }

    /// Makes one accepted step: solve, then memory. Returns the length that the next should have [s].
    fn step(
        &mut self,
        runner: &mut dyn ActionRunner,
        action: &ActiveAction,
        limits: StepLimits,
        observer: &mut dyn Observer,
    ) -> Result<f64> {
        let StepLimits { dt, growing_dt } = limits;
        let step_options = self.step_options;
        if step_options.min_dt < step_options.max_dt {
            self.stepper.options.max_dt = step_options.max_dt.max(growing_dt);
        }
        let (angle, stretch) = (self.state.angle.clone(), self.stretches());
        let start = self.frames.step_start(&self.state);
        let (step, offsets) = self.advance(runner, action.begin, dt, start.as_ref());
        self.seconds.add_step(&step);
        self.report.steps += 1;
        self.report.rejected += step.rejected as u64;
        self.report.solves += step.newton.global_iterations as u64;
        self.report.local_solves += step.newton.local_iterations as u64;
        self.report.cost += step.newton.cost;
        self.convergence.record(&step);
        self.violations.record(self.state.time, &step.violations);
        let on_body = self.body.as_ref().filter(|_| self.persistent.body.is_some());
        let lost = on_body.and_then(|body| body.cause_to_stop(self.state.time, &self.state.x));
        if let Some(cause) = self.violations.cause_to_stop(self.state.time).or(lost) {
            return Err(self.stop(action, cause));
        }
        let clock = Instant::now();
        let mut next = step.next_dt;
        if let (Some(model), true) = (&self.model, runner.accumulates_memory() && !self.is_opening) {
            let stretch_after = self.stretches();
            let source = &self.memory.rest.source_angle;
            let [angle, angle_after] =
                [&angle, &self.state.angle].map(|a| self.persistent.remembered_angle(a, source));
            let before = Strains { angle: &angle, stretch: &stretch };
            let after = Strains { angle: &angle_after, stretch: &stretch_after };
            let events = self.memory.commit(model, &before, &after, step.dt);
            if let Some(softening) = runner.softening(self.state.time - action.begin) {
                self.memory.soften(&self.mesh.garment, softening, after.angle, step.dt);
            }
            next = next
                .min(model.max_dt_after_events(events, self.event_dt_fraction).max(growing_dt))
                .max(self.stepper.options.min_dt);
        }
        self.seconds.memory += clock.elapsed().as_secs_f64();
        observer.progress(&BakeProgress {
            stage: action.name,
            time: self.state.time,
            total: self.total,
            steps: self.report.steps,
            step: step.dt,
            iterations: step.newton.global_iterations,
            events: self.memory.events,
        });
        if let Some(start) = start {
            let (mesh, of_garment) = (&self.mesh, &mut self.of_garment);
            let mut show = |x: &[Vec3]| show_frame(observer, of_garment.as_mut(), mesh, x);
            self.frames.show_due(&start, &self.state, &mesh.garment.triangles, &offsets, &mut show)?;
            if let Some(frames) = of_garment {
                frames.keep_up(mesh, &self.state.x);
            }
        }
        Ok(next)
    }

    /// Ends the run in `action`: what is known until here goes into the report.
    fn stop(&mut self, action: &ActiveAction, cause: StopCause) -> Error {
        let failure = Error::NotConverged(Message::from(action.name) + ": " + cause.reason.clone());
        let location = format!("actions[{}] ({})", action.number, action.name);
        self.report.stopped = Some(EarlyStop { action: location, time: self.state.time, cause });
        failure
    }

    /// Shows the state at the end of the script, if frames are wanted.
    pub(in crate::bake) fn show_last_frame(&mut self, observer: &mut dyn Observer) -> Result<()> {
        if !self.frames.is_wanted() {
            return Ok(());
        }
        let (mesh, of_garment) = (&self.mesh, &mut self.of_garment);
        self.frames.show(&self.state.x, &mut |x| show_frame(observer, of_garment.as_mut(), mesh, x))
    }

    /// Makes one accepted step, on the body if there is one; also returns, on a body, how the frames that it passes from `start` differ from
    /// the chord between its ends.
    fn advance(
        &mut self,
        runner: &mut dyn ActionRunner,
        begin: f64,
        dt: f64,
        start: Option<&StepStart>,
    ) -> (StepReport, Vec<Vec<Vec3>>) {
        let rest = &self.memory.effective_rest;
        match &mut self.body {
            Some(body) => {
                let (stepper, state) = (&mut self.stepper, &mut self.state);
                let cloth = SteppedCloth { garment: &self.mesh.garment, stepper, state, rest };
                let (step, frames) = (StepRange { begin, dt }, start.map(|start| (&self.frames, start)));
                body.step(cloth, runner, step, frames)
            }
            None => {
                let mut loads_at_time = |time: f64, state: &State| runner.loads_at(time - begin, &state.x);
                (self.stepper.advance(&mut self.state, rest, &mut loads_at_time, dt), Vec::new())
            }
        }
    }

    /// Stretches of the triangles, if the memory law needs them.
    fn stretches(&self) -> Vec<[f64; 3]> {
        if self.model.as_ref().is_some_and(MemoryModel::remembers_length) {
            self.stepper.cloth.membrane.measure(&self.state.x)
        } else {
            Vec::new()
        }
    }

    fn is_at_rest(&self) -> bool {
        let sum: f64 = self.state.v.iter().map(|v| v.norm_squared()).sum();
        (sum / self.mesh.garment.points.len() as f64).sqrt() < TUNING.stepping.max_rest_speed
    }
}

/// Returns the part of `bend` that leads to `remembered` (both from the source angle) [rad]: cloth bends so far by itself.
fn towards(bend: f64, remembered: f64) -> f64 {
    bend.clamp(remembered.min(0.0), remembered.max(0.0))
}

/// Shows `mesh` with its points at `x` [m], or the garment if there are frames `of_garment`; returns the largest distance between the
/// two [m].
fn show_frame(
    observer: &mut dyn Observer,
    of_garment: Option<&mut GarmentFrames>,
    mesh: &SimulationMesh,
    x: &[Vec3],
) -> Result<f64> {
    match of_garment {
        Some(frames) => {
            let GarmentFrame { points, distance } = frames.show(mesh, x);
            observer.frame(&points).map(|()| distance)
        }
        None => observer.frame(x).map(|()| 0.0),
    }
}
