//! One time step of the cloth: the stages of the integrator, and the control of the time step.

use crate::contact::Contact;
use crate::energy::{Energy, RestrictedTerms};
use crate::sim::cloth::Cloth;
use crate::sim::integrator::{InnerSolver, Method, Stage, StageSolve, StepAttempt};
use crate::sim::loads::{LoadSource, Loads};
use crate::sim::newton::{Inertia, NewtonOptions, NewtonReport, Problem, Workspace};
use crate::sim::stage_terms::{LoadBuffers, stage_terms};
use crate::sim::state::{PreviousState, State};
use crate::sim::step_relaxation::StepRelaxation;
use crate::sim::tuning::TUNING;
use crate::sim::violations::Violations;
use crease_geometry::math::Vec3;
use crease_model::garment::RestState;

/// Options of the time stepping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepOptions {
    /// Time integrator.
    pub method: Method,
    /// Stopping criteria of Newton's method.
    pub newton: NewtonOptions,
    /// Tolerance of the local error of one step, root mean square over the points [m].
    pub local_error_tol: f64,
    /// Minimum time step [s]; a step of this length is accepted with any error, unless the cloth crosses an obstacle in it.
    pub min_dt: f64,
    /// Maximum time step [s].
    pub max_dt: f64,
    /// Looser tolerances for some steps.
    pub relaxation: StepRelaxation,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self {
            method: Method::BackwardEuler,
            newton: NewtonOptions::default(),
            local_error_tol: 3e-4,
            min_dt: 1.0 / 30.0,
            max_dt: 5.0,
            relaxation: StepRelaxation::DEFAULT,
        }
    }
}

/// Figures of an accepted step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Length of the step [s].
    pub dt: f64,
    /// Recommended length of the next step [s].
    pub next_dt: f64,
    /// Estimated local error, root mean square over the points [m].
    pub error: f64,
    /// Work of Newton's method, summed over rejected attempts.
    pub newton: NewtonReport,
    /// Number of rejected attempts.
    pub rejected: usize,
    /// Whether Newton's method converged, or nearly; it need not at the minimum time step.
    pub converged: bool,
    /// Constraint violations at the end of the step.
    pub violations: Violations,
}

/// Time stepping of one garment.
pub struct Stepper {
    /// Elastic model.
    pub cloth: Cloth,
    /// Contact model.
    pub contact: Contact,
    /// Options of the time stepping.
    pub options: StepOptions,
    work: Workspace,
    /// Length that the error of the last step allows for the next [s].
    error_limited_dt: f64,
}

/// Loads at the ends of the stages of a step.
struct StageLoads {
    /// Those of all stages but the last.
    earlier: Vec<Loads>,
    /// Those of the last stage.
    last: Loads,
}

/// One stage of a step and what it starts from.
#[derive(Clone, Copy)]
struct StageInputs<'a> {
    state: &'a State,
    rest_state: &'a RestState,
    loads: &'a Loads,
    buffers: &'a LoadBuffers,
    stage: &'a Stage,
}

/// End state of an attempted step.
struct AttemptResult {
    next: State,
    /// Estimated local error, root mean square over the points [m].
    error: f64,
    /// Whether the cloth crosses an obstacle that it did not cross before, beyond what contacts found afterwards could mend.
    crosses: bool,
    report: NewtonReport,
}

impl Stepper {
    /// Returns a stepper of `cloth` with `contact`.
    pub fn new(cloth: Cloth, contact: Contact, options: StepOptions) -> Self {
        Self { cloth, contact, options, work: Workspace::default(), error_limited_dt: 0.0 }
    }

    /// Clears what is kept between steps for speed (sparsity pattern, elimination order, contact search): the next step
    /// then depends on its arguments only. The pattern decides the order of sums and so the last bits.
    pub fn clear_caches(&mut self) {
        self.work.reset();
        self.contact.clear_caches();
        self.error_limited_dt = 0.0;
    }

    /// Returns the maximum time step under `loads` [s].
    pub fn max_dt_under(&self, loads: &Loads) -> f64 {
        loads.max_dt * self.options.relaxation.dt_scale(loads)
    }

