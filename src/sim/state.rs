//! Where the cloth is and how it moves.

use crate::math::Vec3;
use serde::{Deserialize, Serialize};

/// State of the points after an accepted step. Only `solve` changes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time since the start of the script [s].
    pub time: f64,
    /// Positions, one per point [m].
    #[serde(with = "crate::math::serde_vec::vectors")]
    pub x: Vec<Vec3>,
    /// Velocities, one per point [m/s].
    #[serde(with = "crate::math::serde_vec::vectors")]
    pub v: Vec<Vec3>,
    /// Unwrapped hinge angles, one per hinge [rad].
    pub angle: Vec<f64>,
    /// The accepted state before this one, unless motion has just been restarted.
    pub previous: Option<PreviousState>,
}

/// What a two-step method remembers of the step before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviousState {
    /// Length of the step that led from it to the state [s].
    pub step: f64,
    /// Positions, one per point [m].
    #[serde(with = "crate::math::serde_vec::vectors")]
    pub x: Vec<Vec3>,
    /// Velocities, one per point [m/s].
    #[serde(with = "crate::math::serde_vec::vectors")]
    pub v: Vec<Vec3>,
}

impl State {
    /// Points at rest at `x`, hinges at `angle`.
    pub fn at_rest(x: Vec<Vec3>, angle: Vec<f64>) -> Self {
        Self { time: 0.0, v: vec![Vec3::zeros(); x.len()], x, angle, previous: None }
    }

    /// Forgets all motion: the cloth stands still.
    pub fn stop(&mut self) {
        self.v.fill(Vec3::zeros());
        self.previous = None;
    }
}
