//! Line search along a direction: the collision-free displacement, and the step size for which phi decreases
//! sufficiently.

use crate::contact::Contact;
use crate::sim::newton::context::SolveContext;
use crate::sim::newton::problem::{Potential, Problem};
use crate::sim::newton::report::NewtonReport;
use crate::sim::newton::tuning::TUNING;
use crease_geometry::math::{Vec3, dot};
use std::ops::Range;
use std::time::Instant;

/// A direction and the gradient at its start.
#[derive(Clone, Copy)]
pub(super) struct Descent<'a> {
    /// Gradient, one per point [N].
    pub gradient: &'a [Vec3],
    /// Displacement of a full step, one per point [m].
    pub direction: &'a [Vec3],
}

/// A displacement and the first-order change of phi along all of it.
#[derive(Clone, Copy)]
pub(super) struct SearchPath<'a> {
    /// Displacement of a full step, one per point [m].
    pub displacement: &'a [Vec3],
    /// Slope of phi at its start [J].
    pub slope: f64,
}

/// A trial position on a search path.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a> {
    /// Step size as a fraction of the full step [-].
    pub step: f64,
    /// Positions, one per point [m].
    pub positions: &'a [Vec3],
    /// phi there.
    pub value: Potential,
}

impl SearchPath<'_> {
    /// Returns the slope of phi along `displacement` [J] for the gradient at its start.
    pub fn slope(gradient: &[Vec3], displacement: &[Vec3]) -> f64 {
        dot(gradient, displacement)
    }
}

impl Problem<'_> {
    /// Moves `x` along a direction as far as contact and the line search allow, and returns the step size [-].
    pub(super) fn line_search(
        &self,
        x: &mut [Vec3],
        descent: Descent,
        value: &mut Potential,
        context: &mut SolveContext,
    ) -> f64 {
        let displacement = collision_free_displacement(x, descent, false, context.contact, context.report);
        self.line_search_along(x, descent, displacement, 1.0, value, context)
    }

    /// As [`Self::line_search`], where the collision-free `displacement` is known and no step size above `first_step` is sufficient.
    pub(super) fn line_search_along(
        &self,
        x: &mut [Vec3],
        descent: Descent,
        mut displacement: Vec<Vec3>,
        mut first_step: f64,
        value: &mut Potential,
        context: &mut SolveContext,
    ) -> f64 {
        let min_step = TUNING.line_search.min_step;
        let mut step = 0.0;
        // Displacements are limited point by point first; where that makes the direction one of ascent, all are limited
        // by one factor, which cannot.
        for uniform in [false, true] {
            if uniform {
                displacement = collision_free_displacement(x, descent, true, context.contact, context.report);
                first_step = 1.0;
            }
            let clock = Instant::now();
            let slope = SearchPath::slope(descent.gradient, &displacement);
            if slope > 0.0 && !uniform {
                continue;
            }
            let path = SearchPath { displacement: &displacement, slope };
            let steps = first_step..if uniform { 0.0 } else { min_step };
            step = self.backtrack(x, path, steps, value, context.contact);
            context.report.seconds.assembly += clock.elapsed().as_secs_f64();
            if step > min_step {
                break;
            }
        }
        step
    }

    /// Moves `x` along `path` by the first step size for which phi decreases sufficiently, of `steps.start`, a half, a quarter of it
    /// and so on, and returns it; 0 if it would be less than `steps.end`.
    fn backtrack(
        &self,
        x: &mut [Vec3],
        path: SearchPath,
        steps: Range<f64>,
        value: &mut Potential,
        contact: &Contact,
    ) -> f64 {
        let mut step = steps.start;
        for _ in 0..TUNING.line_search.max_trials {
            if step < steps.end {
                return 0.0;
            }
            let positions = axpy(x, path.displacement, step);
            let trial = Trial { step, positions: &positions, value: self.value(&positions, contact) };
            if self.is_sufficient_decrease(trial, value, path, contact) {
                x.copy_from_slice(&positions);
                *value = trial.value;
                return step;
            }
            step *= 0.5;
        }
        0.0
    }

    /// Whether phi has decreased sufficiently at `trial`, from `start` along `path` (Armijo condition).
    ///
    /// Close to convergence phi decreases by less than its rounding, so that its values decide nothing. The slope at
    /// the trial position still does: where phi is nearly quadratic, it has decreased if its slope there is less steep
    /// than the negative slope at the start (the approximate Wolfe condition of Hager and Zhang 2005).
    pub(super) fn is_sufficient_decrease(
        &self,
        trial: Trial,
        start: &Potential,
        path: SearchPath,
        contact: &Contact,
    ) -> bool {
        let tuning = &TUNING.line_search;
        let rounding = tuning.rounding * start.magnitude;
        // NaN is never within the rounding band.
        let in_rounding_band = (trial.value.sum - start.sum).abs() <= tuning.rounding_band * start.magnitude;
        let max_slope = -tuning.max_slope_ratio * path.slope;
        trial.value.sum <= start.sum + tuning.armijo * trial.step * path.slope.min(0.0) + rounding
            || (in_rounding_band && self.slope(trial.positions, path.displacement, contact) <= max_slope)
    }
}

/// Returns x + `step` d.
pub(super) fn axpy(x: &[Vec3], d: &[Vec3], step: f64) -> Vec<Vec3> {
    x.iter().zip(d).map(|(x, d)| x + d * step).collect()
}

/// Returns the part of the direction of `descent` from `x` that keeps layers apart: limited by one factor if `uniform`,
/// else point by point or zone by zone. Afterwards contact can be evaluated anywhere along it.
pub(super) fn collision_free_displacement(
    x: &[Vec3],
    descent: Descent,
    uniform: bool,
    contact: &mut Contact,
    report: &mut NewtonReport,
) -> Vec<Vec3> {
    let clock = Instant::now();
    let mut displacement = descent.direction.to_vec();
    if uniform {
        contact.limit_displacement_uniform(x, &mut displacement);
    } else {
        contact.limit_displacement(x, &mut displacement, descent.gradient);
    }
    report.seconds.contact += clock.elapsed().as_secs_f64();
    displacement
}