    /// Makes one accepted step of at most `dt_request` [s] under the loads of `source` and replaces `state` by its end; `rest_state` is
    /// only read. Rejected attempts leave no trace in `state`.
    pub fn advance(
        &mut self,
        state: &mut State,
        rest_state: &RestState,
        source: &mut dyn LoadSource,
        dt_request: f64,
    ) -> StepReport {
        let converges = self.options.method.converges();
        let mut h = dt_request.min(self.options.max_dt);
        let mut last = source.loads_at(state.time + h, state);
        // Quasi-static step: dt is limited by memory events, not by motion or loads, so a local solve is likely to
        // suffice.
        let allowed_dt = self.error_limited_dt.min(self.max_dt_under(&last));
        let quasi_static = h <= TUNING.quasi_static_dt_fraction * allowed_dt;
        if !quasi_static || !converges {
            self.work.disable_local_first();
        }
        if h > self.max_dt_under(&last) {
            h = self.max_dt_under(&last);
            last = source.loads_at(state.time + h, state);
        }
        let mut total = NewtonReport::default();
        for rejected in 0.. {
            let earlier = self.earlier_stage_loads(state, h, source);
            // The source knows contacts of the loads that it gave last.
            if !earlier.is_empty() {
                last = source.loads_at(state.time + h, state);
            }
            let mut loads = StageLoads { earlier, last };
            let AttemptResult { next, error, crosses, report } =
                self.attempt(state, rest_state, &mut loads, source, h);
            total.add(&report);
            // A body that passes the cloth in one step finds it beyond the reach of contact: only a shorter step meets it.
            let fraction = if crosses { TUNING.min_crossing_dt_fraction } else { 1.0 };
            let is_min_dt = h <= fraction * self.options.min_dt * 1.001;
            let error_tol =
                self.options.local_error_tol * self.options.relaxation.dt_scale(&loads.last).powi(2);
            let too_coarse = error > TUNING.reject_error_factor * error_tol;
            let violations = Violations::detect(&next.x, &self.cloth, &self.contact);
            let nearly_tol = TUNING.nearly_converged_factor * self.options.newton.decrement_tol;
            let solved = report.converged || report.newton_decrement <= nearly_tol || !converges;
            // What guides the cloth may have pushed it through a place that smaller steps lead it around.
            let overstretches = loads.last.guided && violations.stretches_farther(&state.x, &self.cloth);
            let too_coarse = too_coarse || overstretches || crosses;
            // Cloth that barely moves is jammed: a smaller step would not help the solver, unless a body moves on under the cloth.
            let follows_body = loads.last.guided && !loads.last.body_displacement.is_empty();
            let barely_moves = error <= error_tol && !overstretches && !crosses && !follows_body;
            if (solved && !too_coarse) || barely_moves || is_min_dt {
                let growth = self.dt_growth(error, error_tol, solved || barely_moves);
                let violations = if solved {
                    violations
                } else {
                    violations.of_unconverged(&state.x, &next.x, &self.contact)
                };
                self.error_limited_dt = h * growth;
                *state = next;
                self.contact.end_step(&state.x, h);
                return StepReport {
                    dt: h,
                    next_dt: (h * growth).max(self.options.min_dt).min(self.options.max_dt),
                    error,
                    newton: total,
                    rejected,
                    converged: solved,
                    violations,
                };
            }
            // Trying every half on the way down to the minimum costs more than the minimum step itself.
            h = if crosses {
                0.5 * h
            } else if report.converged {
                (0.5 * h).max(self.options.min_dt)
            } else {
                self.options.min_dt.min(0.5 * h)
            };
            last = source.loads_at(state.time + h, state);
        }
        unreachable!("the minimum time step is always accepted")
    }

    /// Returns the ratio of the next time step to this one, which does not grow after a step that `may_grow` excludes.
    fn dt_growth(&self, error: f64, error_tol: f64, may_grow: bool) -> f64 {
        let exponent = 1.0 / f64::from(self.options.method.order() + 1);
        let ratio = (TUNING.error_safety_factor * error_tol / error.max(1e-12)).powf(exponent);
        let growth = ratio.clamp(TUNING.min_dt_ratio, TUNING.max_dt_ratio);
        if may_grow { growth } else { growth.min(1.0) }
    }

