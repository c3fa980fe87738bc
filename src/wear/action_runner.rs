//! From actions to drives: a runner is an action under way.
//!
//! An action of the script is data; when its turn comes it looks at the cloth as it lies (or hangs) and becomes a
//! [`ActionRunner`], which says for every time what acts on the cloth. What must outlive an action (the box that
//! fractions refer to, folds that can be opened again, what holds the cloth up) is the [`PersistentState`].

use crate::body::PosedBody;
use crate::energy::TargetSpring;
use crate::error::{Error, Result};
use crate::math::{Mat3, Vec3, bounds};
use crate::sim::Loads;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a runner may know of the cloth.
pub struct ActionContext<'a> {
    /// Positions, one per point [m].
    pub positions: &'a [Vec3],
    /// Positions in the garment's file, one per point [m].
    pub source_positions: &'a [Vec3],
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
    /// The action cannot be done here: `what` is in the way, `cure` helps.
    pub fn refuse(&self, what: impl Into<String>, cure: impl Into<String>) -> Error {
        Error::input(self.script_file, self.location, what, cure)
    }
}

/// The plane that fractions refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GarmentFrame {
    /// The point (0, 0): lower left [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub origin: Vec3,
    /// From (0, 0) to (1, 0) [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub right: Vec3,
    /// From (0, 0) to (0, 1) [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub upward: Vec3,
}

impl GarmentFrame {
    /// The place of a fraction [m].
    pub fn place(&self, fraction: [f64; 2]) -> Vec3 {
        self.origin + self.right * fraction[0] + self.upward * fraction[1]
    }

    /// The fraction of a place.
    pub fn fraction(&self, place: &Vec3) -> [f64; 2] {
        let arm = place - self.origin;
        [&self.right, &self.upward].map(|axis| arm.dot(axis) / axis.norm_squared().max(f64::MIN_POSITIVE))
    }

    /// Box of points that hang: x to the right, y upward.
    pub fn hanging(x: &[Vec3]) -> Self {
        let (low, high) = bounds(x);
        Self {
            origin: Vec3::new(low.x, low.y, 0.5 * (low.z + high.z)),
            right: Vec3::new(high.x - low.x, 0.0, 0.0),
            upward: Vec3::new(0.0, high.y - low.y, 0.0),
        }
    }

    /// Box of points that lie on the ground: x to the right, -z upward.
    pub fn lying(x: &[Vec3]) -> Self {
        let (low, high) = bounds(x);
        Self {
            origin: Vec3::new(low.x, 0.0, high.z),
            right: Vec3::new(high.x - low.x, 0.0, 0.0),
            upward: Vec3::new(0.0, 0.0, low.z - high.z),
        }
    }
}

/// A fold that has been made and not opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoldRecord {
    /// The points that were turned over.
    pub flap: Vec<u32>,
    /// A point of the fold line on the ground [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Unit vector along the line.
    #[serde(with = "crate::math::serde_vec::vector")]
    pub along: Vec3,
    /// Unit vector from the line to where the flap lay before.
    #[serde(with = "crate::math::serde_vec::vector")]
    pub out: Vec3,
    /// How far it was turned [rad].
    pub angle: f64,
}

/// What outlives an action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PersistentState {
    /// How the garment as a whole is turned against its file: file directions to present ones.
    #[serde(rename = "turned", with = "crate::math::serde_vec::matrix")]
    pub orientation: Mat3,
    /// What fractions refer to, once the cloth lies or hangs.
    pub frame: Option<GarmentFrame>,
    /// Folds not opened yet, oldest first.
    pub folds: Vec<FoldRecord>,
    /// Height of the ground, where there is one [m].
    pub ground: Option<f64>,
    /// What the last action keeps acting until it is released.
    #[serde(rename = "kept")]
    pub held_loads: Option<Loads>,
    /// The body the garment is worn on, and where it stands.
    // A checkpoint has its pose apart: the body itself is the caller's.
    #[serde(skip)]
    pub body: Option<PosedBody>,
}

