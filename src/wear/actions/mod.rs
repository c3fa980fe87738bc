//! The actions of a script, one file per action: its fields with units and ranges, its duration, how its fields depend on
//! one another, and its runner. Ranges of single fields are part of the types (as schema) and are checked when a script is
//! read. A new action is one file here and one line in `script/action_list.rs`, where `repeat` is, too.

mod bend;
mod crumple;
mod fold;
mod hang;
mod hold;
mod iron;
mod lay;
mod pack;
mod play;
mod press;
mod release;
mod roll;
mod settle;
mod unfold;
mod wash;

pub use bend::{Bend, JointAxis, LocalAxis};
pub use crumple::Crumple;
pub use fold::{Fold, FoldSide};
pub use hang::{Hang, HangBy, HangPoints};
pub use hold::Hold;
pub use iron::Iron;
pub use lay::{Facing, Lay};
pub use pack::{Pack, Packing};
pub use play::Play;
pub use press::Press;
pub use release::Release;
pub use roll::Roll;
pub use settle::Settle;
pub use unfold::Unfold;
pub use wash::Wash;
