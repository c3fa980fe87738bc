//! Wear: the script of what is done to a garment, and the loads its actions put on the cloth over time.
//!
//! A [`WearScript`] is a list of [`Action`]s, each in a file of its own under `actions/`, read from JSON with every error
//! located (`script/`). The bake asks for them one by one ([`WearScript::flatten`]), starts each
//! ([`WearAction::start_action`]) and applies the loads of its [`ActionRunner`]. `layout/` knows where cloth lies and where its
//! folds go, `motion/` how points and bodies move.

mod action_runner;
mod actions;
mod fraction;
mod imperfection;
mod layout;
mod motion;
mod persistent_state;
mod script;
mod tuning;
mod wear_action;

pub use action_runner::{ActionContext, ActionFailure, ActionRunner, ActionStart, LaidOut};
pub use actions::{
    Bend, Crumple, Facing, Fold, FoldSide, Hang, HangBy, HangPoints, Hold, Iron, JointAxis, Lay, LocalAxis,
    Pack, Packing, Play, Press, Release, Roll, Settle, Unfold, Wash,
};
pub use fraction::Fraction2;
pub use layout::draw_lines::{DrawnLines, draw_fold_lines};
pub use layout::flat_layout::{LayoutQuality, MAX_CUT_STRAIN, lying_places};
pub use layout::fold_layout::{FoldLayout, Foresight};
pub use layout::line_layout::is_row;
pub use layout::roll_map::RollRecord;
pub use persistent_state::{FoldRecord, GarmentFrame, PersistentState, TurnRecord};
pub use script::action_list::{Action, Repeat};
pub use script::{Flatten, MAX_ACTIONS, MAX_DURATION_S, MAX_NESTING, WearFormat, WearScript};
pub use wear_action::{FieldError, WearAction};
