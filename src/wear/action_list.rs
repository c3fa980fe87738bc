//! The list of actions. One line per action gives its variant of [`Action`], its name in scripts, its entry in the
//! schema and its place in the tests that walk the list.

use crate::wear::actions::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! action_list {
    ($($(#[$doc:meta])* $name:literal $variant:ident,)*) => {
        /// One thing done to the garment; in scripts `{"fold": {...}}`.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Action {
            $($(#[$doc])* #[serde(rename = $name)] $variant($variant),)*
        }

        impl Action {
            /// Every name, in the order of the list.
            pub const NAMES: &'static [&'static str] = &[$($name,)*];

            /// Its name in scripts.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name,)* }
            }

            /// As what all actions have in common.
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
    /// Open folds again.
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
    /// Let go of everything.
    "release" Release,
    /// Bend a joint of the body.
    "bend" Bend,
    /// Play a clip of the body.
    "play" Play,
    /// Do a list of actions several times.
    "repeat" Repeat,
}
