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

    /// The error of an angle `degrees` that is a simple fraction of pi, as a turn in radians is; `None` for any other.
    pub fn of_radians(degrees: f64) -> Option<Self> {
        let meant = degrees.to_degrees();
        let whole = [30.0, 45.0].map(|step| step * (meant / step).round());
        let is_turn = |turn: &f64| *turn != 0.0 && turn.abs() <= 360.0;
        let turn = whole
            .into_iter()
            .filter(is_turn)
            .find(|turn| (turn.to_radians() - degrees).abs() <= RADIANS_TOL && degrees.fract() != 0.0)?;
        let message = format!("angles are in degrees, and {degrees} is {turn} degrees in radians");
        Some(Self::new("angle", message, format!("write {turn}")))
    }
}

/// Rounding of an angle in radians to two decimals \[rad\], by which a number of degrees is taken for one.
const RADIANS_TOL: f64 = 0.002;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_in_radians_are_told_from_small_angles_in_degrees() {
        for (degrees, turn) in
            [(180.0f64, "180"), (90.0, "90"), (-135.0, "-135"), (30.0, "30"), (360.0, "360")]
        {
            // As somebody writes them, with three decimals.
            let radians = (1e3 * degrees.to_radians()).round() / 1e3;
            let error = FieldError::of_radians(radians).expect("is a turn");
            assert!(error.message.contains(&format!("is {turn} degrees")), "{}", error.message);
        }
        for degrees in [180.0, 3.0, 1.0, 1.5, 0.25, 2.5, 90.0, 57.3, 0.0, 1e-9, f64::NAN] {
            assert!(FieldError::of_radians(degrees).is_none(), "{degrees}");
        }
    }
}
