//! The memory of the cloth: its rest angles, rest stretches and stiffness. Energies read it; only `memory` writes it.

use serde::{Deserialize, Serialize};

/// Rest angles, stiffness ratios and rest stretches of one garment.
///
/// ```
/// // One hinge with the angle 0.3 rad as modelled, between two triangles.
/// let rest = crease::RestState::new(vec![0.3], 2);
/// assert_eq!((rest.rest_angle[0], rest.stiffness_ratio[0], rest.rest_stretch_warp[1]), (0.3, 1.0, 1.0));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RestState {
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

impl RestState {
    /// Creates the rest state of new, flat cloth.
    pub fn flat(hinge_count: usize, triangle_count: usize) -> Self {
        Self::new(vec![0.0; hinge_count], triangle_count)
    }

    /// Creates the rest state of new cloth whose source shape has the hinge angles `source_angle` [rad], one per hinge.
    pub fn new(source_angle: Vec<f64>, triangle_count: usize) -> Self {
        Self {
            rest_angle: source_angle.clone(),
            stiffness_ratio: vec![1.0; source_angle.len()],
            rest_stretch_warp: vec![1.0; triangle_count],
            rest_stretch_weft: vec![1.0; triangle_count],
            source_angle,
        }
    }
}
