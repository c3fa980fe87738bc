//! Backward Euler: x1 = x0 + h v1, M (v1 - v0) = h F(x1), Newton until it has converged.
//!
//! First order; takes amplitude z/2 of every radian from a motion with z = omega h, and so calms whatever shakes.

use crate::sim::integrator::{MethodSpec, InnerSolver, Stage};
use crate::sim::State;

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "backward-euler",
    description: "backward Euler, converged: first order, calms; for holds, presses and whatever shall come to rest",
    order: 1,
    stage_times: &[1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, _| stage(state, h),
    error: |step| error(step.state, step.next, step.h),
};

pub(super) fn stage(state: &State, h: f64) -> Stage {
    Stage { base_positions: state.x.clone(), base_velocities: state.v.clone(), effective_dt: h, current_weight: 1.0, previous_positions: None }
}

/// h/2 (v1 - v0), root mean square over the points [m].
pub(super) fn error(state: &State, next: &State, h: f64) -> f64 {
    let sum: f64 = next.v.iter().zip(&state.v).map(|(a, b)| (a - b).norm_squared() * 0.25 * h * h).sum();
    (sum / state.x.len().max(1) as f64).sqrt()
}
