//! `wash`: the garment is tumbled and spun wet, and dries as it hangs: it loses nearly all memory and earns a soft one.
//!
//! It consists of `crumple` and `hang`, both of wet cloth.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::actions::{Crumple, Hang, HangBy, HangPoints};
use crate::wear::persistent_state::PersistentState;
use crate::wear::script::action_list::Action;
use crate::wear::wear_action::WearAction;
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Wash the garment: crumple it wet, spin it, straighten it and let it dry as it hangs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wash {
    /// Diameter of the ball that it is spun to, as a fraction of the garment's largest extent. Default 0.3.
    #[serde(default = "default_to")]
    #[schemars(extend("exclusiveMinimum" = 0), extend("exclusiveMaximum" = 1))]
    pub to: f64,
    /// Duration of the spin [s]. Default 10.
    #[serde(rename = "spin", default = "default_spin_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub spin_s: f64,
    /// Points that it hangs by while it dries, as of `hang`. Default hanger.
    #[serde(default = "default_by")]
    pub by: HangBy,
    /// Duration of drying [s]. Default 10800, three hours.
    #[serde(rename = "dry", default = "default_dry_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub dry_s: f64,
}

fn default_to() -> f64 {
    0.3
}

fn default_spin_s() -> f64 {
    10.0
}

fn default_by() -> HangBy {
    HangBy::Named(HangPoints::Hanger)
}

fn default_dry_s() -> f64 {
    10_800.0
}

/// Duration in which the wet garment is crumpled [s].
const TUMBLE_S: f64 = 3.5;

impl Wash {
    /// The actions that it consists of, in order.
    pub(in crate::wear) fn parts(&self) -> Vec<Action> {
        vec![
            Action::Crumple(Crumple { to: self.to, over_s: TUMBLE_S, hold_s: self.spin_s, wet: true }),
            Action::Hang(Hang { by: self.by.clone(), for_s: self.dry_s, wet: true }),
        ]
    }
}

impl WearAction for Wash {
    fn duration(&self) -> f64 {
        self.parts().iter().map(|part| part.as_wear_action().duration()).sum()
    }

    fn start_action(
        &self,
        context: &ActionContext,
        _persistent: &mut PersistentState,
    ) -> Result<ActionStart> {
        Err(context.refuse_whole("wash"))
    }

    fn example() -> Self {
        Self { to: 0.35, spin_s: 8.0, by: HangBy::Named(HangPoints::Hook), dry_s: 3600.0 }
    }
}
