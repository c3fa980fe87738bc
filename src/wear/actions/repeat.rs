//! `repeat`: a list of actions, several times over.

use crate::error::Result;
use crate::wear::Action;
use crate::wear::action_runner::{ActionContext, ActionStart, PersistentState};
use crate::wear::actions::WearAction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Do a list of actions several times over. Repeats may lie in repeats, up to 8 deep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How often.
    #[schemars(range(min = 1, max = 10000))]
    pub times: u32,
    /// What, in order.
    #[schemars(length(min = 1))]
    pub actions: Vec<Action>,
}

impl WearAction for Repeat {
    fn duration(&self) -> f64 {
        f64::from(self.times)
            * self.actions.iter().map(|action| action.as_wear_action().duration()).sum::<f64>()
    }

    fn needs_body(&self) -> bool {
        self.actions.iter().any(|action| action.as_wear_action().needs_body())
    }

    fn start_action(&self, context: &ActionContext, _posture: &mut PersistentState) -> Result<ActionStart> {
        Err(context
            .refuse("`repeat` is a list of actions, not one", "write it out with `WearScript::flatten`"))
    }

    fn example() -> Self {
        Self {
            times: 3,
            actions: vec![
                Action::Hold(crate::wear::actions::Hold::example()),
                Action::Release(crate::wear::actions::Release {}),
            ],
        }
    }
}
