//! Checkpoints: a bake between two of its steps, as one file, so that a killed run goes on where it was.
//!
//! Everything that influences the next step is in it, bit for bit: the state, the memory with its running timers, the
//! posture, what the action under way has learnt, and the counts of the report. What is kept for speed only (the
//! pattern and elimination order of the linear system) is not: the bake forgets it at every moment that a checkpoint
//! may be of, whether one is written or not, so that a run that was taken up makes the same bytes as one that was not.
//!
//! A checkpoint belongs to one run: its key is a hash of garment, fabric, script, options and version. The file is two
//! lines of JSON, the hash of the second line and the checkpoint itself, so that a damaged file is told from a good one.
//! An action under way is begun again from the cloth it began on, which costs nothing and keeps gestures out of the file.
//!
//! Does not do: when a checkpoint is written and where (the tool), results (they are written when all is done).

use crate::bake::body_coupling::BodyCheckpoint;
use crate::bake::violation_log::UnmetLog;
use crate::bake::{BakeOptions, BakeReport, Run};
use crate::body::AnimatedBody;
use crate::contact::TangentialState;
use crate::error::{Error, Result};
use crate::fabric::Fabric;
use crate::garment::Garment;
use crate::math::Vec3;
use crate::memory::Memory;
use crate::sim::Loads;
use crate::sim::{SolveCost, State};
use crate::wear::{DURATION_LIMIT_S, PersistentState, WearScript};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// The format and version this module writes and reads.
pub const CHECKPOINT_FORMAT: &str = "crease-checkpoint/1";

/// Steps never ask for less than this [s]; a file that does was made up.
const LEAST_STEP: f64 = 1e-6;

/// A bake between two of its steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    /// Hash of what the run is made from: [`fingerprint`].
    pub key: String,
    /// Actions that are over; the next one has begun if there is a `way`.
    pub action: usize,
    /// Where in the action; `None` before its beginning.
    pub way: Option<Way>,
    /// What the actions before have left.
    pub posture: PersistentState,
    /// The cloth.
    pub state: State,
    /// What friction keeps from step to step.
    pub friction: Vec<TangentialState>,
    /// The body it is on, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<BodyCheckpoint>,
    /// Its memory.
    pub memory: Memory,
    /// Counts so far.
    pub counts: Counts,
}

/// Where in an action a run is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Way {
    /// Positions on which the action began, one per point [m].
    #[serde(with = "crate::math::serde_vec::vectors")]
    pub start: Vec<Vec3>,
    /// Simulated time at which it began [s].
    pub begin: f64,
    /// Part of the action, counted by its breaks.
    pub part: usize,
    /// Length the next step should have [s].
    pub wished: f64,
    /// What its gesture has learnt.
    pub memo: Value,
}

/// What a report counts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Accepted steps.
    pub steps: u64,
    /// Thrown-away tries.
    pub rejected: u64,
    /// Linear solves of the whole.
    pub solves: u64,
    /// Linear solves of a few places.
    pub local_solves: u64,
    /// What they took.
    #[serde(default)]
    pub cost: SolveCost,
    /// Steps accepted before Newton had converged.
    pub unconverged: u64,
    /// The largest move they still asked for [m].
    pub largest_rest: f64,
    /// The move that the last step still asked for, if it did not converge [m].
    pub last_rest: Option<f64>,
    /// What went less well.
    pub warnings: Vec<String>,
    /// Demands that could not be met.
    pub unmet: UnmetLog,
    /// Seconds by stage.
    pub seconds: [f64; 5],
    /// Frames given to the observer.
    pub frames: u64,
    /// Simulated time of the next frame [s]; infinite for never.
    #[serde(with = "crate::math::serde_vec::limit")]
    pub next_frame: f64,
}

