//! BDF2 with variable steps: with r = h2 / h1 and y' = f,
//!
//! ```text
//! y2 = [ (1 + r)² y1 - r² y0 + (1 + r) h2 f2 ] / (1 + 2 r)
//! ```
//!
//! The integrator of Kim, Oh and Wohn. Second order; the first step, and the first after a discontinuity or a growth of
//! the step beyond [`MAX_DT_GROWTH`], is backward Euler, which does not lower the order.

use crate::sim::integrator::backward_euler;
use crate::sim::integrator::spec::{InnerSolver, MAX_DT_GROWTH, MethodSpec, StepAttempt};
use crate::sim::integrator::stage::{Stage, weighted_sum};
use crate::sim::state::{PreviousState, State};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "bdf2",
    description: "BDF2, converged: second order; for swings and falls with little contact, where the motion itself matters",
    order: 2,
    stage_times: &[1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, _| match usable_previous(state, h) {
        Some(previous) => stage(state, previous, h),
        None => backward_euler::stage(state, h),
    },
    error,
};

/// Returns the previous state, unless motion restarts here or the step grows beyond the stability limit.
fn usable_previous(state: &State, h: f64) -> Option<&PreviousState> {
    state.previous.as_ref().filter(|previous| h <= MAX_DT_GROWTH * previous.dt * (1.0 + 1e-9))
}

fn stage(state: &State, previous: &PreviousState, h: f64) -> Stage {
    let r = h / previous.dt;
    // The other weight is -r² / (1 + 2 r): together they are 1.
    let current_weight = (1.0 + r).powi(2) / (1.0 + 2.0 * r);
    Stage {
        base_positions: weighted_sum(current_weight, &state.x, &previous.x),
        base_velocities: weighted_sum(current_weight, &state.v, &previous.v),
        effective_dt: (1.0 + r) / (1.0 + 2.0 * r) * h,
        current_weight,
        previous_positions: Some(previous.x.clone()),
    }
}

/// Returns the distance from the quadratic extrapolation of x_n, v_n and x_{n-1}, whose error is about three times that
/// of the method.
fn error(step: &StepAttempt) -> f64 {
    let Some(previous) = &step.state.previous else {
        return backward_euler::error(step.state, step.next, step.h);
    };
    let r = step.h / previous.dt;
    let sum: f64 = step
        .next
        .x
        .iter()
        .zip(&step.state.x)
        .zip(&step.state.v)
        .zip(&previous.x)
        .map(|(((new, x), v), old)| {
            let curvature = (old - x + v * previous.dt) * (r * r);
            (new - x - v * step.h - curvature).norm_squared() / 9.0
        })
        .sum();
    (sum / step.state.x.len().max(1) as f64).sqrt()
}
