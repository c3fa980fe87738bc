//! Backward Euler and BDF2 with one Newton iteration: the semi-implicit step of Baraff and Witkin 1998, used by the
//! reference [9] of Kim, Oh and Wohn, and that of Kim, Oh and Wohn.
//!
//! The error of the linear model stays in the result as strain: a strip that rotates by v h in a step is stretched by
//! sqrt(1 + (v h / l)²). It is of second order in the displacement of a step, so that BDF2 keeps its order where steps
//! are short compared with the curvature of the forces. In addition to the originals, the step is limited by the
//! collision-free step size and the line search common to all methods; without the latter, layers in a fold move so far
//! that the contact search takes twenty times as long as everything else.

use crease_geometry::math::Vec3;
use crease_solver::sim::{InnerSolver, Method, MethodSpec, NewtonOptions, NewtonReport, StageSolve};

/// Backward Euler with one Newton iteration.
pub(super) const BACKWARD_EULER_ONCE: MethodSpec = MethodSpec {
    name: "be1",
    description: "backward Euler, one Newton iteration: cheap steps; fast rotation stretches the cloth, so for short steps only",
    solver: InnerSolver::FixedWork(solve),
    ..*Method::BackwardEuler.spec()
};

/// BDF2 with one Newton iteration.
pub(super) const BDF2_ONCE: MethodSpec = MethodSpec {
    name: "bdf2-1",
    description: "BDF2, one Newton iteration: as in Kim, Oh and Wohn; for smooth motion in short steps",
    solver: InnerSolver::FixedWork(solve),
    ..*Method::Bdf2.spec()
};

/// Makes one Newton iteration.
fn solve(stage: StageSolve, x: &mut [Vec3]) -> NewtonReport {
    let StageSolve { problem, contact, options, min_diffuse_tol, work } = stage;
    let options = NewtonOptions { max_iterations: 1, ..options };
    problem.solve_again(x, contact, &options, min_diffuse_tol, work)
}
