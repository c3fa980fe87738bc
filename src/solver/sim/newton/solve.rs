//! The iterations of Newton's method.
//!
//! Every iteration: gradient, positive Hessian, direct solve (over all free points, or over an active set), the
//! collision-free displacement, and a line search that never increases phi.

use crate::contact::Contact;
use crate::sim::newton::context::SolveContext;
use crate::sim::newton::levenberg_marquardt::LevenbergMarquardt;
use crate::sim::newton::line_search::Descent;
use crate::sim::newton::linear_system::Direction;
use crate::sim::newton::local_solve::{LocalSolve, LocalSolveLimits};
use crate::sim::newton::options::NewtonOptions;
use crate::sim::newton::problem::{Inertia, Potential, Problem};
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::tuning::TUNING;
use crate::sim::newton::workspace::Workspace;
use crease_geometry::math::Vec3;
use std::time::Instant;

/// State of the iterations of one solve.
struct Iteration {
    value: Potential,
    /// Step size of the last global iteration [-]; 0 after a local solve.
    global_step: f64,
    damping: LevenbergMarquardt,
    limits: LocalSolveLimits,
}

/// Continuation after an iteration.
enum Next {
    Iterate,
    Stop,
}

/// Returns the middle between two sets of positions.
fn midpoint(from: &[Vec3], to: &[Vec3]) -> Vec<Vec3> {
    from.iter().zip(to).map(|(from, to)| (from + to) * 0.5).collect()
}

