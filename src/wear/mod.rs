//! Wear: the script of what is done to a garment, and the loads its actions put on the cloth over time.
//!
//! A [`WearScript`] is a list of [`Action`]s, each in a file of its own under `actions/`, read from JSON with every error
//! located. The bake asks for them one by one ([`WearScript::flatten`]), starts each ([`WearAction::start_action`]) and
//! applies the loads of its [`ActionRunner`].

mod action_list;
mod action_runner;
mod actions;
mod body_motion;
mod draw_lines;
mod flat_layout;
mod fold_layout;
mod fold_map;
mod fraction;
mod height_field;
mod layer_gap;
mod layer_order;
mod line_layout;
mod motion_profile;
mod persistent_state;
mod preset_list;
mod roll_map;
mod script;
mod sewn_layers;
mod slowed_jumps;
mod springs;
mod tuning;
mod wear_action;

pub use action_list::{Action, Repeat};
pub use action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, LaidOut};
pub use actions::{
    Bend, Crumple, Facing, Fold, FoldSide, Hang, HangBy, HangPoints, Hold, Iron, JointAxis, Lay, LocalAxis,
    Pack, Packing, Play, Press, Release, Roll, Settle, Unfold, Wash,
};
pub use draw_lines::{DrawnLines, draw_fold_lines};
pub use flat_layout::MAX_CUT_STRAIN;
pub use fold_layout::{FoldLayout, Foresight};
pub use fraction::Fraction2;
pub use line_layout::is_row;
pub use persistent_state::{FoldRecord, GarmentFrame, PersistentState, TurnRecord};
pub use roll_map::RollRecord;
pub use script::{Flatten, MAX_ACTIONS, MAX_DURATION_S, MAX_NESTING, WearFormat, WearScript};
pub use wear_action::{FieldError, WearAction};
