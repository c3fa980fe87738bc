//! One time step of the cloth: the stages in the order of the method, and the control of the step's length.

use crate::contact::Contact;
use crate::energy::{
    Drag, EdgeContacts, Energy, Gravity, PlaneContacts, Pressure, ShrinkingSphere, TargetSprings,
};
use crate::garment::RestState;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::sim::integrator::{InnerSolver, Stage, StepAttempt};
use crate::sim::{
    Cloth, Inertia, Method, NewtonOptions, NewtonReport, PreviousState, Problem, State, StepRelaxation,
    Violations, Workspace,
};

/// How steps are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepOptions {
    /// The integrator.
    pub method: Method,
    /// When Newton stops.
    pub newton: NewtonOptions,
    /// Error of one step that is aimed at, root mean square over the points [m].
    pub local_error_tol: f64,
    /// Shortest step [s]; below it a step is accepted as it is, with a warning.
    pub min_dt: f64,
    /// Longest step [s].
    pub max_dt: f64,
    /// Where it may be less strict.
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

/// What an accepted step was like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Length [s].
    pub dt: f64,
    /// Length the next step should have [s].
    pub next_dt: f64,
    /// Estimated error, root mean square over the points [m].
    pub error: f64,
    /// Newton's work, summed over rejected tries.
    pub newton: NewtonReport,
    /// Tries that were thrown away.
    pub rejected: usize,
    /// Whether Newton converged, or nearly (it need not at the shortest step).
    pub converged: bool,
    /// What it could not do as it was told.
    pub violations: Violations,
}

/// Makes steps of one garment.
pub struct Stepper {
    /// The elastic model.
    pub cloth: Cloth,
    /// Contact.
    pub contact: Contact,
    /// How steps are made.
    pub options: StepOptions,
    work: Workspace,
    /// Length that the error of the last step would have let the next one have [s].
    could_take: f64,
}

/// Energies of a step borrow its parts; this owns what must outlive them.
struct Forces {
    held: Vec<bool>,
    push: Vec<f64>,
    /// Of a closing ball, one per point each: stiffness [N/m], force at most [N]; empty without one.
    wall: Vec<f64>,
    hands: Vec<f64>,
}

impl Stepper {
    /// A stepper for `cloth`.
    pub fn new(cloth: Cloth, contact: Contact, options: StepOptions) -> Self {
        Self { cloth, contact, options, work: Workspace::default(), could_take: 0.0 }
    }

    /// Forgets what is kept between steps for speed alone (the pattern of the system, its elimination order): the next
    /// step then depends on nothing but what it is given. The pattern decides the order of sums and so the last bits.
    pub fn clear_caches(&mut self) {
        self.work.reset();
        self.contact.clear_caches();
        self.could_take = 0.0;
    }

    /// The longest step that what acts allows [s].
    pub fn max_dt_under(&self, drive: &Loads) -> f64 {
        drive.max_dt * self.options.relaxation.stride(drive)
    }

    /// One accepted step of at most `wished` seconds; `drive_at` gives what acts at a time [s]. The memory is only
    /// read. `state` is replaced by the accepted state; a rejected try leaves no trace.
    pub fn advance(
        &mut self,
        state: &mut State,
        memory: &RestState,
        drive_at: &mut dyn FnMut(f64, &State) -> Loads,
        wished: f64,
    ) -> StepReport {
        let mut h = wished.min(self.options.max_dt);
        let mut drive = drive_at(state.time + h, state);
        // Only in a hold, with steps that memory keeps short, not motion nor what acts, does next to nothing move the cloth.
        let holds = h <= KEPT_SHORT * self.could_take.min(self.max_dt_under(&drive));
        if !holds || self.options.method.solver() != InnerSolver::Newton {
            self.work.expect_motion();
        }
        if h > self.max_dt_under(&drive) {
            h = self.max_dt_under(&drive);
            drive = drive_at(state.time + h, state);
        }
        let mut total = NewtonReport::default();
        for rejected in 0.. {
            let earlier = self.earlier_drives(state, h, drive_at);
            let (next, error, report) = self.attempt(state, memory, (&earlier, &drive), h);
            total.add(&report);
            let last_chance = h <= self.options.min_dt * 1.001;
            let aim = self.options.local_error_tol * self.options.relaxation.stride(&drive).powi(2);
            let too_coarse = error > 4.0 * aim;
            // Little enough is left to go on from here in the next step.
            let unmet = Violations::detect(&next.x, &self.cloth, &self.contact);
            let solved = report.converged
                || report.newton_decrement <= ENOUGH * self.options.newton.decrement_tol
                || self.options.method.solver() != InnerSolver::Newton;
            // What barely moves is pressed fast: smaller steps would not loosen it.
            let stands = error <= aim;
            if (solved && !too_coarse) || stands || last_chance {
                let exponent = 1.0 / f64::from(self.options.method.order() + 1);
                let wanted = (0.8 * aim / error.max(1e-12)).powf(exponent).clamp(0.3, 1.9);
                // A step that did not converge is a hard one: do not grow into the next.
                let growth = if solved || stands { wanted } else { wanted.min(1.0) };
                self.could_take = h * growth;
                *state = next;
                self.contact.end_step(&state.x, h);
                return StepReport {
                    dt: h,
                    next_dt: (h * growth).max(self.options.min_dt).min(self.options.max_dt),
                    error,
                    newton: total,
                    rejected,
                    converged: solved,
                    violations: unmet,
                };
            }
            // Trying every half on the way down costs more than the shortest step itself.
            h = if report.converged {
                (0.5 * h).max(self.options.min_dt)
            } else {
                self.options.min_dt.min(0.5 * h)
            };
            drive = drive_at(state.time + h, state);
        }
        unreachable!("the shortest step is always accepted")
    }