impl Problem<'_> {
    /// Whether the last global iteration predicted so little decrease that a local solve may come first.
    fn begins_locally(&self, work: &mut Workspace) -> bool {
        let short = self.inertia.is_some_and(|inertia| inertia.effective_dt <= TUNING.local_first_max_dt);
        let has_budget = work.local_first_budget > 0;
        let may = has_budget && short && !work.is_shifted && work.matrix.has_fixed_set(self.fixed);
        work.local_first_budget = work.local_first_budget.saturating_sub(1);
        may
    }

    /// Minimises phi from `x` in place, after `contact` has begun its step. Layers that are apart at `x` stay apart at
    /// every iterate.
    pub fn solve(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        options: &NewtonOptions,
        work: &mut Workspace,
    ) -> NewtonReport {
        self.solve_again(x, contact, options, 0.0, work)
    }

    /// As [`Self::solve`], from the solution of a problem that differs little, where the first iteration says nothing about
    /// the motion of the step: the tolerance that `rel_decrement_tol` gives is at least `min_diffuse_tol` [J].
    pub fn solve_again(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        options: &NewtonOptions,
        min_diffuse_tol: f64,
        work: &mut Workspace,
    ) -> NewtonReport {
        let mut report = NewtonReport::default();
        if self.fixed.iter().all(|fixed| *fixed) {
            report.converged = true;
            return report;
        }
        let limits = LocalSolveLimits {
            energy_tol: options.decrement_tol,
            diffuse_energy_tol: 0.0,
            max_fraction: TUNING.local.max_active_fraction,
        };
        let begins_locally = self.begins_locally(work);
        let mut context = SolveContext::new(contact, work, &mut report);
        if begins_locally {
            let clock = Instant::now();
            let g = self.gradient(x, context.contact);
            context.report.seconds.assembly += clock.elapsed().as_secs_f64();
            if let LocalSolve::Converged = self.solve_locally(x, &g, limits, &mut context) {
                report.converged = true;
                return report;
            }
        }
        let mut iteration = Iteration {
            value: self.value(x, context.contact),
            global_step: 0.0,
            damping: LevenbergMarquardt::default(),
            limits: LocalSolveLimits { diffuse_energy_tol: min_diffuse_tol, ..limits },
        };
        let spent = |report: &NewtonReport| {
            report.global_iterations + report.local_iterations / TUNING.local_per_global_iterations
        };
        while spent(context.report) < options.max_iterations {
            if let Next::Stop = self.iterate(x, &mut iteration, options, &mut context) {
                break;
            }
        }
        report
    }

    /// Makes one iteration: a local solve where the last global step was long enough and it succeeds, else a global
    /// one.
    fn iterate(
        &self,
        x: &mut [Vec3],
        iteration: &mut Iteration,
        options: &NewtonOptions,
        context: &mut SolveContext,
    ) -> Next {
        let is_first = context.report.global_iterations == 0;
        let midpoint = self.predicted_positions.filter(|_| is_first).map(|to| midpoint(x, to));
        let linearised_at = midpoint.as_deref().unwrap_or(x);
        let g = self.linearise(x, linearised_at, context.contact, context.work, context.report);
        if iteration.global_step >= TUNING.min_step_before_local && !iteration.damping.is_active() {
            match self.solve_locally(x, &g, iteration.limits, context) {
                LocalSolve::Converged if iteration.global_step == 1.0 => {
                    context.report.converged = true;
                    return Next::Stop;
                }
                // After a limited step a global decrease may be left that single points do not show.
                LocalSolve::Converged | LocalSolve::Progressed => {
                    iteration.value = self.value(x, context.contact);
                    iteration.global_step = 0.0;
                    return Next::Iterate;
                }
                LocalSolve::Stalled => {}
            }
        }
        let Some(d) = self.global_direction(x, &g, &iteration.damping, options, context) else {
            return Next::Stop;
        };
        self.take_global_step(x, &g, d, iteration, options, context)
    }

    /// Returns the direction over all free points; `None` if the system cannot be solved.
    fn global_direction(
        &self,
        x: &[Vec3],
        g: &[Vec3],
        damping: &LevenbergMarquardt,
        options: &NewtonOptions,
        context: &mut SolveContext,
    ) -> Option<Vec<Vec3>> {
        let clock = Instant::now();
        let work = &mut *context.work;
        if let Some(Inertia { mass, effective_dt, .. }) = self.inertia.filter(|_| damping.is_active()) {
            damping.add_to(&mut work.matrix, mass, effective_dt);
            work.is_shifted = true;
        }
        let stale = self.direction_with_stale_factor(g, options.decrement_tol, work);
        let direction = stale.or_else(|| self.direction(x, g, work));
        context.report.cost += work.take_cost();
        context.report.seconds.linear_solve += clock.elapsed().as_secs_f64();
        direction
    }

    /// Moves `x` along the global direction `d` and decides on convergence and damping.
    fn take_global_step(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        mut d: Vec<Vec3>,
        iteration: &mut Iteration,
        options: &NewtonOptions,
        context: &mut SolveContext,
    ) -> Next {
        let Iteration { value, global_step, damping, limits } = iteration;
        context.report.global_iterations += 1;
        let Some(Direction { max_deviation, decrement }) = self.clamp_direction(g, &mut d, context.report)
        else {
            return Next::Stop;
        };
        context.report.newton_decrement = decrement;
        if context.report.global_iterations == 1 {
            let is_converged = decrement <= options.decrement_tol;
            context.work.local_first_budget = if is_converged { TUNING.local_first_solves } else { 0 };
            if options.decrement_tol > 0.0 && self.inertia.is_some() {
                limits.diffuse_energy_tol =
                    limits.diffuse_energy_tol.max(options.rel_decrement_tol * decrement);
                context.report.diffuse_tol = limits.diffuse_energy_tol;
            }
        }
        // The predicted decrease of a global direction is diffuse.
        let energy_tol = options.decrement_tol.max(limits.diffuse_energy_tol);
        // Where layers are jammed displacements are small although much energy can still decrease.
        let is_stalled = energy_tol > 0.0 && decrement > TUNING.stall_energy_factor * energy_tol;
        let is_small = context.report.max_displacement <= options.displacement_tol && !is_stalled;
        let is_done = !damping.is_active() && (is_small || decrement <= energy_tol);
        let before = value.sum;
        let descent = Descent { gradient: g, direction: &d };
        let step = self.line_search_eliminating(x, descent, value, energy_tol, context);
        *global_step = step;
        if damping.is_active() && decrement <= energy_tol {
            damping.decrease();
            return Next::Iterate;
        }
        if step == 0.0 && damping.increase() {
            return Next::Iterate;
        }
        if self.inertia.is_some() {
            damping.update((before - value.sum) / decrement.max(f64::MIN_POSITIVE), max_deviation);
        }
        if is_done || step == 0.0 {
            // A direction along which phi decreases by no more than its rounding counts as converged.
            let rounding = 1e-12 * value.magnitude.max(f64::MIN_POSITIVE);
            context.report.converged = is_done || decrement.abs() <= rounding;
            return Next::Stop;
        }
        Next::Iterate
    }
}
