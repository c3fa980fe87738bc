//! Backward Euler with one Newton iteration: the semi-implicit step of Baraff and Witkin 1998, used by the reference
//! [9] of Kim, Oh and Wohn.
//!
//! The error of the linear model stays in the result as strain: a strip that rotates by v h in a step is stretched by
//! sqrt(1 + (v h / l)²). In addition to the original, the step is limited by the collision-free step size and the line
//! search common to all methods; without the latter, layers in a fold move so far that the contact search takes twenty
//! times as long as everything else.

use crate::sim::integrator::backward_euler;
use crate::sim::integrator::spec::{InnerSolver, MethodSpec};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "be1",
    description: "backward Euler, one Newton iteration: cheap steps; fast rotation stretches the cloth, so for short steps only",
    solver: InnerSolver::SingleNewton,
    ..backward_euler::SPEC
};
