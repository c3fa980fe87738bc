//! Backward Euler with one Newton iteration: the semi-implicit step of Baraff and Witkin 1998, which KOW's reference [9]
//! and most of the older cloth solvers make.
//!
//! The step is as long as the linear model says and the layers allow; what the model leaves out (a strip that turns
//! by v h in a step is drawn out by sqrt(1 + (v h / l)²)) stays in the result as strain. The way is cut by
//! the line search that all share, which the original does not have: without it layers in a fold were thrown about so far
//! that the search for contacts took twenty times as long as everything else.

use crate::sim::integrator::{MethodSpec, InnerSolver, backward_euler};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "be1",
    description: "backward Euler, one Newton iteration: cheap steps; what turns fast is drawn out, so for short steps only",
    solver: InnerSolver::SingleNewton,
    ..backward_euler::SPEC
};
