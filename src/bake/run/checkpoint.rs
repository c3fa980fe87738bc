//! Checkpoints: the state of a bake between two of its steps, as one file, from which a killed run is resumed.
//!
//! A checkpoint holds everything that influences the next step, bit for bit: positions and velocities, the memory with its
//! timers, what the finished actions left, the state of the current action, and the counts of the report. Caches (the pattern
//! and elimination order of the linear system) are not in it: the bake drops them at every possible checkpoint, whether one is
//! written or not, so that a resumed run makes the same bytes as an uninterrupted one.
//!
//! A checkpoint belongs to one run: its fingerprint is a hash of garment, fabric, script, options and version. The file is two
//! lines of JSON, the hash of the second line and the checkpoint itself, so that a damaged file is recognised. The current
//! action is begun again from the positions on which it began, which keeps its runner out of the file.
//!
//! Does not do: when a checkpoint is written and to which file (the tool), results (they are written at the end).

use crate::bake::body::coupling::BodyCheckpoint;

use crate::bake::report::{StageSeconds, StepConvergence};
use crate::bake::run::frames::FrameSchedule;

use crate::bake::run::violation_log::ViolationLog;
use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, Quality};
use crate::wear::{MAX_DURATION_S, PersistentState, TurnRecord, WearScript};
use crease_geometry::math::{PlaneStretch, Vec3};
use crease_linear::SolveCost;
use crease_model::body::AnimatedBody;
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_model::remesh::SimulationMesh;
use crease_solver::contact::TangentialState;
use crease_solver::memory::Memory;
use crease_solver::sim::{Loads, State};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Format and version of the file.
pub const CHECKPOINT_FORMAT: &str = "crease-checkpoint/6";

/// State of a bake between two of its steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    /// Hash of the inputs of the run: [`fingerprint`].
    pub fingerprint: String,
    /// Position in the script.
    pub position: CheckpointPosition,
    /// State that outlives the finished actions.
    pub persistent: PersistentState,
    /// Ends of the edges of the mesh that were split during the run, in order.
    pub splits: Vec<[u32; 2]>,
    /// Positions, velocities and time.
    pub state: State,
    /// Tangential state of the frictional contacts.
    pub friction: Vec<TangentialState>,
    /// The garment as frames show it, if they do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameShape>,
    /// The body and its contact, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<BodyCheckpoint>,
    /// Rest state and timers of the memory law.
    pub memory: Memory,
    /// Counts so far.
    pub counts: RunCounts,
}

/// The garment as the last frame shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameShape {
    /// Positions, one per point [m].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub positions: Vec<Vec3>,
    /// Places on the simulated mesh that they follow, one per point [m].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub followed: Vec<Vec3>,
}

impl From<[Vec<Vec3>; 2]> for FrameShape {
    fn from([positions, followed]: [Vec<Vec3>; 2]) -> Self {
        Self { positions, followed }
    }
}

impl From<FrameShape> for [Vec<Vec3>; 2] {
    fn from(FrameShape { positions, followed }: FrameShape) -> Self {
        [positions, followed]
    }
}

/// Position of a run in its script.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointPosition {
    /// Finished actions: the index of the current action in the flattened script.
    pub action: usize,
    /// Whether that action has begun, and its progress.
    pub progress: ActionPosition,
}

/// Position of a run in its current action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActionPosition {
    /// Before its beginning.
    Before,
    /// Between two of its steps.
    Within(ActionProgress),
}

impl CheckpointPosition {
    /// The position before the beginning of `action`.
    pub fn before_action(action: usize) -> Self {
        Self { action, progress: ActionPosition::Before }
    }

    /// The position between two steps of `action`.
    pub fn within_action(action: usize, progress: ActionProgress) -> Self {
        Self { action, progress: ActionPosition::Within(progress) }
    }

    /// Whether the current action has not begun.
    pub fn is_before_action(&self) -> bool {
        self.progress == ActionPosition::Before
    }

