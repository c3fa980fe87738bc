//! `hold`: everything that is held stays held.

use crate::error::Result;
use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads, PersistentState};
use crate::wear::actions::WearAction;
use crate::wear::crease_prediction::FoldLayout;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Keep everything as it is held now.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// For how long [s].
    #[serde(rename = "for")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

impl WearAction for Hold {
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// Creases nothing that is not folded yet.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.rest();
    }

    fn start_action(&self, _scene: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        ActionStart::here(ConstantLoads { loads: persistent.idle_loads(), may_end_early: false })
    }

    fn example() -> Self {
        Self { for_s: 12.5 }
    }
}