    /// What acts at the ends of all parts of a step but the last.
    fn earlier_drives(
        &self,
        state: &State,
        h: f64,
        drive_at: &mut dyn FnMut(f64, &State) -> Loads,
    ) -> Vec<Loads> {
        let parts = self.options.method.stage_times();
        parts[..parts.len() - 1].iter().map(|share| drive_at(state.time + share * h, state)).collect()
    }

    /// Tries one step; the state it would lead to, and its error [m]. Obstacles are where they are at its end from the
    /// beginning on: who is near is found once.
    fn attempt(
        &mut self,
        state: &State,
        memory: &RestState,
        (earlier, drive): (&[Loads], &Loads),
        h: f64,
    ) -> (State, f64, NewtonReport) {
        let method = self.options.method;
        self.contact.set_planes(drive.ground, drive.ceiling);
        let forces = self.forces(drive, &state.x);
        self.contact.begin_step(&state.x, h, drive.friction, &forces.held);
        let mut report = NewtonReport::default();
        let mut x = state.x.clone();
        let mut inner: Option<Vec<Vec3>> = None;
        let first = earlier.first().unwrap_or(drive);
        if !first.body_displacement.is_empty() {
            self.contact.carry(&mut x, &first.body_displacement);
        }
        for drive in earlier {
            let stage = match &inner {
                None => method.stage(state, h),
                Some(inner) => method.later_stage(state, h, inner),
            };
            report.add(&self.solve_part(state, memory, drive, &forces, &stage, &mut x));
            inner = Some(x.clone());
        }
        let stage = match &inner {
            None => method.stage(state, h),
            Some(inner) => method.later_stage(state, h, inner),
        };
        report.add(&self.solve_part(state, memory, drive, &forces, &stage, &mut x));
        let angle = self.cloth.bending.angles(&x, &state.angle);
        let v = stage.velocity(&x);
        let previous = Some(PreviousState { step: h, x: state.x.clone(), v: state.v.clone() });
        let next = State { time: state.time + h, x, v, angle, previous };
        let error = method.error(&StepAttempt { state, next: &next, stage_positions: inner.as_deref(), h });
        (next, error, report)
    }

