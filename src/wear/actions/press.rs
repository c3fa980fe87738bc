//! `press`: weight or an iron, straight down.

use super::WearAction;
use crate::error::Result;
use crate::wear::Drive;
use crate::wear::gesture::{Posture, Scene, Start, Still};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Press straight down on the whole garment as it lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Press {
    /// Pressure on the upper side [Pa]: about 200 under a pile of shirts, 2,000 under a hand, 4,000 under a pushed iron.
    #[serde(rename = "pressure")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub pressure_pa: f64,
    /// For how long [s].
    #[serde(rename = "for")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

impl WearAction for Press {
    fn duration_s(&self) -> f64 {
        self.for_s
    }

    fn begin(&self, scene: &Scene, posture: &mut Posture) -> Result<Start> {
        if posture.ground.is_none() {
            return Err(scene.refuse("`press` needs a garment on the ground", "lay it first: {\"lay\": {}}"));
        }
        let drive = Drive { pressure: self.pressure_pa, ..posture.resting() };
        Start::here(Still { drive, may_end_early: false })
    }

    fn example() -> Self {
        Self { pressure_pa: 200.0, for_s: 30.0 }
    }
}