    /// The progress of the current action, if it has begun.
    pub fn into_progress(self) -> Option<ActionProgress> {
        match self.progress {
            ActionPosition::Before => None,
            ActionPosition::Within(progress) => Some(progress),
        }
    }
}

/// Progress of an action that has begun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActionProgress {
    /// Positions on which the action began, one per point [m].
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    pub start: Vec<Vec3>,
    /// Simulated time at which it began [s].
    pub begin: f64,
    /// Index of the segment between its event times.
    pub segment: usize,
    /// Length that the next step should have [s].
    pub dt_request: f64,
    /// State of its runner.
    pub runner_state: Value,
}

/// Counts of a run for its report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunCounts {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected step attempts.
    pub rejected: u64,
    /// Linear solves of global Newton iterations.
    pub solves: u64,
    /// Linear solves of local Newton iterations.
    pub local_solves: u64,
    /// Cost of all linear solves.
    pub cost: SolveCost,
    /// Warnings.
    pub warnings: Vec<Message>,
    /// The first action that did not take place, with the reason.
    pub not_performed: Option<Diagnostic>,
    /// Convergence of the steps.
    pub convergence: StepConvergence,
    /// Violated constraints.
    pub violations: ViolationLog,
    /// Wall time by stage.
    pub seconds: StageSeconds,
    /// Times of frames.
    pub frames: FrameSchedule,
}

