//! `bend`: a joint of the body bends and goes back, as an elbow does a thousand times.

use crate::body::{AnimatedBody, BodyPose};
use crate::error::Result;
use crate::math::Vec3;
use crate::wear::action_runner::{ActionContext, ActionStart, PersistentState, smoothstep};
use crate::wear::actions::{FieldError, WearAction};
use crate::wear::body_motion::{Moving, told_names};
use nalgebra::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bend a joint of the body by an angle about an axis, hold it there, and bring it back; as often as asked.
/// Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bend {
    /// Name of the joint, as the body file has it.
    #[schemars(length(min = 1))]
    pub joint: String,
    /// What it turns about: `x`, `y` or `z` of the joint, or a vector [x, y, z] in them.
    pub axis: JointAxis,
    /// How far it turns from where it is (in the file, unless a clip has moved it) [degrees]; the sign says which way
    /// (right-hand rule).
    #[serde(rename = "angle")]
    #[schemars(range(min = -180, max = 180))]
    pub angle_deg: f64,
    /// How long bending takes, and going back again [s]. Default 1.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// How long it stays bent [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
    /// How often. Default 1.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
}

/// An axis of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Axis")]
pub enum JointAxis {
    /// One of the joint's own.
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
    /// As a vector; not of unit length when the script's was not.
    pub fn vector(self) -> [f64; 3] {
        match self {
            Self::Own(LocalAxis::X) => [1.0, 0.0, 0.0],
            Self::Own(LocalAxis::Y) => [0.0, 1.0, 0.0],
            Self::Own(LocalAxis::Z) => [0.0, 0.0, 1.0],
            Self::Vector(vector) => vector,
        }
    }
}

/// Postures between straight and bent that tell what moves.
const SAMPLES: u32 = 12;

impl Bend {
    /// `from`, with `share` of the bend.
    fn bent(&self, wearer: &AnimatedBody, from: &BodyPose, share: f64) -> BodyPose {
        let joint = wearer.rig().and_then(|rig| rig.skeleton.find(&self.joint));
        let mut pose = from.clone();
        if let (BodyPose::Joints(joints), Some(joint)) = (&mut pose, joint)
            && let (Some(local), Some(axis)) =
                (joints.get_mut(joint), Unit::try_new(Vec3::from(self.axis.vector()), 0.0))
        {
            *local = local.rotated(&axis, share * self.angle_deg.to_radians());
        }
        pose
    }

    /// How much of it is bent at `t` [s].
    fn share(&self, t: f64) -> f64 {
        let once = 2.0 * self.over_s + self.hold_s;
        let own = if t >= self.duration() { 0.0 } else { t.rem_euclid(once) };
        smoothstep(own / self.over_s).min(smoothstep((once - own) / self.over_s))
    }

    /// When it is held bent: from, to [s].
    fn hold_times(&self) -> Vec<[f64; 2]> {
        let once = 2.0 * self.over_s + self.hold_s;
        let begin = |k: u32| f64::from(k) * once + self.over_s;
        let times = (0..self.repeat).map(|k| [begin(k), begin(k) + self.hold_s]);
        times.filter(|_| self.hold_s > 0.0).collect()
    }
}

fn over_s() -> f64 {
    1.0
}

fn once() -> u32 {
    1
}

impl WearAction for Bend {
    fn duration(&self) -> f64 {
        f64::from(self.repeat) * (2.0 * self.over_s + self.hold_s)
    }

    fn needs_body(&self) -> bool {
        true
    }

    fn validate(&self) -> Vec<FieldError> {
        let mut misfits = Vec::new();
        let length = self.axis.vector().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Squares of smaller or larger numbers leave the range of doubles.
        if !(1e-100..=1e100).contains(&length) {
            let cure = "give a direction such as [0, 0, 1], or `x`, `y`, `z`";
            misfits.push(FieldError::new("axis", "the axis has no usable direction", cure));
        }
        if self.angle_deg == 0.0 {
            misfits.push(FieldError::new(
                "angle",
                "an angle of 0 bends nothing",
                "give an angle in degrees, not 0",
            ));
        }
        misfits
    }

    fn validate_body(&self, wearer: &AnimatedBody) -> Vec<FieldError> {
        if wearer.rig().is_some_and(|rig| rig.skeleton.find(&self.joint).is_some()) {
            return Vec::new();
        }
        let what = format!("{} has no joint called \"{}\"", wearer.file, self.joint);
        vec![FieldError::new("joint", what, told_names("joints", &wearer.joint_names(), &self.joint))]
    }

    fn body_poses(&self, wearer: &AnimatedBody, from: &BodyPose) -> Vec<BodyPose> {
        (0..=SAMPLES).map(|k| self.bent(wearer, from, f64::from(k) / f64::from(SAMPLES))).collect()
    }

    fn start_action(&self, context: &ActionContext, persistent: &mut PersistentState) -> Result<ActionStart> {
        let Some(standing) = &persistent.body else {
            return Err(context.refuse(
                "`bend` moves a body, and the garment is not on one",
                "give --body, and leave out what takes the garment off before",
            ));
        };
        if let Some(misfit) = self.validate_body(&standing.body).into_iter().next() {
            return Err(context.refuse(misfit.what, misfit.cure));
        }
        let (bend, from) = (self.clone(), standing.pose.clone());
        let wearer = standing.body.clone();
        let once = 2.0 * self.over_s + self.hold_s;
        let runner = Moving {
            wearer: wearer.clone(),
            drive: persistent.idle_loads(),
            pose: Box::new(move |t| bend.bent(&wearer, &from, bend.share(t))),
            // No step may jump over a whole way down and up.
            breaks: (0..self.repeat).map(|k| f64::from(k) * once + self.over_s + self.hold_s).collect(),
            still: self.hold_times(),
            duration: self.duration(),
            at: None,
        };
        ActionStart::here(runner)
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
