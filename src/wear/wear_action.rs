//! The trait that all actions implement, and the errors of their fields.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::layout::fold_layout::FoldLayout;
use crate::wear::persistent_state::PersistentState;
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::error::{Message, Result};

/// An action of a script.
pub trait WearAction {
    /// Duration [s]; 0 for a clip, whose length only the body determines.
    fn duration(&self) -> f64;

    /// Whether it moves a body, so that a bake without one must refuse it.
    fn needs_body(&self) -> bool {
        false
    }

    /// Starts it on the cloth as it is.
    ///
    /// # Errors
    /// A diagnostic of the script where the action is not possible.
    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart>;

    /// Applies it to a flat layout to predict where it creases the cloth; by default that may be anywhere.
    fn predict_creases(&self, layout: &mut FoldLayout) {
        layout.mark_unpredictable();
    }

    /// Errors of its fields with regard to `body`: a joint or a clip that does not exist.
    fn validate_body(&self, _body: &AnimatedBody) -> Vec<FieldError> {
        Vec::new()
    }

    /// What it does with `body` that the user should know.
    fn body_notes(&self, _body: &AnimatedBody) -> Vec<String> {
        Vec::new()
    }

    /// Poses that it takes `body` through from the pose `from`, dense enough to tell what moves.
    fn body_poses(&self, _body: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        Vec::new()
    }

    /// Errors between its fields, each being in range by itself.
    fn validate(&self) -> Vec<FieldError> {
        Vec::new()
    }

    /// A valid example without default values, for tests and documentation.
    fn example() -> Self
    where
        Self: Sized;
}

/// An error of one field of an action.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldError {
    /// Name of the field in scripts.
    pub field: &'static str,
    /// Description of the problem.
    pub message: String,
    /// Advice on how to fix it.
    pub help: Message,
}

impl FieldError {
    /// An error of `field`.
    pub fn new(field: &'static str, message: impl Into<String>, help: impl Into<Message>) -> Self {
        Self { field, message: message.into(), help: help.into() }
    }
}