/// Hash of everything that the result of a bake depends on: inputs, options, the memory that it begins with, and version.
pub fn fingerprint(
    garment: &Garment,
    fabric: &Fabric,
    script: &WearScript,
    options: &BakeOptions,
    earlier: Option<&RestState>,
) -> String {
    let mut hash = Sha256::new();
    // What is made of the memory in the end does not change the run, nor does where an option comes from.
    let options = BakeOptions { strength: 1.0, quality: Quality::Standard, ..options.resolved() };
    let head = json!([env!("CARGO_PKG_VERSION"), fabric, script, format!("{options:?}")]);
    hash.update(head.to_string());
    let mut numbers = |list: &mut dyn Iterator<Item = f64>| list.for_each(|x| hash.update(x.to_le_bytes()));
    numbers(&mut garment.points.iter().flat_map(|p| [p.x, p.y, p.z]));
    numbers(&mut garment.material.iter().flatten().flat_map(|m| [m.x, m.y]));
    numbers(&mut garment.memory_mask.iter().chain(&garment.sewing_mask).copied());
    if let Some(RestState {
        source_angle,
        rest_angle,
        stiffness_ratio,
        rest_stretch_warp,
        rest_stretch_weft,
    }) = earlier
    {
        for list in [source_angle, rest_angle, stiffness_ratio, rest_stretch_warp, rest_stretch_weft] {
            numbers(&mut list.iter().copied());
        }
    }
    garment.triangles.iter().flatten().for_each(|p| hash.update(p.0.to_le_bytes()));
    hex(&hash.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Checkpoint {
    /// Contents of the file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let body = json!(self).to_string();
        let head = json!({"format": CHECKPOINT_FORMAT, "sha256": hex(&Sha256::digest(body.as_bytes()))});
        format!("{head}\n{body}\n").into_bytes()
    }

    /// Reads the file `file` (a name for messages). Fails on anything but what [`Checkpoint::to_bytes`] wrote.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self> {
        let refuse = |location: &str, what: String| Err(Error::input(file, location, what, help()));
        let Some((head, body)) = std::str::from_utf8(bytes).ok().and_then(|text| text.split_once('\n'))
        else {
            return refuse("", "is no checkpoint of crease: two lines of text were expected".into());
        };
        let head: Value = serde_json::from_str(head).unwrap_or_default();
        if head["format"] != CHECKPOINT_FORMAT {
            return refuse("line 1", format!("the format is not `{CHECKPOINT_FORMAT}`"));
        }
        let body = body.strip_suffix('\n').unwrap_or(body);
        if head["sha256"] != hex(&Sha256::digest(body.as_bytes())) {
            return refuse("line 2", "was cut or changed after it was written".into());
        }
        Self::parse_body(file, body)
    }

    /// Reads the second line of the file alone.
    pub fn parse_body(file: &str, body: &str) -> Result<Self> {
        serde_json::from_str(body).map_err(|e| {
            let what = e.to_string();
            let what = what.split(" at line ").next().unwrap_or(&what);
            Error::input(file, format!("line 2, column {}", e.column()), what, help())
        })
    }

    /// The mesh at the time of the checkpoint, of a run with `fingerprint` that began on `mesh`.
    pub fn refined_mesh(
        &self,
        file: &str,
        mesh: SimulationMesh,
        fingerprint: &str,
    ) -> Result<SimulationMesh> {
        let refuse = |what: &str| Err(Error::input(file, "", what, help()));
        if self.fingerprint != fingerprint {
            return refuse(
                "is of another run: the garment, the fabric, the script, an option or crease differs",
            );
        }
        if self.splits.is_empty() {
            return Ok(mesh);
        }
        match mesh.split(&self.splits) {
            Some(refinement) => Ok(refinement.mesh),
            None => refuse("does not fit the garment it says it is of"),
        }
    }

    /// Checks that it can be of a run on `garment`, with every index and length.
    pub fn check(
        &self,
        file: &str,
        garment: &Garment,
        script: &WearScript,
        animated: Option<&AnimatedBody>,
    ) -> Result<()> {
        let refuse = |what: &str| Err(Error::input(file, "", what, help()));
        let points = garment.points.len();
        let hinges = garment.topology.hinges.len();
        let progress = match &self.position.progress {
            ActionPosition::Before => None,
            ActionPosition::Within(progress) => Some(progress),
        };
        let lists = self.state.x.len() == points
            && self.state.v.len() == points
            && self.state.angle.len() == hinges
            && self.state.previous.as_ref().is_none_or(|p| p.x.len() == points && p.v.len() == points)
            && progress.is_none_or(|progress| progress.start.len() == points)
            && self.memory.fits(hinges, garment.triangles.len());
        let on_body = match (&self.body, animated) {
            (None, None) => true,
            (Some(body), Some(animated)) => body.fits(animated, points),
            _ => false,
        };
        let inside = |p: &u32| (*p as usize) < points;
        let kept = |loads: &Loads| {
            (loads.fixed.is_empty() || loads.fixed.len() == points)
                && loads.springs.iter().all(|spring| inside(&spring.point))
        };
        let turned = |turn: &TurnRecord| match turn {
            TurnRecord::Fold(fold) => {
                fold.flap.iter().all(inside) && (fold.panel.is_empty() || fold.panel.len() == points)
            }
            TurnRecord::Roll(roll) => roll.point_count() == points,
        };
        let persistent = self.persistent.turns.iter().all(turned)
            && self.persistent.held_loads.as_ref().is_none_or(kept)
            && (self.persistent.laid_bend.is_empty() || self.persistent.laid_bend.len() == hinges)
            && (self.persistent.cut.is_empty() || self.persistent.cut.len() == garment.triangles.len())
            && self.persistent.cut.iter().all(PlaneStretch::is_positive);
        let times = (0.0..=2.0 * MAX_DURATION_S).contains(&self.state.time)
            && self.state.previous.as_ref().is_none_or(|p| p.dt > 0.0)
            && progress.is_none_or(|p| {
                p.dt_request >= TUNING.stepping.min_dt_request && (0.0..=self.state.time).contains(&p.begin)
            });
        if !(lists && on_body && persistent && times && self.position.action <= script.flatten().count()) {
            return refuse("does not fit the garment it says it is of");
        }
        Ok(())
    }
}

/// Help for every fault of a checkpoint.
fn help() -> Message {
    Message::from("delete it, or leave out ") + Setting::Resume + ", and the run begins anew"
}
