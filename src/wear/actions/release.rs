//! `release`: everything that is held is released at once.

use crate::wear::action_runner::{ActionContext, ActionStart, ConstantLoads};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::persistent_state::PersistentState;
use crate::wear::wear_action::WearAction;
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Release at once everything that is held, hung, pressed or squeezed. Takes no time: a `settle` usually follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Release {}

impl WearAction for Release {
    fn duration(&self) -> f64 {
        0.0
    }

    /// Marks nothing: it creases only what is folded already.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.require_flat();
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        persistent.held_loads = None;
        if persistent.ground.is_none() && persistent.body.is_none() {
            // A garment that was held in the air falls on a floor just below it.
            let lowest = context.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
            persistent.ground = Some(lowest - 2.0 * context.thickness);
            persistent.frame = None;
        }
        ActionStart::here(ConstantLoads { loads: persistent.idle_loads(), may_end_early: false })
    }

    fn example() -> Self {
        Self {}
    }
}