/// Hash of everything that the result of a bake depends on.
pub fn fingerprint(garment: &Garment, fabric: &Fabric, script: &WearScript, options: &BakeOptions) -> String {
    let mut hash = Sha256::new();
    let head = json!([env!("CARGO_PKG_VERSION"), fabric, script, format!("{options:?}")]);
    hash.update(head.to_string());
    let mut numbers = |list: &mut dyn Iterator<Item = f64>| list.for_each(|x| hash.update(x.to_le_bytes()));
    numbers(&mut garment.points.iter().flat_map(|p| [p.x, p.y, p.z]));
    numbers(&mut garment.material.iter().flatten().flat_map(|m| [m.x, m.y]));
    numbers(&mut garment.memory_mask.iter().copied());
    garment.triangles.iter().flatten().for_each(|p| hash.update(p.0.to_le_bytes()));
    hex(&hash.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Checkpoint {
    /// The file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let body = json!(self).to_string();
        let head = json!({"format": CHECKPOINT_FORMAT, "sha256": hex(&Sha256::digest(body.as_bytes()))});
        format!("{head}\n{body}\n").into_bytes()
    }

    /// Reads the file `file` (a name for messages). Fails on anything but what [`Checkpoint::to_bytes`] wrote.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self> {
        let refuse = |place: &str, what: String| Err(Error::input(file, place, what, CURE));
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

    /// Reads the second line alone.
    pub fn parse_body(file: &str, body: &str) -> Result<Self> {
        serde_json::from_str(body).map_err(|e| {
            let what = e.to_string();
            let what = what.split(" at line ").next().unwrap_or(&what);
            Error::input(file, format!("line 2, column {}", e.column()), what, CURE)
        })
    }

    /// Whether it can be of a run on `garment` with `key`; every index and length is checked.
    pub fn check(
        &self,
        file: &str,
        garment: &Garment,
        script: &WearScript,
        wearer: Option<&AnimatedBody>,
        key: &str,
    ) -> Result<()> {
        let refuse = |what: &str| Err(Error::input(file, "", what, CURE));
        if self.key != key {
            return refuse(
                "is of another run: the garment, the fabric, the script, an option or crease differs",
            );
        }
        let points = garment.points.len();
        let hinges = garment.topology.hinges.len();
        let lists = self.state.x.len() == points
            && self.state.v.len() == points
            && self.state.angle.len() == hinges
            && self.state.previous.as_ref().is_none_or(|p| p.x.len() == points && p.v.len() == points)
            && self.way.as_ref().is_none_or(|way| way.start.len() == points)
            && self.memory.fits(hinges, garment.triangles.len());
        let on_body = match (&self.body, wearer) {
            (None, None) => true,
            (Some(body), Some(wearer)) => body.fits(wearer, points),
            _ => false,
        };
        let inside = |p: &u32| (*p as usize) < points;
        let kept = |drive: &Loads| {
            (drive.fixed.is_empty() || drive.fixed.len() == points)
                && drive.springs.iter().all(|guide| inside(&guide.point))
        };
        let posture = self.posture.folds.iter().all(|fold| fold.flap.iter().all(inside))
            && self.posture.held_loads.as_ref().is_none_or(kept);
        let times = (0.0..=2.0 * DURATION_LIMIT_S).contains(&self.state.time)
            && self.state.previous.as_ref().is_none_or(|p| p.step > 0.0)
            && self
                .way
                .as_ref()
                .is_none_or(|w| w.wished >= LEAST_STEP && (0.0..=self.state.time).contains(&w.begin));
        if !(lists && on_body && posture && times && self.action <= script.flatten().count()) {
            return refuse("does not fit the garment it says it is of");
        }
        Ok(())
    }
}

/// Cure for every fault of a checkpoint.
const CURE: &str = "delete it, or leave out --resume, and the run begins anew";

impl Run<'_> {
    /// The checkpoint of this moment: `action` actions are over.
    pub(super) fn checkpoint(
        &self,
        action: usize,
        posture: &PersistentState,
        way: Option<Way>,
    ) -> Checkpoint {
        let BakeReport { steps, rejected, solves, local_solves, cost, ref warnings, .. } = self.report;
        Checkpoint {
            key: self.key.clone(),
            action,
            way,
            posture: PersistentState { body: None, ..posture.clone() },
            state: self.state.clone(),
            memory: self.memory.clone(),
            friction: self.stepper.contact.friction_state(),
            body: self.body_moment(posture),
            counts: Counts {
                steps,
                rejected,
                solves,
                local_solves,
                cost,
                unconverged: self.unconverged,
                largest_rest: self.largest_rest,
                last_rest: self.last_rest,
                warnings: warnings.clone(),
                unmet: self.unmet.clone(),
                seconds: self.seconds,
                frames: self.frames,
                next_frame: self.next_frame,
            },
        }
    }

    /// Takes up the cloth, its memory and the counts of a checkpoint that fits.
    pub(super) fn restore(&mut self, from: Checkpoint) {
        let counts = from.counts;
        // The body was put on before.
        let body = self.posture.body.take();
        self.posture = PersistentState { body, ..from.posture };
        self.state = from.state;
        self.memory = from.memory;
        self.stepper.contact.restore_friction_state(&from.friction);
        self.unmet = counts.unmet;
        self.report.steps = counts.steps;
        self.report.rejected = counts.rejected;
        self.report.solves = counts.solves;
        self.report.local_solves = counts.local_solves;
        self.report.cost = counts.cost;
        self.report.warnings = counts.warnings;
        self.unconverged = counts.unconverged;
        self.largest_rest = counts.largest_rest;
        self.last_rest = counts.last_rest;
        self.seconds = counts.seconds;
        self.frames = counts.frames;
        self.next_frame = counts.next_frame;
    }
}
