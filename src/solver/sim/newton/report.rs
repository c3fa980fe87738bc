//! Figures of Newton's method.

use crease_linear::SolveCost;
use std::ops::AddAssign;

/// Wall-clock time of a solve by stage [s].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NewtonSeconds {
    /// Values, gradients and Hessians of all energies.
    pub assembly: f64,
    /// Factorisations and triangular solves.
    pub linear_solve: f64,
    /// Search for contacts and collision-free step sizes.
    pub contact: f64,
}

impl AddAssign for NewtonSeconds {
    fn add_assign(&mut self, other: Self) {
        self.assembly += other.assembly;
        self.linear_solve += other.linear_solve;
        self.contact += other.contact;
    }
}

/// Figures of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NewtonReport {
    /// Number of iterations over all free points.
    pub global_iterations: usize,
    /// Number of iterations over a subset of the points.
    pub local_iterations: usize,
    /// Whether a tolerance was met.
    pub converged: bool,
    /// Largest displacement of a point that the last iteration asked for [m].
    pub max_displacement: f64,
    /// Newton decrement of the last iteration: the predicted decrease of the energy [J].
    pub newton_decrement: f64,
    /// Tolerance of the Newton decrement where the predicted decrease is diffuse [J]; 0 for none, or before a global iteration.
    pub diffuse_tol: f64,
    /// Largest gradient entry over the free points at the last linearisation [N].
    pub residual: f64,
    /// Wall-clock time by stage.
    pub seconds: NewtonSeconds,
    /// Work of the linear solves.
    pub cost: SolveCost,
}

impl NewtonReport {
    /// Adds the work of a later solve, and takes over its outcome.
    pub fn add(&mut self, later: &Self) {
        let global_iterations = self.global_iterations + later.global_iterations;
        let local_iterations = self.local_iterations + later.local_iterations;
        let (mut seconds, mut cost) = (self.seconds, self.cost);
        seconds += later.seconds;
        cost += later.cost;
        *self = Self { global_iterations, local_iterations, seconds, cost, ..*later };
    }
}
