//! `bend`: a joint of the body bends and goes back, as an elbow does a thousand times.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::motion::body_motion::{BodyMotionRunner, TimeSpan, lookup_error, required_body};
use crate::wear::motion::motion_profile::smoothstep;
use crate::wear::persistent_state::PersistentState;
use crate::wear::tuning::TUNING;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::error::Result;
use nalgebra::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bend a joint of the body by an angle about an axis, hold it there, and bring it back; as often as asked.
/// Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// Name of the joint in the body's file, or its number: `joint#14` is `nodes[14]`. Of several joints of one name the one
    /// that moves the body is taken.
    #[schemars(length(min = 1))]
    pub joint: String,
    /// Axis of the rotation: `x`, `y` or `z` of the joint, or a vector [x, y, z] in its axes.
    pub axis: JointAxis,
    /// Angle from the present pose (that of the file, unless a clip has moved the joint) [degrees]; the sign gives the
    /// direction by the right-hand rule.
    #[serde(rename = "angle")]
    #[schemars(range(min = -180, max = 180))]
    pub angle_deg: f64,
    /// Duration of bending, and of going back [s]. Default 1.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// Time that the joint stays bent [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
    /// Number of repetitions. Default 1.
    #[serde(default = "default_repeat")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
}

/// An axis of rotation of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Axis")]
pub enum JointAxis {
    /// One of the joint's own axes.
    Own(LocalAxis),
    /// A direction in the joint's own axes, of any length but zero.
    Vector([f64; 3]),
}

/// One of a joint's own axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OwnAxis")]
pub enum LocalAxis {
    /// Its x axis.
    X,
    /// Its y axis.
    Y,
    /// Its z axis.
    Z,
}

impl JointAxis {
    /// The axis as a vector; of unit length only if the script's is.
    pub fn vector(self) -> [f64; 3] {
        match self {
            Self::Own(LocalAxis::X) => [1.0, 0.0, 0.0],
            Self::Own(LocalAxis::Y) => [0.0, 1.0, 0.0],
            Self::Own(LocalAxis::Z) => [0.0, 0.0, 1.0],
            Self::Vector(vector) => vector,
        }
    }
}

fn default_over_s() -> f64 {
    1.0
}

fn default_repeat() -> u32 {
    1
}

impl Bend {
    /// The pose `from` with a fraction of the bend of the node `joint` added.
    fn bent_pose(&self, joint: usize, from: &BodyPose, fraction: f64) -> BodyPose {
        let mut pose = from.clone();
        if let Some(joints) = pose.joints_mut()
            && let (Some(local), Some(axis)) =
                (joints.get_mut(joint), Unit::try_new(Vec3::from(self.axis.vector()), 0.0))
        {
            *local = local.rotated(&axis, fraction * self.angle_deg.to_radians());
        }
        pose
    }

    /// Duration of one repetition [s].
    fn period(&self) -> f64 {
        2.0 * self.over_s + self.hold_s
    }

    /// Fraction of the bend at `t` [s].
    fn fraction_at(&self, t: f64) -> f64 {
        let period = self.period();
        let own = if t >= self.duration() { 0.0 } else { t.rem_euclid(period) };
        smoothstep(own / self.over_s).min(smoothstep((period - own) / self.over_s))
    }

    /// Spans in which the joint is held bent.
    fn hold_spans(&self) -> Vec<TimeSpan> {
        let period = self.period();
        let start = |k: u32| f64::from(k) * period + self.over_s;
        let spans = (0..self.repeat).map(|k| TimeSpan { start: start(k), end: start(k) + self.hold_s });
        spans.filter(|_| self.hold_s > 0.0).collect()
    }
}

impl WearAction for Bend {
    fn duration(&self) -> f64 {
        f64::from(self.repeat) * (2.0 * self.over_s + self.hold_s)
    }

    fn needs_body(&self) -> bool {
        true
    }

    fn validate(&self) -> Vec<FieldError> {
        let mut errors = Vec::new();
        let length = self.axis.vector().iter().fold(0.0_f64, |max, x| max.max(x.abs()));
        // Squares of smaller or larger numbers leave the range of doubles.
        if !(1e-100..=1e100).contains(&length) {
            let help = "give a direction such as [0, 0, 1], or `x`, `y`, `z`";
            errors.push(FieldError::new("axis", "the axis has no usable direction", help));
        }
        if self.angle_deg == 0.0 {
            let help = "give an angle in degrees, not 0";
            errors.push(FieldError::new("angle", "an angle of 0 bends nothing", help));
        }
        errors.extend(FieldError::of_radians(self.angle_deg));
        errors
    }

    fn validate_body(&self, body: &AnimatedBody) -> Vec<FieldError> {
        let error = body.find_joint(&self.joint).err();
        error.map(|error| lookup_error("joint", body, error)).into_iter().collect()
    }

    fn body_poses(&self, body: &AnimatedBody, from: &BodyPose) -> Vec<BodyPose> {
        let Ok(joint) = body.find_joint(&self.joint) else { return Vec::new() };
        let samples = TUNING.body.bend_samples;
        (0..=samples).map(|k| self.bent_pose(joint, from, f64::from(k) / f64::from(samples))).collect()
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let posed = required_body("bend", context, persistent)?;
        let joint = posed.body.find_joint(&self.joint).map_err(|error| {
            let error = lookup_error("joint", &posed.body, error);
            context.refuse(error.message, error.help)
        })?;
        let (bend, from) = (self.clone(), posed.pose.clone());
        let body = posed.body.clone();
        // No step may cross a whole motion there and back.
        let release = |k: u32| f64::from(k) * self.period() + self.over_s + self.hold_s;
        let event_times = (0..self.repeat).map(release).collect();
        let pose_at = move |t| bend.bent_pose(joint, &from, bend.fraction_at(t));
        let motion = BodyMotionRunner::new(body, persistent.idle_loads(), self.duration(), pose_at);
        ActionStart::here(motion.with_events(event_times, self.hold_spans()))
    }

    fn example() -> Self {
        Self {
            joint: "elbow".to_owned(),
            axis: JointAxis::Vector([0.0, 0.5, 1.0]),
            angle_deg: -110.0,
            over_s: 0.8,
            hold_s: 0.5,
            repeat: 20,
        }
    }
}
