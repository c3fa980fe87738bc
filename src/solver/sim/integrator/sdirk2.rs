//! SDIRK2 (Alexander 1977), two stages of backward Euler in one step: second order, L-stable, and without history
//! before the state it starts from. With g = 1 - 1/sqrt 2:
//!
//! ```text
//! v1 = v0 + g h a1,   x1 = x0 + g h v1                               at g h
//! v2 = v0 + (1-g) h a1 + g h a2,   x2 = x0 + (1-g) h v1 + g h v2     at h
//! ```
//!
//! Its stability function is that of TR-BDF2, as of any L-stable method of second order with two equal implicit stages.
//! TR-BDF2 needs the force at the beginning of the step in addition, which does not exist with damping, lagged friction
//! and springs that have just been attached.

use crate::sim::integrator::backward_euler;
use crate::sim::integrator::spec::{InnerSolver, MethodSpec, StepAttempt};
use crate::sim::integrator::stage::{Stage, weighted_sum};
use crate::sim::state::State;
use crease_geometry::math::Vec3;

/// The coefficient g.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "sdirk2",
    description: "two-stage, L-stable, converged: second order from the first step on; for motion that is often interrupted",
    order: 2,
    stage_times: &[GAMMA, 1.0],
    solver: InnerSolver::Newton,
    stage: |state, h, stage_positions| match stage_positions {
        None => backward_euler::stage(state, GAMMA * h),
        Some(x) => second_stage(state, h, x),
    },
    error,
};

fn second_stage(state: &State, h: f64, stage_positions: &[Vec3]) -> Stage {
    let effective_dt = GAMMA * h;
    let ratio = (1.0 - GAMMA) / GAMMA;
    let base_velocity = |((x1, x0), v0): ((&Vec3, _), &Vec3)| {
        let v1 = (x1 - x0) / effective_dt;
        v0 + (v1 - v0) * ratio
    };
    Stage {
        base_positions: weighted_sum(1.0 - ratio, &state.x, stage_positions),
        base_velocities: stage_positions.iter().zip(&state.x).zip(&state.v).map(base_velocity).collect(),
        effective_dt,
        current_weight: 1.0 - ratio,
        previous_positions: Some(stage_positions.to_vec()),
    }
}

/// Returns C h³ x''' with C = 0.0404, the first term in which the stability function is not e^z; x''' from a1 and a2.
fn error(step: &StepAttempt) -> f64 {
    let (Some(stage_positions), effective_dt) = (step.stage_positions, GAMMA * step.h) else {
        return backward_euler::error(step.state, step.next, step.h);
    };
    let sum: f64 = stage_positions
        .iter()
        .zip(&step.state.x)
        .zip(step.state.v.iter().zip(&step.next.v))
        .map(|((x1, x0), (v0, v2))| {
            let a1 = ((x1 - x0) / effective_dt - v0) / effective_dt;
            let a2 = (v2 - v0 - a1 * ((1.0 - GAMMA) * step.h)) / effective_dt;
            (a2 - a1).norm_squared()
        })
        .sum();
    0.0404 * step.h * step.h / (1.0 - GAMMA) * (sum / step.state.x.len().max(1) as f64).sqrt()
}
