//! `release`: whatever is held is let go at once.

use crate::error::Result;
use crate::wear::action_runner::{Posture, Scene, Start, Still};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::Sketch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Let go at once of everything that is held, hung, pressed or squeezed. Takes no time: a `settle` usually follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Release {}

impl WearAction for Release {
    fn duration_s(&self) -> f64 {
        0.0
    }

    /// Creases nothing that is not folded yet.
    fn sketch(&self, sketch: &mut Sketch) {
        sketch.rest();
    }

    fn begin(&self, scene: &Scene, posture: &mut Posture) -> Result<Start> {
        posture.kept = None;
        if posture.ground.is_none() && posture.body.is_none() {
            // What was held in the air falls on a floor just below it.
            let lowest = scene.x.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
            posture.ground = Some(lowest - 2.0 * scene.thickness);
            posture.frame = None;
        }
        Start::here(Still { drive: posture.resting(), may_end_early: false })
    }

    fn example() -> Self {
        Self {}
    }
}
