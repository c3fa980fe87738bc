//! Two steps of backward Euler inside one (Alexander 1977, SDIRK2): second order, L-stable, and it needs nothing but the
//! state it starts from. With g = 1 - 1/sqrt 2:
//!
//! ```text
//! v1 = v0 + g h a1,   x1 = x0 + g h v1                               at g h
//! v2 = v0 + (1-g) h a1 + g h a2,   x2 = x0 + (1-g) h v1 + g h v2     at h
//! ```
//!
//! Its stability function is that of TR-BDF2, as any L-stable method of second order with two equal implicit parts has
//! it. TR-BDF2 asks for the force at the beginning of the step besides: with damping, lagged friction and guides that
//! have just begun to pull there is no such force, which is why this one stands here.

use crate::sim::integrator::{MethodSpec, InnerSolver, Stage, StepAttempt, backward_euler, mixed};
use crate::sim::State;

/// g.
const SHARE: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "sdirk2",
    description: "two-stage, L-stable, converged: second order from the first step on; for motion that keeps being interrupted",
    order: 2,
    stage_times: &[SHARE, 1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, inner| match inner {
        None => backward_euler::stage(state, SHARE * h),
        Some(x) => second(state, h, x),
    },
    error,
};

fn second(state: &State, h: f64, inner: &[crate::math::Vec3]) -> Stage {
    let span = SHARE * h;
    let ahead = (1.0 - SHARE) / SHARE;
    let drift = |((x1, x0), v0): ((&crate::math::Vec3, _), &crate::math::Vec3)| {
        let v1 = (x1 - x0) / span;
        v0 + (v1 - v0) * ahead
    };
    Stage {
        base_positions: mixed(1.0 - ahead, &state.x, inner),
        base_velocities: inner.iter().zip(&state.x).zip(&state.v).map(drift).collect(),
        effective_dt: span,
        current_weight: 1.0 - ahead,
        previous_positions: Some(inner.to_vec()),
    }
}

/// C h³ x''' with C = 0.0404, the first term in which the stability function is not e^z; x''' from a1 and a2.
fn error(step: &StepAttempt) -> f64 {
    let (Some(inner), span) = (step.stage_positions, SHARE * step.h) else {
        return backward_euler::error(step.state, step.next, step.h);
    };
    let sum: f64 = inner
        .iter()
        .zip(&step.state.x)
        .zip(step.state.v.iter().zip(&step.next.v))
        .map(|((x1, x0), (v0, v2))| {
            let a1 = ((x1 - x0) / span - v0) / span;
            let a2 = (v2 - v0 - a1 * ((1.0 - SHARE) * step.h)) / span;
            (a2 - a1).norm_squared()
        })
        .sum();
    0.0404 * step.h * step.h / (1.0 - SHARE) * (sum / step.state.x.len().max(1) as f64).sqrt()
}