    /// Returns the loads at the ends of all stages of a step but the last.
    fn earlier_stage_loads(&self, state: &State, h: f64, source: &mut dyn LoadSource) -> Vec<Loads> {
        let times = self.options.method.stage_times();
        times[..times.len() - 1]
            .iter()
            .map(|fraction| source.loads_at(state.time + fraction * h, state))
            .collect()
    }

    /// Attempts one step of `h` seconds. Obstacles are at their positions of the end of the step from its beginning on:
    /// contact pairs are searched for once, but for those with the body that the end of the step shows to be missing.
    fn attempt(
        &mut self,
        state: &State,
        rest_state: &RestState,
        loads: &mut StageLoads,
        source: &mut dyn LoadSource,
        h: f64,
    ) -> AttemptResult {
        let method = self.options.method;
        let StageLoads { earlier, last } = loads;
        self.contact.set_planes(last.ground, last.ceiling);
        // Zones only where a body carries the cloth: a flap of a fold lands on cloth that lies still.
        self.contact.set_zones(!last.body_displacement.is_empty());
        let buffers = self.load_buffers(last, &state.x);
        self.contact.begin_step(&state.x, h, last.friction, &buffers.fixed);
        let mut report = NewtonReport::default();
        let mut x = state.x.clone();
        let mut stage_positions: Option<Vec<Vec3>> = None;
        let first = earlier.first().unwrap_or(last);
        if !first.body_displacement.is_empty() {
            self.contact.carry(&mut x, &first.body_displacement);
        }
        for loads in earlier {
            let stage = next_stage(method, state, h, stage_positions.as_deref());
            let inputs = StageInputs { state, rest_state, loads, buffers: &buffers, stage: &stage };
            report.add(&self.solve_stage(&inputs, 0.0, &mut x));
            stage_positions = Some(x.clone());
        }
        let stage = next_stage(method, state, h, stage_positions.as_deref());
        let mut revisions = 0..TUNING.max_contact_revisions;
        let mut min_diffuse_tol = 0.0;
        loop {
            let inputs = StageInputs { state, rest_state, loads: last, buffers: &buffers, stage: &stage };
            let solved = self.solve_stage(&inputs, min_diffuse_tol, &mut x);
            min_diffuse_tol = TUNING.revision_tol_factor * solved.diffuse_tol;
            report.add(&solved);
            let revised = revisions.next().and_then(|_| source.revised_contacts(&x, last));
            let Some(contacts) = revised else { break };
            last.edge_contacts = contacts;
        }
        let crosses = source.crosses_more(&x, last);
        let angle = self.cloth.bending.angles(&x, &state.angle);
        let v = stage.velocity(&x);
        let previous = Some(PreviousState { dt: h, x: state.x.clone(), v: state.v.clone() });
        let next = State { time: state.time + h, x, v, angle, previous };
        let attempt = StepAttempt { state, next: &next, stage_positions: stage_positions.as_deref(), h };
        let error = method.error(&attempt);
        AttemptResult { next, error, crosses, report }
    }

