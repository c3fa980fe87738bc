//! `play`: an animation clip of the body is played.

use crate::body::{AnimatedBody, BodyPose, interpolate_body_pose};
use crate::error::Result;
use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::body_motion::{BodyMotionRunner, name_help, required_body, transition_time};
use crate::wear::motion_profile::smoothstep;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Play an animation clip of the body, as often as asked. Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Play {
    /// Name of the clip in the body's file.
    #[schemars(length(min = 1))]
    pub clip: String,
    /// Number of repetitions. Default 1.
    #[serde(default = "default_repeat")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
}

fn default_repeat() -> u32 {
    1
}

/// Length of a clip [s] and its poses at both ends.
struct ClipEnds {
    length: f64,
    first: BodyPose,
    last: BodyPose,
}

impl Play {
    fn clip_ends(&self, body: &AnimatedBody) -> Option<ClipEnds> {
        let length = body.clip_length(&self.clip)?;
        let (first, last) = (body.clip_pose(&self.clip, 0.0)?, body.clip_pose(&self.clip, length)?);
        Some(ClipEnds { length, first, last })
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
        if body.clip_length(&self.clip).is_some() {
            return Vec::new();
        }
        let message = format!("{} has no clip called \"{}\"", body.file, self.clip);
        vec![FieldError::new("clip", message, name_help("clips", &body.clip_names(), &self.clip))]
    }

    fn body_poses(&self, body: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        let length = body.clip_length(&self.clip).unwrap_or(0.0);
        let count = (length * TUNING.body.clip_sample_rate).ceil() as u32;
        let count = count.clamp(1, TUNING.body.max_clip_samples);
        (0..=count)
            .filter_map(|k| body.clip_pose(&self.clip, length * f64::from(k) / f64::from(count)))
            .collect()
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let posed = required_body("play", context, persistent)?;
        let body = posed.body.clone();
        let Some(ClipEnds { length, first, last }) = self.clip_ends(&body) else {
            let error = self.validate_body(&body).into_iter().next();
            let error = error.unwrap_or_else(|| FieldError::new("clip", "it cannot be played", ""));
            return Err(context.refuse(error.message, error.help));
        };
        // The body moves to the first pose of the clip, and between repetitions from its last pose back there.
        let lead = transition_time(&body, &posed.pose, &first);
        let back = transition_time(&body, &last, &first);
        let (from, clip) = (posed.pose.clone(), self.clip.clone());
        let duration = lead + f64::from(self.repeat) * length + f64::from(self.repeat - 1) * back;
        let clip_body = body.clone();
        let pose_at = move |t: f64| {
            if t < lead {
                return interpolate_body_pose(&from, &first, smoothstep(t / lead));
            }
            let own = if t >= duration { length } else { (t - lead).rem_euclid(length + back) };
            if own > length {
                return interpolate_body_pose(&last, &first, smoothstep((own - length) / back));
            }
            clip_body.clip_pose(&clip, own).unwrap_or_else(|| last.clone())
        };
        let motion = BodyMotionRunner::new(body, persistent.idle_loads(), duration, pose_at);
        Ok(ActionStart { duration: Some(duration), ..ActionStart::here(motion)? })
    }

    fn example() -> Self {
        Self { clip: "walk".to_owned(), repeat: 3 }
    }
}
