//! Backward Euler: x1 = x0 + h v1, M (v1 - v0) = h F(x1), Newton until convergence.
//!
//! First order; per radian of a motion of angular frequency omega it damps the amplitude by omega h / 2.

use crate::sim::integrator::spec::{InnerSolver, MethodSpec};
use crate::sim::integrator::stage::Stage;
use crate::sim::state::State;

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "backward-euler",
    description: "backward Euler, converged: first order, numerically damped; for holds, presses and everything that comes to rest",
    order: 1,
    stage_times: &[1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, _| stage(state, h),
    error: |step| error(step.state, step.next, step.h),
};

pub(super) fn stage(state: &State, h: f64) -> Stage {
    Stage {
        base_positions: state.x.clone(),
        base_velocities: state.v.clone(),
        effective_dt: h,
        current_weight: 1.0,
        previous_positions: None,
    }
}

/// Returns h/2 (v1 - v0), root mean square over the points [m].
pub(super) fn error(state: &State, next: &State, h: f64) -> f64 {
    let sum: f64 = next.v.iter().zip(&state.v).map(|(a, b)| (a - b).norm_squared() * 0.25 * h * h).sum();
    (sum / state.x.len().max(1) as f64).sqrt()
}
