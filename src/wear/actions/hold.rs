//! `hold`: everything that is held stays held.

use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::persistent_state::PersistentState;
use crate::wear::wear_action::WearAction;
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Keep everything as it is held now.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// Duration [s].
    #[serde(rename = "for")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

impl WearAction for Hold {
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
        ActionStart::here(ConstantLoads { loads: persistent.folded_loads(), may_end_early: false })
    }

    fn example() -> Self {
        Self { for_s: 12.5 }
    }
}
