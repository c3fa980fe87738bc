//! Motion of a body in progress: what `bend` and `play` have in common.
//!
//! Steps are short enough to follow the body while it moves; while it stands, the cloth determines them. The body acts on
//! the garment through `Loads::body` only: contact and friction do the rest.

use crate::wear::action_runner::{ActionContext, ActionRunner};
use crate::wear::motion::motion_profile::PEAK_RATE;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::FieldError;
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, BodyPose, LookupError, PosedBody};
use crease_model::error::{Message, Result, Setting};
use crease_solver::sim::Loads;
use serde_json::Value;
use std::sync::Arc;

/// A span of time after the start of an action [s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeSpan {
    pub start: f64,
    pub end: f64,
}

/// The body at a time.
pub(crate) struct CachedBody {
    /// Time after the start [s].
    time: f64,
    posed: PosedBody,
}

/// A body that moves through poses.
pub(crate) struct BodyMotionRunner {
    body: Arc<AnimatedBody>,
    /// Loads besides the body.
    idle_loads: Loads,
    /// Pose at a time after the start [s].
    pose_at: Box<dyn Fn(f64) -> BodyPose>,
    /// See [`ActionRunner::event_times`].
    event_times: Vec<f64>,
    /// Spans in which the body stands.
    still: Vec<TimeSpan>,
    duration: f64,
    /// The result of the last request: a step asks several times.
    cached: Option<CachedBody>,
}

impl BodyMotionRunner {
    /// A motion of `body` of `duration` seconds, in the pose `pose_at` a time after the start [s].
    pub fn new(
        body: Arc<AnimatedBody>,
        idle_loads: Loads,
        duration: f64,
        pose_at: impl Fn(f64) -> BodyPose + 'static,
    ) -> Self {
        let pose_at = Box::new(pose_at);
        Self { body, idle_loads, pose_at, event_times: Vec::new(), still: Vec::new(), duration, cached: None }
    }

    /// Adds times that no step may cross [s], increasing, and spans in which the body stands.
    pub fn with_events(self, event_times: Vec<f64>, still: Vec<TimeSpan>) -> Self {
        Self { event_times, still, ..self }
    }
}

impl ActionRunner for BodyMotionRunner {
    fn loads_at(&mut self, t: f64, _x: &[Vec3]) -> Loads {
        let cached = self.cached.take().filter(|cached| cached.time == t);
        let posed =
            cached.map_or_else(|| PosedBody::new(&self.body, (self.pose_at)(t)), |cached| cached.posed);
        self.cached = Some(CachedBody { time: t, posed: posed.clone() });
        let max_dt_moving = TUNING.body.max_dt_moving;
        let stands = self.still.iter().any(|span| span.start + max_dt_moving < t && t <= span.end + 1e-9);
        let max_dt = if stands { f64::INFINITY } else { max_dt_moving };
        Loads { body: Some(posed), max_dt, guided: !stands, ..self.idle_loads.clone() }
    }

    fn event_times(&self) -> Vec<f64> {
        self.event_times.clone()
    }

    fn save_state(&self) -> Option<Value> {
        // The motion is determined at the start.
        Some(Value::Null)
    }

    fn finish(&mut self, persistent: &mut PersistentState, _x: &[Vec3]) {
        persistent.laid_bend.clear();
        persistent.body = Some(PosedBody::new(&self.body, (self.pose_at)(self.duration)));
    }
}

/// The body that the garment is worn on, for the action `name`, which moves it.
///
/// # Errors
/// A diagnostic of the script if there is none.
pub(crate) fn required_body<'a>(
    name: &str,
    context: &ActionContext,
    persistent: &'a PersistentState,
) -> Result<&'a PosedBody> {
    persistent.body.as_ref().ok_or_else(|| {
        context.refuse(
            format!("`{name}` moves a body, and the garment is not on one"),
            Message::from("give ") + Setting::Body + ", and leave out what takes the garment off before",
        )
    })
}

/// Time for the transition between two poses [s]; 0 if they are the same.
pub(crate) fn transition_time(body: &AnimatedBody, from: &BodyPose, to: &BodyPose) -> f64 {
    let (a, b) = (body.points(from), body.points(to));
    let distance = a.iter().zip(&b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    if distance > TUNING.body.same_pose_distance {
        (PEAK_RATE * distance / TUNING.body.max_transition_speed).max(4.0 * TUNING.body.max_dt_moving)
    } else {
        0.0
    }
}

/// Error of the field `field` for a joint or a clip that `body` lacks.
pub(crate) fn lookup_error(field: &'static str, body: &AnimatedBody, error: LookupError) -> FieldError {
    FieldError::new(field, format!("{} has {}", body.file, error.message), error.help)
}
