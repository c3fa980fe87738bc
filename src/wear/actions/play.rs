//! `play`: an animation clip of the body is played.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::motion::body_motion::{BodyMotionRunner, lookup_error, required_body, transition_time};
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::motion::slowed_jumps::{ClipMoment, SlowedJumps};
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_model::body::{AnimatedBody, BodyPose, LookupError, RootMotion, interpolate_body_pose};
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Play an animation clip of the body, as often as asked. Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Play {
    /// Name of the clip in the body's file, or its number: `clip#2` is `animations[2]`. Of several clips of one name the one that
    /// moves the body is taken.
    #[schemars(length(min = 1))]
    pub clip: String,
    /// Number of repetitions. Default 1.
    #[serde(default = "default_repeat")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
    /// Whether the body is carried through the scene as the clip does, walking or turning. Without it such a clip is played in
    /// place: the wear is the same, except for what inertia does to cloth that hangs free. Default false.
    #[serde(default)]
    pub keep_root_motion: bool,
}

fn default_repeat() -> u32 {
    1
}

/// A clip of a body, as it is played.
#[derive(Clone)]
struct PlayedClip {
    body: Arc<AnimatedBody>,
    clip: usize,
    /// Time that playing it takes [s].
    length: f64,
    /// Root motion that is left out.
    root: Option<RootMotion>,
    /// Its jumps.
    jumps: SlowedJumps,
}

impl PlayedClip {
    /// The pose at `t` [s] after its beginning: as in the clip, except that the body moves where the clip jumps.
    fn pose(&self, t: f64) -> BodyPose {
        let at = |t: f64| self.body.clip_pose(self.clip, t, self.root.as_ref());
        match self.jumps.moment(t) {
            ClipMoment::At(t) => at(t),
            ClipMoment::Between { from, to, fraction } => interpolate_body_pose(&at(from), &at(to), fraction),
        }
    }
}

impl Play {
    /// Root motion of the clip `clip` that is left out.
    fn removed_root_motion(&self, body: &AnimatedBody, clip: usize) -> Option<RootMotion> {
        if self.keep_root_motion { None } else { body.root_motion(clip) }
    }

    fn played_clip(&self, body: &Arc<AnimatedBody>) -> std::result::Result<PlayedClip, LookupError> {
        let clip = body.find_clip(&self.clip)?;
        let root = self.removed_root_motion(body, clip);
        let jumps = SlowedJumps::new(body, clip, root.as_ref());
        let length = body.clip_length(clip) + jumps.added_time();
        Ok(PlayedClip { body: body.clone(), clip, length, root, jumps })
    }

    /// Returns the first pose of the clip on `body`; `None` without such a clip.
    pub fn first_pose(&self, body: &AnimatedBody) -> Option<BodyPose> {
        let clip = body.find_clip(&self.clip).ok()?;
        Some(body.clip_pose(clip, 0.0, self.removed_root_motion(body, clip).as_ref()))
    }

    /// Duration on `body` [s], without transitions to its first pose.
    pub fn duration_on(&self, body: &AnimatedBody) -> f64 {
        let Ok(clip) = body.find_clip(&self.clip) else { return 0.0 };
        let jumps = SlowedJumps::new(body, clip, self.removed_root_motion(body, clip).as_ref());
        f64::from(self.repeat) * (body.clip_length(clip) + jumps.added_time())
    }
}

impl WearAction for Play {
    /// 0: only the body determines the length of its clip.
    fn duration(&self) -> f64 {
        0.0
    }

    fn needs_body(&self) -> bool {
        true
    }

    fn validate_body(&self, body: &AnimatedBody) -> Vec<FieldError> {
        let error = body.find_clip(&self.clip).err();
        error.map(|error| lookup_error("clip", body, error)).into_iter().collect()
    }

    fn body_notes(&self, body: &AnimatedBody) -> Vec<String> {
        let Ok(clip) = body.find_clip(&self.clip) else { return Vec::new() };
        let root = self.removed_root_motion(body, clip);
        let jumps = SlowedJumps::new(body, clip, root.as_ref());
        let note = |root: RootMotion| {
            format!(
                "the clip \"{}\" carries the body {:.2} m away and turns it by {:.0} degrees: it is played in place, seen from \"{}\"; \
                 `keep_root_motion` plays it as it is",
                self.clip,
                root.travel_m,
                root.turn.to_degrees(),
                body.node_name(root.node)
            )
        };
        let doubts = body.clip_doubts(clip).into_iter().chain(jumps.note(body));
        root.map(note)
            .into_iter()
            .chain(doubts.map(|doubt| format!("the clip \"{}\": {doubt}", self.clip)))
            .collect()
    }

    fn body_poses(&self, body: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        let Ok(clip) = body.find_clip(&self.clip) else { return Vec::new() };
        let (length, root) = (body.clip_length(clip), self.removed_root_motion(body, clip));
        let count = (length * TUNING.body.clip_sample_rate).ceil() as u32;
        let count = count.clamp(1, TUNING.body.max_clip_samples);
        let time = |k: u32| length * f64::from(k) / f64::from(count);
        (0..=count).map(|k| body.clip_pose(clip, time(k), root.as_ref())).collect()
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let posed = required_body("play", context, persistent)?;
        let body = posed.body.clone();
        let clip = self.played_clip(&body).map_err(|error| {
            let error = lookup_error("clip", &body, error);
            context.refuse(error.message, error.help)
        })?;
        let length = clip.length;
        let (first, last) = (clip.pose(0.0), clip.pose(length));
        // The body moves to the first pose of the clip, and between repetitions from its last pose back there.
        let lead = transition_time(&body, &posed.pose, &first);
        let back = transition_time(&body, &last, &first);
        let from = posed.pose.clone();
        let duration = lead + f64::from(self.repeat) * length + f64::from(self.repeat - 1) * back;
        let pose_at = move |t: f64| {
            if t < lead {
                return interpolate_body_pose(&from, &first, smoothstep(t / lead));
            }
            let own = if t >= duration { length } else { (t - lead).rem_euclid(length + back) };
            if own > length {
                return interpolate_body_pose(&last, &first, smoothstep((own - length) / back));
            }
            clip.pose(own)
        };
        let motion = BodyMotionRunner::new(body, persistent.idle_loads(), duration, pose_at);
        Ok(ActionStart { duration: Some(duration), ..ActionStart::here(motion)? })
    }

    fn example() -> Self {
        Self { clip: "walk".to_owned(), repeat: 3, keep_root_motion: true }
    }
}
