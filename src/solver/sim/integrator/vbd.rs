//! Vertex block descent (Chen and others 2024) on backward Euler: a fixed number of sweeps over single points with
//! their 3 x 3 diagonal blocks instead of linear systems.
//!
//! For previews: a sweep moves information to neighbouring points only, so that stiff or long cloth stays stretched at
//! any step size, and the result depends on the number of sweeps (`crease chart accuracy`, `stability`).

use crate::sim::integrator::backward_euler;
use crate::sim::integrator::spec::{InnerSolver, MethodSpec};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "vbd",
    description: "vertex block descent, VISUAL: looks like cloth, does not converge; for previews of small or soft garments",
    solver: InnerSolver::Vbd,
    ..backward_euler::SPEC
};
