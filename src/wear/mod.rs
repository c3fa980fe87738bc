//! What is done to a garment over time.
//!
//! A [`WearScript`] is a list of [`Action`]s, each in a file of its own under `actions/`, read from JSON with every
//! fault located. The bake asks for them one by one ([`WearScript::flatten`]) and drives the cloth accordingly.

mod action_list;
mod actions;
mod drive;
mod gesture;
mod landing;
mod moving;
mod script;
mod sketch;
mod turning;

pub use action_list::Action;
pub use actions::{
    Axis, Bend, Crumple, Facing, Fold, Fraction2, Hang, HangBy, HangPlace, Hold, Lay, Misfit, OwnAxis, Play,
    Press, Release, Repeat, Settle, Side, Unfold, WearAction,
};
pub use drive::{Ball, Drive, GRAVITY};
pub(crate) use gesture::Still;
pub use gesture::{Frame, Gesture, MadeFold, Posture, Scene, Start};
pub use script::{ACTION_LIMIT, DURATION_LIMIT_S, Flatten, NESTING_LIMIT, WearFormat, WearScript};
pub use sketch::{Near, Sketch};