impl Default for PersistentState {
    fn default() -> Self {
        Self {
            orientation: Mat3::identity(),
            frame: None,
            folds: Vec::new(),
            ground: None,
            held_loads: None,
            body: None,
        }
    }
}

impl PersistentState {
    /// The frame, if the cloth lies on the ground.
    pub fn ground_frame(&self) -> Option<GarmentFrame> {
        self.ground.and(self.frame)
    }

    /// What acts when nothing is done: gravity, the ground, the body and whatever has not been let go.
    pub fn idle_loads(&self) -> Loads {
        let kept = self.held_loads.clone().unwrap_or_else(|| Loads::gravity_only(self.ground));
        Loads { body: self.body.as_ref().map(|body| body.points.clone()), ..kept }
    }
}

/// An action under way.
pub trait ActionRunner {
    /// What acts at `t` seconds after its start; `x` are the positions at the start of the step that ends then.
    fn loads_at(&mut self, t: f64, x: &[Vec3]) -> Loads;

    /// Times after its start that no step may jump over [s], increasing.
    fn event_times(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Moves the points before a step that ends at `t` seconds, by a map that keeps layers in order (`lay` squeezes).
    /// Returns whether it did.
    fn apply_map(&mut self, _t: f64, _x: &mut [Vec3]) -> bool {
        false
    }

    /// Whether the cloth earns memory meanwhile (`lay` only prepares).
    fn accumulates_memory(&self) -> bool {
        true
    }

    /// Whether it may end before its time because nothing moves any more.
    fn may_end_early(&self) -> bool {
        false
    }

    /// What it has learnt since it began, for a checkpoint between its steps: null when nothing changes. `None` (the
    /// safe answer) means that a run can be taken up at its beginning only.
    fn save_state(&self) -> Option<Value> {
        None
    }

    /// Takes up, just after its beginning, what [`ActionRunner::memo`] said of a cloth of `point_count` points. Returns
    /// whether that made sense.
    fn restore_state(&mut self, memo: &Value, _point_count: usize) -> bool {
        memo.is_null()
    }

    /// What it leaves behind when it is over.
    fn finish(&mut self, _posture: &mut PersistentState, _x: &[Vec3]) {}
}

/// How an action starts.
pub struct ActionStart {
    /// The runner.
    pub runner: Box<dyn ActionRunner>,
    /// New positions to start from, at rest, when the action puts the garment somewhere first (a motion of the
    /// whole that cannot make layers cross).
    pub start_positions: Option<Vec<Vec3>>,
    /// How long it takes [s], where only the body knows that.
    pub duration: Option<f64>,
}

impl ActionStart {
    /// From where the cloth is.
    pub fn here(runner: impl ActionRunner + 'static) -> Result<Self> {
        Ok(Self { runner: Box::new(runner), start_positions: None, duration: None })
    }
}

/// A runner that lets one drive act unchanged.
pub(crate) struct ConstantLoads {
    pub loads: Loads,
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

/// TargetSprings are this stiff along their normal: without help the weight of the point would bend them by so much [m].
const GUIDE_SAG: f64 = 5e-4;
/// Stiffness of a guide across its normal, as a share of that along it.
const GUIDE_SLIDE: f64 = 0.02;

/// The hand under a point of `mass`: draws it to `target`, stiffly along `normal`, and carries its weight.
pub(super) fn carry_spring(point: u32, target: Vec3, normal: Vec3, mass: f64) -> TargetSpring {
    let weight = Vec3::y() * (mass * crate::sim::GRAVITY);
    let stiffness = mass * crate::sim::GRAVITY / GUIDE_SAG;
    let slide = GUIDE_SLIDE * stiffness;
    let along = normal * normal.dot(&weight);
    let target = target + along / stiffness + (weight - along) / slide;
    TargetSpring { point, target, normal, stiffness, tangential_stiffness: slide }
}

/// The hand on a point of `mass` that stays where it is.
pub(super) fn pin_spring(point: u32, place: Vec3, mass: f64) -> TargetSpring {
    TargetSpring::isotropic(point, place, mass * crate::sim::GRAVITY / GUIDE_SAG)
}

/// From 0 to 1 without a jerk at either end.
pub(super) fn smoothstep(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}
