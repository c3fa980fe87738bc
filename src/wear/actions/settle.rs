//! `settle`: hands off; gravity, friction and memory do the rest.

use crate::error::Result;
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads, PersistentState};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::FoldLayout;
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
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// Creases nothing that is not folded yet.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.rest();
    }

    fn start_action(&self, _scene: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let drive = Loads { drag: 3.0, ..persistent.idle_loads() };
        ActionStart::here(ConstantLoads { loads: drive, may_end_early: true })
    }

    fn example() -> Self {
        Self { for_s: 2.0 }
    }
}
