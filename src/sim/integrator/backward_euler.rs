//! Backward Euler: x1 = x0 + h v1, M (v1 - v0) = h F(x1), Newton until it has converged.
//!
//! First order; takes amplitude z/2 of every radian from a motion with z = omega h, and so calms whatever shakes.

use crate::sim::integrator::{Recipe, Solver, Stage};
use crate::sim::State;

pub(super) const RECIPE: Recipe = Recipe {
    name: "backward-euler",
    about: "backward Euler, converged: first order, calms; for holds, presses and whatever shall come to rest",
    order: 1,
    parts: &[1.0],
    solver: Solver::Converged,
    stage: |state, h, _| stage(state, h),
    error: |step| error(step.state, step.next, step.h),
};

pub(super) fn stage(state: &State, h: f64) -> Stage {
    Stage { base: state.x.clone(), drift: state.v.clone(), span: h, now: 1.0, other: None }
}

/// h/2 (v1 - v0), root mean square over the points [m].
pub(super) fn error(state: &State, next: &State, h: f64) -> f64 {
    let sum: f64 = next.v.iter().zip(&state.v).map(|(a, b)| (a - b).norm_squared() * 0.25 * h * h).sum();
    (sum / state.x.len().max(1) as f64).sqrt()
}
