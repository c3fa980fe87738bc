//! Stopping criteria of Newton's method.

/// Stopping criteria: an iteration that meets any of the tolerances is the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonOptions {
    /// Tolerance of the largest displacement of a point that an iteration asks for [m].
    pub displacement_tol: f64,
    /// Tolerance of the Newton decrement, the predicted decrease of the energy [J]. 0 turns the criterion off.
    pub decrement_tol: f64,
    /// Tolerance of the Newton decrement relative to that of the first iteration [-]: where cloth moves far in a step,
    /// solving much more precisely than the step itself is of no use. 0 turns the criterion off; it needs
    /// `decrement_tol` above 0, and the time stepping uses it only while springs guide the cloth.
    pub rel_decrement_tol: f64,
    /// Maximum number of iterations.
    pub max_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { displacement_tol: 3e-5, decrement_tol: 0.0, rel_decrement_tol: 1e-3, max_iterations: 40 }
    }
}
