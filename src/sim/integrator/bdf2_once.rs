//! BDF2 with one Newton iteration: what KOW's solver does in a step.
//!
//! The linear model errs by the square of the move it predicts, so that second order is kept where steps are short
//! against the curvature of the forces; otherwise as `be1`.

use crate::sim::integrator::{MethodSpec, InnerSolver, bdf2};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "bdf2-1",
    description: "BDF2, one Newton iteration: KOW's own; for smooth motion in short steps",
    solver: InnerSolver::SingleNewton,
    ..bdf2::SPEC
};
