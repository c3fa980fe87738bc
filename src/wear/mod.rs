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
pub(crate) use action_runner::Still;
pub use action_runner::{Frame, Gesture, MadeFold, Posture, Scene, Start};
pub use actions::{
    Axis, Bend, Crumple, Facing, Fold, Fraction2, Hang, HangBy, HangPlace, Hold, Lay, Misfit, OwnAxis, Play,
    Press, Release, Repeat, Settle, Side, Unfold, WearAction,
};
pub use crease_prediction::{Near, Sketch};
pub use script::{ACTION_LIMIT, DURATION_LIMIT_S, Flatten, NESTING_LIMIT, WearFormat, WearScript};
