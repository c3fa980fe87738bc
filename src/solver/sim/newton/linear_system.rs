//! The linear system of one iteration: assembly, and the Newton direction.

use crate::contact::Contact;
use crate::sim::newton::problem::{Inertia, Problem};
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::tuning::TUNING;
use crate::sim::newton::workspace::Workspace;
use crease_geometry::math::{Vec3, dot};
use crease_linear::{BlockMatrix, FactorError, INVALID, conjugate_gradient};
use std::time::Instant;

/// Properties of a direction.
pub(super) struct Direction {
    /// Largest deviation of a point's displacement from the mean, before it was clamped [m].
    pub max_deviation: f64,
    /// Predicted decrease to first order, the Newton decrement [J].
    pub decrement: f64,
}

/// Returns the largest deviation of a free point's displacement from the mean over all free points [m].
fn max_deviation(d: &[Vec3], fixed: &[bool]) -> f64 {
    let free = || d.iter().zip(fixed).filter(|(_, fixed)| !**fixed).map(|(d, _)| d);
    let mean = free().sum::<Vec3>() / free().count().max(1) as f64;
    free().map(|d| (d - mean).norm()).fold(0.0, f64::max)
}

/// Returns the negative gradient over the rows of `matrix`, the right-hand side of a Newton direction.
fn negative_gradient(matrix: &BlockMatrix, g: &[Vec3]) -> Vec<Vec3> {
    matrix.gather(g).into_iter().map(|g| -g).collect()
}

/// Returns the row of every point, counted over the free points.
fn rows_of_free_points(fixed: &[bool]) -> Vec<u32> {
    let mut next = 0;
    fixed
        .iter()
        .map(|fixed| {
            let row = if *fixed { INVALID } else { next };
            next += u32::from(!*fixed);
            row
        })
        .collect()
}

impl Problem<'_> {
    /// Assembles the system at `x`, with the secant Hessian for a path with its middle at `midpoint` (or `x` itself).
    fn assemble(&self, x: &[Vec3], midpoint: &[Vec3], contact: &Contact, work: &mut Workspace) {
        work.is_shifted = false;
        // The pattern has a margin, and grows by contacts that come later.
        let rebuilds = !work.matrix.has_fixed_set(self.fixed) || work.matrix.should_rebuild();
        if rebuilds {
            work.matrix = BlockMatrix::with_pattern(rows_of_free_points(self.fixed), &mut |visit| {
                self.terms.iter().for_each(|t| t.visit_stencils(visit));
                contact.visit_stencils(x, TUNING.pattern_dhat_factor, visit);
            });
        }
        let grew = work.matrix.fill(&|out| {
            self.terms.iter().for_each(|term| term.add_secant_hessian(x, midpoint, out));
            contact.add_hessian(x, out);
        });
        debug_assert!(!(rebuilds && grew), "a term adds a block outside its stencils");
        if let Some(Inertia { mass, effective_dt, .. }) = self.inertia {
            for (p, m) in mass.iter().enumerate() {
                work.matrix.add_diagonal(p, m / (effective_dt * effective_dt));
            }
        }
    }

    /// Assembles the system at `x` as [`Self::assemble`] and returns the gradient, one per point [N].
    pub(super) fn linearise(
        &self,
        x: &[Vec3],
        midpoint: &[Vec3],
        contact: &Contact,
        work: &mut Workspace,
        report: &mut NewtonReport,
    ) -> Vec<Vec3> {
        let clock = Instant::now();
        let g = self.gradient(x, contact);
        report.residual = g.iter().map(|g| g.amax()).fold(0.0, f64::max);
        self.assemble(x, midpoint, contact, work);
        report.seconds.assembly += clock.elapsed().as_secs_f64();
        g
    }

    /// Returns the Newton direction for gradient `g` by the stale factor of an earlier system; `None` where the system
    /// has changed too much since.
    pub(super) fn direction_with_stale_factor(
        &self,
        g: &[Vec3],
        energy_tol: f64,
        work: &mut Workspace,
    ) -> Option<Vec<Vec3>> {
        if work.factorised_for != self.fixed {
            return None;
        }
        let strict = work.stale_backoff > 0;
        let mut rhs = negative_gradient(&work.matrix, g);
        if work.direct.solve_with_stale_factor(&work.matrix, &mut rhs, energy_tol, strict) {
            (work.stale_backoff, work.next_backoff) = (0, 1);
            return Some(work.matrix.scatter(&rhs));
        }
        if strict {
            work.stale_backoff -= 1;
            return None;
        }
        work.stale_backoff = work.next_backoff;
        work.next_backoff = (2 * work.next_backoff).clamp(1, TUNING.max_stale_backoff);
        None
    }

    /// Returns the Newton direction at `x` for gradient `g`; `None` if the system cannot be made positive definite.
    pub(super) fn direction(&self, x: &[Vec3], g: &[Vec3], work: &mut Workspace) -> Option<Vec<Vec3>> {
        let tuning = &TUNING.linear_solve;
        let mut rhs = negative_gradient(&work.matrix, g);
        let mut shift = 0.0;
        work.factorised_for.clear();
        for _ in 0..tuning.max_factorisations {
            let factorised = work.direct.factorise(&work.matrix, x);
            match factorised.and_then(|()| work.direct.solve(&work.matrix, &mut rhs)) {
                Ok(()) => {
                    work.factorised_for.extend_from_slice(self.fixed);
                    return Some(work.matrix.scatter(&rhs));
                }
                Err(FactorError::TooLarge) => {
                    let solution =
                        conjugate_gradient(&work.matrix, &rhs, tuning.cg_tol, tuning.max_cg_iterations);
                    return Some(work.matrix.scatter(&solution.x));
                }
                Err(FactorError::NotPositive) => {
                    // Rounding can make a nearly singular matrix indefinite: a growing shift makes it positive.
                    let largest = work.matrix.largest_diagonal();
                    if !largest.is_finite() {
                        return None;
                    }
                    let more = if shift == 0.0 {
                        tuning.initial_shift * largest
                    } else {
                        (tuning.shift_growth - 1.0) * shift
                    };
                    shift += more;
                    work.is_shifted = true;
                    (0..x.len()).for_each(|p| work.matrix.add_diagonal(p, more));
                }
            }
        }
        None
    }

    /// Scales the direction `d` down where a point deviates too far from the mean, as a trust region would, and reports
    /// the largest displacement it asks for. `None` if it is not finite.
    pub(super) fn clamp_direction(
        &self,
        g: &[Vec3],
        d: &mut [Vec3],
        report: &mut NewtonReport,
    ) -> Option<Direction> {
        report.max_displacement = d.iter().map(|d| d.norm()).fold(0.0, f64::max);
        if !report.max_displacement.is_finite() {
            return None;
        }
        let max_deviation = max_deviation(d, self.fixed);
        if max_deviation > TUNING.max_point_deviation {
            d.iter_mut().for_each(|d| *d *= TUNING.max_point_deviation / max_deviation);
        }
        let decrement = -dot(g, d);
        Some(Direction { max_deviation, decrement })
    }
}
