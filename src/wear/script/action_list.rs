//! The list of actions, and `repeat`, the action that holds a list of actions.
//!
//! One line per action gives its variant of [`Action`], its name in scripts, its entry in the schema and its place in the
//! tests that walk the list.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::actions::*;
use crate::wear::persistent_state::PersistentState;
use crate::wear::wear_action::WearAction;
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! action_list {
    ($($(#[$doc:meta])* $name:literal $variant:ident,)*) => {
        /// One action; in scripts `{"fold": {...}}`.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Action {
            $($(#[$doc])* #[serde(rename = $name)] $variant($variant),)*
        }

        impl Action {
            /// Names in scripts, in the order of the list.
            pub const NAMES: &'static [&'static str] = &[$($name,)*];

            /// Name in scripts.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name,)* }
            }

            /// The action as the trait that all actions implement.
            pub fn as_wear_action(&self) -> &dyn WearAction {
                match self { $(Self::$variant(action) => action,)* }
            }

            /// One valid example of each, in the order of the list.
            pub fn examples() -> Vec<Self> {
                vec![$(Self::$variant($variant::example()),)*]
            }
        }
    };
}

action_list! {
    /// Lay it flat.
    "lay" Lay,
    /// Turn one side of a line over.
    "fold" Fold,
    /// Roll it up from one side.
    "roll" Roll,
    /// Open folds and rolls again.
    "unfold" Unfold,
    /// Press straight down.
    "press" Press,
    /// Keep everything as it is held.
    "hold" Hold,
    /// Let it come to rest.
    "settle" Settle,
    /// Hang it up.
    "hang" Hang,
    /// Squeeze it into a ball.
    "crumple" Crumple,
    /// Flatten it hot.
    "iron" Iron,
    /// Fold it to a size, under a weight.
    "pack" Pack,
    /// Tumble and spin it wet, and dry it.
    "wash" Wash,
    /// Let go of everything.
    "release" Release,
    /// Bend a joint of the body.
    "bend" Bend,
    /// Play a clip of the body.
    "play" Play,
    /// Do a list of actions several times.
    "repeat" Repeat,
}

impl Action {
    /// The actions that it consists of, in order; none for an action that is performed itself.
    pub fn parts(&self) -> Vec<Self> {
        match self {
            Self::Pack(pack) => pack.parts(),
            Self::Wash(wash) => wash.parts(),
            _ => Vec::new(),
        }
    }
}

/// Do a list of actions several times over. Repeats may lie in repeats, up to 8 deep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// Number of repetitions.
    #[schemars(range(min = 1, max = 10000))]
    pub times: u32,
    /// The actions, in order.
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

    fn start_action(
        &self,
        context: &ActionContext,
        _persistent: &mut PersistentState,
    ) -> Result<ActionStart> {
        Err(context.refuse_whole("repeat"))
    }

    fn example() -> Self {
        Self { times: 3, actions: vec![Action::Hold(Hold::example()), Action::Release(Release {})] }
    }
}
