//! Local Newton iterations on an active set, all other points fixed.
//!
//! After a full global step the remaining decrease of the energy is usually concentrated in a few points: a contact
//! that appeared or vanished, an element that flipped. Points are ranked by the predicted decrease of moving them
//! alone, `g . D⁻¹ g` with the diagonal Hessian block D. The smallest are omitted while their sum stays below a
//! fraction of the energy tolerance; the rest and two rings of neighbours are the active set. Newton iterations with
//! the elements and contacts around the set run until their decrement is below the same fraction, which costs little
//! beside a global iteration. The global gradient then decides whether another set is needed.

use crate::contact::Contact;
use crate::energy::RestrictedTerms;
use crate::sim::newton::context::SolveContext;
use crate::sim::newton::line_search::Descent;
use crate::sim::newton::problem::Problem;
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::tuning::TUNING;
use crate::sim::newton::workspace::Workspace;
use crease_geometry::math::Vec3;
use std::time::Instant;

/// Limits of a local solve.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalSolveLimits {
    /// Energy tolerance [J].
    pub energy_tol: f64,
    /// Energy tolerance where the predicted decrease is diffuse, little at each of many points [J].
    pub diffuse_energy_tol: f64,
    /// Maximum active fraction of the free points [-]; with more a local solve is not worthwhile.
    pub max_fraction: f64,
}

/// Outcome of a local solve.
pub(super) enum LocalSolve {
    /// The predicted decrease is below the tolerance.
    Converged,
    /// Points have moved, and more decrease is predicted than local iterations can reach.
    Progressed,
    /// No point has moved.
    Stalled,
}

impl Problem<'_> {
    /// Solves on active sets from `x`, with gradient `g` there and the system as last assembled. A solve that uses up its rounds is the
    /// last of the step: pairs in a spot where layers are pressed to nothing move by a part of their gap at a time.
    pub(super) fn solve_locally(
        &self,
        x: &mut [Vec3],
        g: &[Vec3],
        limits: LocalSolveLimits,
        context: &mut SolveContext,
    ) -> LocalSolve {
        let mut g = g.to_vec();
        let mut outcome = LocalSolve::Stalled;
        if context.local_gave_up {
            return outcome;
        }
        for _ in 0..TUNING.local.max_rounds {
            let clock = Instant::now();
            let active = self.select_active_points(&g, limits, context.work, context.report);
            context.report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            let Some(active) = active else { return outcome };
            if !active.contains(&true) {
                return LocalSolve::Converged;
            }
            if !self.solve_subset(x, &active, limits.energy_tol, context) {
                return outcome;
            }
            outcome = LocalSolve::Progressed;
            let clock = Instant::now();
            g = self.gradient(x, context.contact);
            context.report.seconds.assembly += clock.elapsed().as_secs_f64();
        }
        context.local_gave_up = true;
        outcome
    }

    /// Returns the active set, one flag per point, without which the predicted decrease is below a fraction of the
    /// energy tolerance; empty where that of all points is. `None` if it would be too large.
    fn select_active_points(
        &self,
        g: &[Vec3],
        limits: LocalSolveLimits,
        work: &Workspace,
        report: &mut NewtonReport,
    ) -> Option<Vec<bool>> {
        let tuning = &TUNING.local;
        let matrix = &work.matrix;
        let omitted_tol = tuning.omitted_energy_fraction * limits.energy_tol;
        let mut decreases: Vec<(f64, u32)> = Vec::with_capacity(matrix.row_count());
        for (r, &p) in matrix.points().iter().enumerate() {
            let g = &g[p as usize];
            decreases.push((matrix.diagonal(r).cholesky()?.solve(g).dot(g), p));
        }
        decreases.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let total = decreases.iter().map(|(decrease, _)| decrease).sum::<f64>();
        if total <= omitted_tol {
            report.newton_decrement = total;
            return Some(vec![false; g.len()]);
        }
        // The points with the largest decreases, without which the others have at most `sum_tol` together and
        // `point_tol` each.
        let select = |sum_tol: f64, point_tol: f64| {
            let mut left = sum_tol;
            let omitted = decreases.iter().take_while(|(decrease, _)| {
                left -= decrease;
                left >= 0.0 && *decrease <= point_tol
            });
            let omitted = omitted.count();
            let mut active = vec![false; g.len()];
            decreases[omitted..].iter().for_each(|&(_, p)| active[p as usize] = true);
            (0..tuning.neighbour_rings).for_each(|_| matrix.dilate(&mut active));
            let count = active.iter().filter(|a| **a).count();
            (count as f64 <= limits.max_fraction * matrix.row_count() as f64).then_some(active)
        };
        select(omitted_tol, f64::INFINITY).or_else(|| {
            let diffuse_tol = tuning.omitted_energy_fraction * limits.diffuse_energy_tol;
            let point_tol = tuning.max_point_energy_fraction * limits.energy_tol;
            let active = (diffuse_tol > omitted_tol).then(|| select(diffuse_tol, point_tol)).flatten()?;
            if !active.contains(&true) {
                report.newton_decrement = total;
            }
            Some(active)
        })
    }

    /// Iterates on the `active` points alone, until their decrement is below a fraction of `energy_tol` [J]. Whether
    /// any point has moved.
    fn solve_subset(
        &self,
        x: &mut [Vec3],
        active: &[bool],
        energy_tol: f64,
        context: &mut SolveContext,
    ) -> bool {
        let clock = Instant::now();
        let restricted = RestrictedTerms::new(self.terms, active);
        let terms = restricted.terms();
        let fixed: Vec<bool> = active.iter().map(|active| !active).collect();
        let problem =
            Problem { inertia: self.inertia, terms: &terms, fixed: &fixed, predicted_positions: None };
        context.report.seconds.assembly += clock.elapsed().as_secs_f64();
        time_contact(context, |contact| contact.restrict_to(x, active));
        let mut own = context.work.local.take().unwrap_or_default();
        own.swap_buffers_with(context.work);
        let mut local = SolveContext::new(context.contact, &mut own, context.report);
        let has_moved = problem.iterate_locally(x, energy_tol, &mut local);
        own.swap_buffers_with(context.work);
        own.release_if_larger_than(TUNING.local.max_kept_factor_entries);
        context.work.local = Some(own);
        time_contact(context, Contact::unrestrict);
        has_moved
    }

    /// Newton iterations of [`Self::solve_subset`], on the problem of the subset.
    fn iterate_locally(&self, x: &mut [Vec3], energy_tol: f64, context: &mut SolveContext) -> bool {
        let min_step = TUNING.line_search.min_step;
        let mut value = self.value(x, context.contact);
        let mut has_moved = false;
        for _ in 0..TUNING.local.max_iterations {
            let g = self.linearise(x, x, context.contact, context.work, context.report);
            let clock = Instant::now();
            let direction = self.direction(x, &g, context.work);
            context.report.cost += context.work.take_cost();
            context.report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            let Some(mut d) = direction else { break };
            context.report.local_iterations += 1;
            let Some(clamped) = self.clamp_direction(&g, &mut d, context.report) else { break };
            let descent = Descent { gradient: &g, direction: &d };
            let step = self.line_search(x, descent, &mut value, context);
            has_moved |= step > min_step;
            if clamped.decrement <= TUNING.local.omitted_energy_fraction * energy_tol || step <= min_step {
                break;
            }
        }
        has_moved
    }
}

/// Changes contact and reports the time it took.
fn time_contact(context: &mut SolveContext, change: impl FnOnce(&mut Contact)) {
    let clock = Instant::now();
    change(context.contact);
    context.report.seconds.contact += clock.elapsed().as_secs_f64();
}
