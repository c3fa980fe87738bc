//! BDF2 with one Newton iteration, as in Kim, Oh and Wohn.
//!
//! The error of the linear model is of second order in the displacement of a step; the method is of second order where
//! steps are short compared with the curvature of the forces. Otherwise as `be1`.

use crate::sim::integrator::bdf2;
use crate::sim::integrator::spec::{InnerSolver, MethodSpec};

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "bdf2-1",
    description: "BDF2, one Newton iteration: as in Kim, Oh and Wohn; for smooth motion in short steps",
    solver: InnerSolver::SingleNewton,
    ..bdf2::SPEC
};
