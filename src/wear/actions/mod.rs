//! What can be done to a garment, one file per action: its fields with units and ranges, how long it takes, and
//! what its fields must have to do with one another. Ranges of single fields stand in the types (as schema) and are
//! checked when a script is read. A new action is one file here and one line in `action_list.rs`.

mod bend;
mod crumple;
mod fold;
mod hang;
mod hold;
mod lay;
mod play;
mod press;
mod release;
mod repeat;
mod settle;
mod unfold;

pub use bend::{Bend, JointAxis, LocalAxis};
pub use crumple::Crumple;
pub use fold::{Fold, Fraction2, Side};
pub use hang::{Hang, HangBy, HangPlace};
pub use hold::Hold;
pub use lay::{Facing, Lay};
pub use play::Play;
pub use press::Press;
pub use release::Release;
pub use repeat::Repeat;
pub use settle::Settle;
pub use unfold::Unfold;

use crate::body::{AnimatedBody, BodyPose};
use crate::error::Result;
use crate::wear::action_runner::{ActionContext, ActionStart, PersistentState};
use crate::wear::crease_prediction::FoldLayout;

/// What every action answers.
pub trait WearAction {
    /// How long it takes [s]; 0 for a clip, whose length only the body knows.
    fn duration(&self) -> f64;

    /// Whether it moves a body, so that a bake without one must refuse it.
    fn needs_body(&self) -> bool {
        false
    }

    /// Starts it on the cloth as it is.
    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart>;

    /// Draws on a flat garment where it creases the cloth. Unless it says otherwise, that may be anywhere.
    fn sketch(&self, sketch: &mut FoldLayout) {
        sketch.anywhere();
    }

    /// What is wrong with it for this body: a joint or a clip that it has not.
    fn validate_body(&self, _wearer: &AnimatedBody) -> Vec<FieldError> {
        Vec::new()
    }

    /// Postures that it takes the body through from `from`, close enough to tell what moves.
    fn body_poses(&self, _wearer: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        Vec::new()
    }

    /// What is wrong between its fields, each alone being in range.
    fn validate(&self) -> Vec<FieldError> {
        Vec::new()
    }

    /// One that is valid and has no default values, for tests and documentation.
    fn example() -> Self
    where
        Self: Sized;
}

/// A field that does not go with the others of its action.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldError {
    /// The field.
    pub field: &'static str,
    /// What is wrong.
    pub what: String,
    /// What to do about it.
    pub cure: String,
}

impl FieldError {
    /// Of `field`.
    pub fn new(field: &'static str, what: impl Into<String>, cure: impl Into<String>) -> Self {
        Self { field, what: what.into(), cure: cure.into() }
    }
}
