//! `settle`: folds and presses are released; gravity, friction and memory act alone.

use crate::error::Result;
use crate::sim::Loads;
use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads};
use crate::wear::fold_layout::FoldLayout;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Let go of folds and presses and let the cloth come to rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settle {
    /// Largest duration [s]. Default 3.
    #[serde(rename = "for", default = "default_for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub for_s: f64,
}

fn default_for_s() -> f64 {
    3.0
}

impl WearAction for Settle {
    fn duration(&self) -> f64 {
        self.for_s
    }

    /// Marks nothing: it creases only what is folded already.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.require_flat();
    }

    fn start_action(
        &self,
        _context: &ActionContext,
        persistent: &mut PersistentState,
    ) -> Result<ActionStart> {
        let loads = Loads { drag: TUNING.other.settle_drag, ..persistent.idle_loads() };
        ActionStart::here(ConstantLoads { loads, may_end_early: true })
    }

    fn example() -> Self {
        Self { for_s: 2.0 }
    }
}
