//! `play`: an animation clip of the body is played.

use crate::body::{AnimatedBody, BodyPose, interpolate_body_pose};
use crate::error::Result;
use crate::wear::action_runner::{ActionContext, ActionStart, PersistentState, smoothstep};
use crate::wear::actions::{FieldError, WearAction};
use crate::wear::body_motion::{Moving, told_names, way_s};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Play an animation clip of the body, as often as asked. Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Play {
    /// Name of the clip, as the body file has it.
    #[schemars(length(min = 1))]
    pub clip: String,
    /// How often. Default 1.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
}

/// Postures per second of a clip that tell what moves, and how many at most.
const SAMPLE_RATE: f64 = 10.0;
const MOST_SAMPLES: u32 = 200;

fn once() -> u32 {
    1
}

impl WearAction for Play {
    /// 0: only the body knows how long its clip is.
    fn duration(&self) -> f64 {
        0.0
    }

    fn needs_body(&self) -> bool {
        true
    }

    fn validate_body(&self, wearer: &AnimatedBody) -> Vec<FieldError> {
        if wearer.clip_length(&self.clip).is_some() {
            return Vec::new();
        }
        let what = format!("{} has no clip called \"{}\"", wearer.file, self.clip);
        vec![FieldError::new("clip", what, told_names("clips", &wearer.clip_names(), &self.clip))]
    }

    fn body_poses(&self, wearer: &AnimatedBody, _from: &BodyPose) -> Vec<BodyPose> {
        let length = wearer.clip_length(&self.clip).unwrap_or(0.0);
        let count = ((length * SAMPLE_RATE).ceil() as u32).clamp(1, MOST_SAMPLES);
        (0..=count)
            .filter_map(|k| wearer.clip_pose(&self.clip, length * f64::from(k) / f64::from(count)))
            .collect()
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(standing) = &persistent.body else {
            return Err(context.refuse(
                "`play` moves a body, and the garment is not on one",
                "give --body, and leave out what takes the garment off before",
            ));
        };
        let wearer = standing.body.clone();
        let length = wearer.clip_length(&self.clip);
        let ends = length.and_then(|length| {
            Some((length, wearer.clip_pose(&self.clip, 0.0)?, wearer.clip_pose(&self.clip, length)?))
        });
        let Some((length, first, last)) = ends else {
            let misfit = self.validate_body(&wearer).into_iter().next();
            let misfit = misfit.unwrap_or_else(|| FieldError::new("clip", "it cannot be played", ""));
            return Err(context.refuse(misfit.what, misfit.cure));
        };
        // The body goes to where the clip begins, and from its end back there, as fast as a calm arm.
        let lead = way_s(&wearer, &standing.pose, &first);
        let back = way_s(&wearer, &last, &first);
        let (from, clip) = (standing.pose.clone(), self.clip.clone());
        let duration = lead + f64::from(self.repeat) * length + f64::from(self.repeat - 1) * back;
        let of_clip = wearer.clone();
        let pose = move |t: f64| {
            if t < lead {
                return interpolate_body_pose(&from, &first, smoothstep(t / lead));
            }
            let own = if t >= duration { length } else { (t - lead).rem_euclid(length + back) };
            if own > length {
                return interpolate_body_pose(&last, &first, smoothstep((own - length) / back));
            }
            of_clip.clip_pose(&clip, own).unwrap_or_else(|| last.clone())
        };
        let runner = Moving {
            wearer,
            drive: persistent.idle_loads(),
            pose: Box::new(pose),
            breaks: Vec::new(),
            still: Vec::new(),
            duration,
            at: None,
        };
        Ok(ActionStart { duration: Some(duration), ..ActionStart::here(runner)? })
    }

    fn example() -> Self {
        Self { clip: "walk".to_owned(), repeat: 3 }
    }
}
