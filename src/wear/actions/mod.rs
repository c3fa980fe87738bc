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

pub use bend::{Axis, Bend, OwnAxis};
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
use crate::wear::action_runner::{Posture, Scene, Start};
use crate::wear::crease_prediction::Sketch;

/// What every action answers.
pub trait WearAction {
    /// How long it takes [s]; 0 for a clip, whose length only the body knows.
    fn duration_s(&self) -> f64;

    /// Whether it moves a body, so that a bake without one must refuse it.
    fn needs_body(&self) -> bool {
        false
    }

    /// Starts it on the cloth as it is.
    fn begin(&self, scene: &Scene, posture: &mut Posture) -> Result<Start>;

    /// Draws on a flat garment where it creases the cloth. Unless it says otherwise, that may be anywhere.
    fn sketch(&self, sketch: &mut Sketch) {
        sketch.anywhere();
    }

    /// What is wrong with it for this body: a joint or a clip that it has not.
    fn misfits_with(&self, _wearer: &AnimatedBody) -> Vec<Misfit> {
        Vec::new()
    }

    /// Postures that it takes the body through from `from`, close enough to tell what moves.
    fn postures(&self, _wearer: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        Vec::new()
    }

    /// What is wrong between its fields, each alone being in range.
    fn misfits(&self) -> Vec<Misfit> {
        Vec::new()
    }

    /// One that is valid and has no default values, for tests and documentation.
    fn example() -> Self
    where
        Self: Sized;
}

/// A field that does not go with the others of its action.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misfit {
    /// The field.
    pub field: &'static str,
    /// What is wrong.
    pub what: String,
    /// What to do about it.
    pub cure: String,
}

impl Misfit {
    /// Of `field`.
    pub fn new(field: &'static str, what: impl Into<String>, cure: impl Into<String>) -> Self {
        Self { field, what: what.into(), cure: cure.into() }
    }
}