    /// Solves one stage of a step, from `x` on. `min_diffuse_tol` [J]: see [`Problem::solve_again`].
    fn solve_stage(&mut self, inputs: &StageInputs, min_diffuse_tol: f64, x: &mut [Vec3]) -> NewtonReport {
        let StageInputs { state, rest_state, loads, buffers, stage } = *inputs;
        let method = self.options.method;
        let inertial = stage.inertial();
        // The rates of damping and drag have the same base as the velocity.
        let membrane = &self.cloth.membrane;
        let measure = stage.base_of(membrane.measure(&state.x), |x| membrane.measure(x), |m| *m, |m| m);
        let bending = &self.cloth.bending;
        let angles = |x: &[Vec3]| bending.angles(x, &state.angle);
        let angle = stage.base_of(state.angle.clone(), angles, |a| [*a], |[a]| a);
        let membrane = membrane.term(rest_state, &measure, stage.effective_dt);
        let bending = bending.term(rest_state, &angle, stage.effective_dt);
        let terms = stage_terms(&self.cloth, loads, buffers, stage, membrane, bending);
        let whole: Vec<&dyn Energy> = terms.iter().map(AsRef::as_ref).collect();
        // Elements between fixed points alone exert no force on free ones.
        let free: Vec<bool> = buffers.fixed.iter().map(|fixed| !fixed).collect();
        let restricted = free.contains(&false).then(|| RestrictedTerms::new(&whole, &free));
        let parts = restricted.as_ref().map(RestrictedTerms::terms);
        let terms: &[&dyn Energy] = parts.as_deref().unwrap_or(&whole);
        let inertia =
            Inertia { mass: &self.cloth.mass, inertial: &inertial, effective_dt: stage.effective_dt };
        let problem = Problem {
            inertia: Some(inertia),
            terms,
            fixed: &buffers.fixed,
            // Fixed work is defined with the Hessian at the beginning.
            predicted_positions: method.converges().then_some(&inertial[..]),
        };
        let mut newton = self.options.newton;
        // Without guiding springs the first predicted decrease may come from stiff contact alone, beside which the
        // motion of cloth that floats would count for nothing.
        if !loads.guided {
            newton.rel_decrement_tol = 0.0;
        }
        let kinetic = self.cloth.kinetic_energy(&state.v);
        newton.decrement_tol = self.options.relaxation.energy_tol(newton.decrement_tol, loads, kinetic);
        let (contact, work) = (&mut self.contact, &mut self.work);
        match method.solver() {
            InnerSolver::Newton => problem.solve_again(x, contact, &newton, min_diffuse_tol, work),
            InnerSolver::FixedWork(solve) => {
                solve(StageSolve { problem: &problem, contact, options: newton, min_diffuse_tol, work }, x)
            }
        }
    }

    fn load_buffers(&mut self, loads: &Loads, x: &[Vec3]) -> LoadBuffers {
        let fixed = if loads.fixed.is_empty() { vec![false; x.len()] } else { loads.fixed.clone() };
        let pressure_force = if loads.pressure > 0.0 {
            let area = self.contact.uncovered_area(x);
            let acts = |p: usize| loads.pressed.is_empty() || loads.pressed[p];
            area.iter().enumerate().map(|(p, a)| if acts(p) { a * loads.pressure } else { 0.0 }).collect()
        } else {
            Vec::new()
        };
        // The sphere is as stiff as contact between layers.
        let per_area = self.contact.settings().stiffness;
        let of_area = |amount: f64| self.cloth.area.iter().map(|a| a * amount).collect();
        let (sphere_stiffness, sphere_max_force) = match &loads.sphere {
            Some(sphere) => (of_area(per_area), of_area(sphere.pressure)),
            None => (Vec::new(), Vec::new()),
        };
        LoadBuffers { fixed, pressure_force, sphere_stiffness, sphere_max_force }
    }

    /// Minimises the sum of `terms` from `x` in place, without inertia and friction. The `fixed` points, one flag per point, do not move,
    /// and intersections at `x` are kept.
    pub fn equilibrium(
        &mut self,
        x: &mut [Vec3],
        fixed: &[bool],
        terms: &[&dyn Energy],
        newton: &NewtonOptions,
    ) -> NewtonReport {
        self.contact.set_planes(None, None);
        self.contact.set_zones(false);
        self.contact.freeze_initial_intersections();
        self.contact.begin_step(x, f64::INFINITY, 0.0, fixed);
        // Terms may couple other points than those of steps.
        self.work.reset();
        let problem = Problem { inertia: None, terms, fixed, predicted_positions: None };
        problem.solve(x, &mut self.contact, newton, &mut self.work)
    }
}

/// Returns the stage after the one that ended at `stage_positions`, or the first.
fn next_stage(method: Method, state: &State, h: f64, stage_positions: Option<&[Vec3]>) -> Stage {
    match stage_positions {
        None => method.stage(state, h),
        Some(positions) => method.later_stage(state, h, positions),
    }
}