    /// Solves the problem of one part of a step, from `x` on.
    fn solve_part(
        &mut self,
        state: &State,
        memory: &RestState,
        drive: &Loads,
        forces: &Forces,
        stage: &Stage,
        x: &mut [Vec3],
    ) -> NewtonReport {
        let inertial = stage.inertial();
        // Damping and drag count from where their rates do in this method.
        let membrane_model = &self.cloth.membrane;
        let measure =
            stage.base_of(membrane_model.measure(&state.x), |x| membrane_model.measure(x), |m| *m, |m| m);
        let bending_model = &self.cloth.bending;
        let angles = |x: &[Vec3]| bending_model.angles(x, &state.angle);
        let angle = stage.base_of(state.angle.clone(), angles, |a| [*a], |[a]| a);
        let membrane = membrane_model.term(memory, &measure, stage.effective_dt);
        let bending = bending_model.term(memory, &angle, stage.effective_dt);
        let gravity = Gravity { mass: &self.cloth.mass, acceleration: drive.gravity };
        let guides = TargetSprings(&drive.springs);
        let drag = Drag {
            mass: &self.cloth.mass,
            start: &stage.base_positions,
            rate: drive.drag / stage.effective_dt,
        };
        let cushions = PlaneContacts(&drive.plane_contacts);
        let supports = EdgeContacts(&drive.edge_contacts);
        let pressure = Pressure { force: &forces.push };
        let container = drive.sphere.as_ref().map(|ball| ShrinkingSphere {
            centre: ball.centre,
            radius: ball.radius,
            stiffness: &forces.wall,
            max_force: &forces.hands,
        });
        let mut terms: Vec<&dyn Energy> = vec![&membrane, &bending, &gravity];
        if !drive.springs.is_empty() {
            terms.push(&guides);
        }
        if !drive.plane_contacts.is_empty() {
            terms.push(&cushions);
        }
        if !drive.edge_contacts.is_empty() {
            terms.push(&supports);
        }
        if drive.drag > 0.0 {
            terms.push(&drag);
        }
        if drive.pressure > 0.0 {
            terms.push(&pressure);
        }
        if let Some(container) = &container {
            terms.push(container);
        }
        // One iteration alone is what its method says, not a better one.
        let ahead = (self.options.method.solver() == InnerSolver::Newton).then_some(&inertial[..]);
        let problem = Problem {
            inertia: Some(Inertia {
                mass: &self.cloth.mass,
                inertial: &inertial,
                effective_dt: stage.effective_dt,
            }),
            terms: &terms,
            fixed: &forces.held,
            predicted_positions: ahead,
        };
        let mut newton = self.options.newton;
        if self.options.method.solver() == InnerSolver::SingleNewton {
            newton.max_iterations = 1;
        }
        // What a direction promises may be all of stiff contact: beside it the way of cloth that floats counts for nothing. Hands hold
        // what they move.
        if !drive.guided {
            newton.rel_decrement_tol = 0.0;
        }
        newton.decrement_tol =
            self.options.relaxation.energy(newton.decrement_tol, drive, self.cloth.kinetic_energy(&state.v));
        match self.options.method.solver() {
            InnerSolver::Newton | InnerSolver::SingleNewton => {
                problem.solve(x, &mut self.contact, &newton, &mut self.work)
            }
            InnerSolver::Vbd => problem.sweep(x, &mut self.contact, &mut self.work),
        }
    }

    fn forces(&mut self, drive: &Loads, x: &[Vec3]) -> Forces {
        let held = if drive.fixed.is_empty() { vec![false; x.len()] } else { drive.fixed.clone() };
        let push = if drive.pressure > 0.0 {
            let area = self.contact.uncovered_area(x);
            let acts = |p: usize| drive.pressed.is_empty() || drive.pressed[p];
            area.iter().enumerate().map(|(p, a)| if acts(p) { a * drive.pressure } else { 0.0 }).collect()
        } else {
            Vec::new()
        };
        // The ball's wall is as stiff as layers are to one another.
        let per_area = self.contact.settings().stiffness;
        let of_area = |amount: f64| self.cloth.area.iter().map(|a| a * amount).collect();
        let (wall, hands) = match &drive.sphere {
            Some(ball) => (of_area(per_area), of_area(ball.pressure)),
            None => (Vec::new(), Vec::new()),
        };
        Forces { held, push, wall, hands }
    }

    /// Comes to equilibrium of `terms` from `x`, without inertia and friction. What crosses at `x` still does then.
    pub fn equilibrium(
        &mut self,
        x: &mut [Vec3],
        terms: &[&dyn Energy],
        newton: &NewtonOptions,
    ) -> NewtonReport {
        self.contact.set_planes(None, None);
        self.contact.freeze_initial_intersections();
        let held = vec![false; x.len()];
        self.contact.begin_step(x, f64::INFINITY, 0.0, &held);
        // Terms may differ from those of steps.
        self.work.reset();
        let problem = Problem { inertia: None, terms, fixed: &held, predicted_positions: None };
        problem.solve(x, &mut self.contact, newton, &mut self.work)
    }
}

/// A step is kept short by something else if it is at most this share of what its error and what acts would allow.
const KEPT_SHORT: f64 = 0.6;

/// A step that ran out of iterations counts as settled when what is left to gain is below this many times what
/// convergence asks for.
const ENOUGH: f64 = 10.0;
