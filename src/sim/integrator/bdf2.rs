//! BDF2 with variable steps: with r = h2 / h1 and y' = f,
//!
//! ```text
//! y2 = [ (1 + r)² y1 - r² y0 + (1 + r) h2 f2 ] / (1 + 2 r)
//! ```
//!
//! KOW's integrator. Second order; starts, and restarts after a jump or a step that would grow too much, with backward
//! Euler, which costs no order.

use crate::sim::integrator::{MAX_DT_GROWTH, MethodSpec, InnerSolver, Stage, StepAttempt, backward_euler, mixed};
use crate::sim::{PreviousState, State};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "bdf2",
    description: "BDF2, converged: second order; for swings and falls without much contact, where the motion itself counts",
    order: 2,
    stage_times: &[1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, _| match usable(state, h) {
        Some(previous) => stage(state, previous, h),
        None => backward_euler::stage(state, h),
    },
    error,
};

/// The state before, unless motion restarts here or the step grows beyond where BDF2 is stable.
fn usable(state: &State, h: f64) -> Option<&PreviousState> {
    state.previous.as_ref().filter(|previous| h <= MAX_DT_GROWTH * previous.step * (1.0 + 1e-9))
}

fn stage(state: &State, previous: &PreviousState, h: f64) -> Stage {
    let r = h / previous.step;
    // The other weight is -r² / (1 + 2 r): together they are 1.
    let now = (1.0 + r).powi(2) / (1.0 + 2.0 * r);
    Stage {
        base_positions: mixed(now, &state.x, &previous.x),
        base_velocities: mixed(now, &state.v, &previous.v),
        effective_dt: (1.0 + r) / (1.0 + 2.0 * r) * h,
        current_weight: now,
        previous_positions: Some(previous.x.clone()),
    }
}

/// Against quadratic extrapolation from x_n, v_n and x_{n-1}, whose error is about three times the method's own.
fn error(step: &StepAttempt) -> f64 {
    let Some(previous) = &step.state.previous else {
        return backward_euler::error(step.state, step.next, step.h);
    };
    let r = step.h / previous.step;
    let sum: f64 = step
        .next
        .x
        .iter()
        .zip(&step.state.x)
        .zip(&step.state.v)
        .zip(&previous.x)
        .map(|(((new, x), v), old)| {
            let bend = (old - x + v * previous.step) * (r * r);
            (new - x - v * step.h - bend).norm_squared() / 9.0
        })
        .sum();
    (sum / step.state.x.len().max(1) as f64).sqrt()
}
