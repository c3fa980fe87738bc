//! What is done to a garment over time.
//!
//! A [`WearScript`] is a list of [`Action`]s, each in a file of its own under `actions/`, read from JSON with every
//! fault located. The bake asks for them one by one ([`WearScript::flatten`]) and drives the cloth accordingly.

mod action_list;
mod action_runner;
mod actions;
mod body_motion;
mod crease_prediction;
mod fold_map;
mod height_field;
mod script;

pub use action_list::Action;
pub(crate) use action_runner::ConstantLoads;
pub use action_runner::{
    ActionContext, ActionRunner, ActionStart, FoldRecord, GarmentFrame, PersistentState,
};
pub use actions::{
    Bend, Crumple, Facing, FieldError, Fold, Fraction2, Hang, HangBy, HangPlace, Hold, JointAxis, Lay,
    LocalAxis, Play, Press, Release, Repeat, Settle, Side, Unfold, WearAction,
};
pub use crease_prediction::{CreaseDistance, FoldLayout};
pub use script::{ACTION_LIMIT, DURATION_LIMIT_S, Flatten, NESTING_LIMIT, WearFormat, WearScript};
