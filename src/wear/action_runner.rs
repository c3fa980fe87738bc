//! Actions in progress: from the data of a script to loads on the cloth over time.
//!
//! An action of a script is data. When its turn comes it is started on the cloth as it is and becomes an [`ActionRunner`],
//! which gives the loads on the cloth at every time. State that outlives the action is in [`PersistentState`].

use crate::wear::layout::flat_layout::LayoutQuality;
use crate::wear::persistent_state::PersistentState;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Diagnostic, Error, Message, Result};
use crease_solver::memory::Softening;
use crease_solver::sim::Loads;
use serde_json::Value;

/// The cloth at the start of an action, and where the action stands in its script.
pub struct ActionContext<'a> {
    /// Positions, one per point [m].
    pub positions: &'a [Vec3],
    /// Positions in the garment's file, one per point [m].
    pub source_positions: &'a [Vec3],
    /// Triangles of the mesh, corners counter-clockwise from outside.
    pub triangles: &'a [[PointIndex; 3]],
    /// Masses, one per point [kg].
    pub masses: &'a [f64],
    /// Contact distance: the thickness of a layer [m].
    pub thickness: f64,
    /// Name of the script in messages.
    pub script_file: &'a str,
    /// Location of the action in the script, for messages.
    pub location: &'a str,
}

impl ActionContext<'_> {
    /// The error of an action that is not possible here: `message` says why, `help` what to do.
    pub fn refuse(&self, message: impl Into<Message>, help: impl Into<Message>) -> Error {
        Error::input(self.script_file, self.location, message, help)
    }

    /// The error of the action `name` of a garment that is not in the place that it needs.
    pub(super) fn refuse_place(&self, name: &str, needed: NeededPlace) -> Error {
        let (message, help) = needed.fault(name);
        self.refuse(message, help)
    }

    /// The error of an action that consists of others, `name` in scripts, and is not performed itself.
    pub(super) fn refuse_whole(&self, name: &str) -> Error {
        let message = format!("`{name}` is a list of actions, not one");
        self.refuse(message, "write it out with `WearScript::flatten`")
    }
}

/// Place of the garment that an action needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NeededPlace {
    /// On the ground, in any shape.
    OnGround,
    /// On the ground as it was laid.
    Lying,
    /// As it was laid and not rolled up.
    Open,
}

impl NeededPlace {
    /// What the action `name` needs, and how to get it.
    pub fn fault(self, name: &str) -> (String, &'static str) {
        let (place, help) = match self {
            Self::OnGround => ("on the ground", "lay it first: {\"lay\": {}}"),
            Self::Lying => ("that lies", "lay it first: {\"lay\": {}}"),
            Self::Open => (
                "that lies and is not rolled up",
                "lay it first: {\"lay\": {}}, or open the roll: {\"unfold\": {\"last\": 1}}",
            ),
        };
        (format!("`{name}` needs a garment {place}"), help)
    }
}

/// Reason why an action that came to its end did not do what it should.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActionFailure {
    /// What did not take place, with the place.
    pub message: String,
    /// Advice on how to cure it.
    pub help: Message,
}

impl ActionFailure {
    /// The diagnostic of an action at `location` of the script `script_file`.
    pub fn into_diagnostic(self, script_file: &str, location: &str) -> Diagnostic {
        Diagnostic::new(script_file, location, self.message, self.help)
    }
}

/// An action in progress.
pub trait ActionRunner {
    /// Loads at `t` seconds after the start. `x` are the positions at the start of the step that ends at that time [m].
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads;

    /// Times after the start that no step may cross [s], increasing.
    fn event_times(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Whether the cloth accumulates memory meanwhile (`lay` only prepares).
    fn accumulates_memory(&self) -> bool {
        true
    }

    /// The cloth that is soft in a step that ends `t` seconds after the start, if any is.
    fn softening(&self, _t: f64) -> Option<&Softening> {
        None
    }

    /// Why the action, at its end with the points at `x` [m], did not do what it should; `None` if it did.
    fn failure(&self, _x: &[Vec3]) -> Option<ActionFailure> {
        None
    }

    /// What the action, at its end, did beyond what its script asks for; `None` for nothing.
    fn note(&self) -> Option<String> {
        None
    }

    /// Whether the action may end before its time because nothing moves any more.
    fn may_end_early(&self) -> bool {
        false
    }

    /// State acquired since the start, for a checkpoint between two steps; null when there is none. `None`, the safe
    /// answer, means that a run can be resumed at the start of the action only.
    fn save_state(&self) -> Option<Value> {
        None
    }

    /// Restores, just after the start, what [`ActionRunner::save_state`] returned for a cloth of `point_count` points.
    /// Returns whether it fits.
    fn restore_state(&mut self, saved: &Value, _point_count: usize) -> bool {
        saved.is_null()
    }

    /// Updates the persistent state at the end of the action.
    fn finish(&mut self, _persistent: &mut PersistentState, _x: &[Vec3]) {}
}

/// A garment that is laid out flat.
pub struct LaidOut {
    /// Per point: by how much it looked up before, from -1 to 1.
    pub level: Vec<f64>,
    /// How good the layout is.
    pub quality: LayoutQuality,
}

/// Start of an action.
pub struct ActionStart {
    /// The action in progress.
    pub runner: Box<dyn ActionRunner>,
    /// New positions to start from, at rest [m], when the action first moves the garment as a whole, so that no layers cross.
    pub start_positions: Option<Vec<Vec3>>,
    /// How the garment lies there, where it is laid out flat first.
    pub laid_out: Option<LaidOut>,
    /// What is to be said of the start in the report.
    pub note: Option<Message>,
    /// Duration [s], where only the body determines it.
    pub duration: Option<f64>,
}

impl ActionStart {
    /// The start of `runner` from the present positions.
    pub fn here(runner: impl ActionRunner + 'static) -> Result<Self> {
        Ok(Self {
            runner: Box::new(runner),
            start_positions: None,
            laid_out: None,
            note: None,
            duration: None,
        })
    }
}

/// A runner with loads that do not change.
pub(super) struct ConstantLoads {
    /// The loads.
    pub loads: Loads,
    /// See [`ActionRunner::may_end_early`].
    pub may_end_early: bool,
}

impl ActionRunner for ConstantLoads {
    fn loads_at(&mut self, _t: f64, _x: &[Vec3]) -> Loads {
        self.loads.clone()
    }

    fn may_end_early(&self) -> bool {
        self.may_end_early
    }

    fn save_state(&self) -> Option<Value> {
        Some(Value::Null)
    }
}
