//! The memory: what the cloth takes for its own shape. Energies read it; only `memory::commit` writes it.

use serde::{Deserialize, Serialize};

/// Rest angles, stiffness ratios, rest lengths and running timers of one garment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RestShape {
    /// One per hinge: angle of the source shape [rad].
    pub source_angle: Vec<f64>,
    /// One per hinge: rest angle [rad].
    pub rest_angle: Vec<f64>,
    /// One per hinge: stiffness ratio [-], 1 when new.
    pub stiffness_ratio: Vec<f64>,
    /// One per triangle: rest stretch along warp [-], 1 when new.
    pub rest_stretch_warp: Vec<f64>,
    /// One per triangle: rest stretch along weft [-], 1 when new.
    pub rest_stretch_weft: Vec<f64>,
}
