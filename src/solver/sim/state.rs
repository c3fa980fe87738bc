//! Positions and motion of the cloth.

use crease_geometry::math::Vec3;
use serde::{Deserialize, Serialize};

/// State of the points after an accepted step. Only `sim` changes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time since the start of the script [s].
    pub time: f64,
    /// Positions, one per point [m].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub x: Vec<Vec3>,
    /// Velocities, one per point [m/s].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub v: Vec<Vec3>,
    /// Unwrapped hinge angles, one per hinge [rad].
    pub angle: Vec<f64>,
    /// The previous accepted state; `None` where motion has just been restarted.
    pub previous: Option<PreviousState>,
}

/// The previous accepted state, as far as two-step methods need it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviousState {
    /// Length of the step from it to the state [s].
    pub dt: f64,
    /// Positions, one per point [m].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub x: Vec<Vec3>,
    /// Velocities, one per point [m/s].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub v: Vec<Vec3>,
}

impl State {
    /// Returns the state at time 0 of points at rest at `x` [m], with hinge angles `angle` [rad].
    pub fn at_rest(x: Vec<Vec3>, angle: Vec<f64>) -> Self {
        Self { time: 0.0, v: vec![Vec3::zeros(); x.len()], x, angle, previous: None }
    }

    /// Sets all velocities to zero and drops the previous state.
    pub fn stop(&mut self) {
        self.v.fill(Vec3::zeros());
        self.previous = None;
    }
}
