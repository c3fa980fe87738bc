//! Vertex block descent (Chen and others 2024), as games use it: backward Euler, and instead of linear systems a fixed
//! number of sweeps that move one point after another to where its own 3 x 3 block wants it.
//!
//! Visual: what a sweep moves reaches neighbours only, so that stiff or long cloth stays stretched however short the
//! step, and how much depends on the number of sweeps and not on the cloth (`crease chart accuracy`, `stability`).

use crate::sim::integrator::{MethodSpec, InnerSolver, backward_euler};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "vbd",
    description: "vertex block descent, VISUAL: looks like cloth, is not solved; for previews of small or soft garments",
    solver: InnerSolver::Vbd,
    ..backward_euler::SPEC
};
