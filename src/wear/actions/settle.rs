//! `settle`: hands off; gravity, friction and memory do the rest.

use crate::error::Result;
use crate::sim::Drive;
use crate::wear::action_runner::{Posture, Scene, Start, Still};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::Sketch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Let go of folds and presses and let the cloth come to rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settle {
    /// For how long at most [s]. Default 3.
    #[serde(rename = "for", default = "for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub for_s: f64,
}

fn for_s() -> f64 {
    3.0
}

impl WearAction for Settle {
    fn duration_s(&self) -> f64 {
        self.for_s
    }

    /// Creases nothing that is not folded yet.
    fn sketch(&self, sketch: &mut Sketch) {
        sketch.rest();
    }

    fn begin(&self, _scene: &Scene, posture: &mut Posture) -> Result<Start> {
        let drive = Drive { drag: 3.0, ..posture.resting() };
        Start::here(Still { drive, may_end_early: true })
    }

    fn example() -> Self {
        Self { for_s: 2.0 }
    }
}
