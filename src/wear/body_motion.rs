//! A body under way: what `bend` and `play` have in common.
//!
//! While it moves, steps are short enough to follow it; while it stands, the cloth decides. The garment feels it through
//! `Loads::body`, nothing else: what the body is doing to it is for contact and friction to say.

use crate::body::{AnimatedBody, BodyPose, PosedBody};
use crate::json::nearest;
use crate::math::Vec3;
use crate::sim::Loads;
use crate::wear::action_runner::{ActionRunner, PersistentState};
use serde_json::Value;
use std::sync::Arc;

/// Steps while a body moves [s].
const MOVING_STEP: f64 = 1.0 / 30.0;
/// Speed of the fastest point on the way between two postures [m/s].
const CALM: f64 = 0.4;
/// Postures whose points differ by less than this are one [m].
const SAME: f64 = 1e-4;
/// Names listed in a message.
const NAMES_TOLD: usize = 40;

/// A body that goes through postures.
pub(super) struct Moving {
    pub wearer: Arc<AnimatedBody>,
    /// What else acts.
    pub drive: Loads,
    /// Pose at a time after its start [s].
    pub pose: Box<dyn Fn(f64) -> BodyPose>,
    /// See [`ActionRunner::breaks`].
    pub breaks: Vec<f64>,
    /// From, to: when it stands [s].
    pub still: Vec<[f64; 2]>,
    pub duration: f64,
    /// The last time asked for and the points then: a step asks several times.
    pub at: Option<(f64, Arc<[Vec3]>)>,
}

impl ActionRunner for Moving {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let known = self.at.take().filter(|(at, _)| *at == t);
        let (_, points) = known.unwrap_or_else(|| (t, self.wearer.points(&(self.pose)(t)).into()));
        self.at = Some((t, points.clone()));
        let stands = self.still.iter().any(|[from, to]| *from + MOVING_STEP < t && t <= to + 1e-9);
        let longest_step = if stands { f64::INFINITY } else { MOVING_STEP };
        Loads { body: Some(points), max_dt: longest_step, ..self.drive.clone() }
    }

    fn event_times(&self) -> Vec<f64> {
        self.breaks.clone()
    }

    fn save_state(&self) -> Option<Value> {
        // Where the body is at a time was settled when it began.
        Some(Value::Null)
    }

    fn finish(&mut self, persistent: &mut PersistentState, _x: &[Vec3]) {
        persistent.body = Some(PosedBody::new(&self.wearer, (self.pose)(self.duration)));
    }
}

/// Time for the way from one persistent to another [s]; 0 if they are the same.
pub(super) fn way_s(wearer: &AnimatedBody, from: &BodyPose, to: &BodyPose) -> f64 {
    let (a, b) = (wearer.points(from), wearer.points(to));
    let farthest = a.iter().zip(&b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    // The smooth start and end make the fastest part 1.5 times the mean.
    if farthest > SAME { (1.5 * farthest / CALM).max(4.0 * MOVING_STEP) } else { 0.0 }
}

/// A cure: the names there are, and the one that was probably meant.
pub(super) fn told_names(kind: &str, names: &[String], wanted: &str) -> String {
    if names.is_empty() {
        return format!("it has no {kind}");
    }
    let list: Vec<&str> = names.iter().map(String::as_str).collect();
    let meant = nearest(wanted, list.iter().copied())
        .map(|name| format!("did you mean \"{name}\"? "))
        .unwrap_or_default();
    let more = if list.len() > NAMES_TOLD { ", and more" } else { "" };
    format!("{meant}{kind}: {}{more}", list[..list.len().min(NAMES_TOLD)].join(", "))
}
