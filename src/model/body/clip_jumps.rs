//! Jumps of a clip: moments in which the body is elsewhere at once, where no cloth can follow. Keys without interpolation make
//! them, two keys at one time, poses that lie a frame and an arm's length apart.

use crate::body::animated_body::{AnimatedBody, BodyMotion, BodyPose};
use crate::body::clip::Clip;
use crate::body::rig::Rig;
use crate::body::root_motion::RootMotion;
use crate::body::skeleton::NodeTransform;
use crease_geometry::math::{Mat4, Vec3};

/// Distance of a point of the body that is no jump [m]: cloth follows it in one step.
const MIN_DISTANCE: f64 = 0.05;
/// Speed of a point of the body above which its motion is a jump [m/s]: no limb reaches it.
const MAX_SPEED: f64 = 20.0;
/// Time before a key at which the pose is that before it [s].
const JUST_BEFORE: f64 = 1e-9;
/// Distance of the skin from its joint at most [m], to find what may jump.
const SKIN_REACH: f64 = 0.5;
/// Change of the weight of a morph target that may be a jump [-].
const MIN_WEIGHT_CHANGE: f64 = 0.05;

/// A span of a clip in which the body jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct ClipJump {
    /// Beginning in the clip [s].
    pub start: f64,
    /// End in the clip [s].
    pub end: f64,
    /// Distance of the point that moves farthest [m].
    pub distance: f64,
    /// The joint that turns or moves most, and its turn [rad]; `None` for frames and morph targets.
    pub joint: Option<(usize, f64)>,
}

/// A pose on the way through a clip.
struct Sample {
    time: f64,
    pose: BodyPose,
    /// Per node: its transform to the scene.
    worlds: Vec<Mat4>,
}

impl AnimatedBody {
    /// Returns the jumps of a clip in order, with the motion of the root `in_place` removed if one is given.
    pub fn clip_jumps(&self, clip: usize, in_place: Option<&RootMotion>) -> Vec<ClipJump> {
        let spans = match self.motion() {
            BodyMotion::Still => Vec::new(),
            BodyMotion::Sequence(sequence) => {
                let at = |frame: usize| frame as f64 / sequence.rate;
                let pairs = sequence.frames.windows(2).enumerate();
                let jump = |(k, pair): (usize, &[Vec<Vec3>])| {
                    let distance = largest_distance(&pair[0], &pair[1]);
                    ClipJump { start: at(k), end: at(k + 1), distance, joint: None }
                };
                pairs.map(jump).filter(ClipJump::is_jump).collect()
            }
            BodyMotion::Rig(rig) => {
                rig.clips.get(clip).map_or_else(Vec::new, |own| self.rig_jumps(rig, own, clip, in_place))
            }
        };
        joined(spans)
    }

    fn rig_jumps(&self, rig: &Rig, own: &Clip, clip: usize, in_place: Option<&RootMotion>) -> Vec<ClipJump> {
        let moves = rig.influencing_nodes();
        let sample = |time: f64| {
            let pose = self.clip_pose(clip, time, in_place);
            let worlds = pose.joints().map_or_else(Vec::new, |joints| rig.scene_transforms(joints));
            Sample { time, pose, worlds }
        };
        let mut jumps = Vec::new();
        let mut last: Option<Sample> = None;
        for time in sample_times(own) {
            let now = sample(time);
            if let Some(last) = last.as_ref().filter(|last| may_jump(last, &now, &moves)) {
                let [from, to] = [last, &now].map(|sample| self.points(&sample.pose));
                let distance = largest_distance(&from, &to);
                let joint = leading_joint(&last.pose, &now.pose);
                jumps.push(ClipJump { start: last.time, end: now.time, distance, joint });
            }
            last = Some(now);
        }
        jumps.retain(ClipJump::is_jump);
        jumps
    }
}

impl ClipJump {
    fn is_jump(&self) -> bool {
        self.distance > MIN_DISTANCE && self.distance > MAX_SPEED * (self.end - self.start)
    }
}

/// Times of the keys of `clip` and just before them.
fn sample_times(clip: &Clip) -> Vec<f64> {
    let mut keys: Vec<f64> = clip.channels.iter().flat_map(|channel| channel.times.iter().copied()).collect();
    keys.sort_by(f64::total_cmp);
    keys.dedup();
    let mut times = Vec::with_capacity(2 * keys.len());
    for key in keys {
        let before = key - JUST_BEFORE;
        if times.last().is_some_and(|last| *last < before) {
            times.push(before);
        }
        times.push(key);
    }
    times
}

/// Whether the body may jump between two poses, judged by the nodes that move it and the weights of its morph targets.
fn may_jump(from: &Sample, to: &Sample, moves: &[bool]) -> bool {
    let limit = MIN_DISTANCE.max(MAX_SPEED * (to.time - from.time));
    let reaches = |a: &Mat4, b: &Mat4| {
        let shift = (a.column(3) - b.column(3)).norm();
        let turn = (a.fixed_view::<3, 3>(0, 0) - b.fixed_view::<3, 3>(0, 0)).norm();
        let size = a.fixed_view::<3, 3>(0, 0).norm().max(f64::MIN_POSITIVE);
        shift + SKIN_REACH * turn / size * 3f64.sqrt() > limit
    };
    let by_nodes =
        from.worlds.iter().zip(&to.worlds).zip(moves).any(|((a, b), moves)| *moves && reaches(a, b));
    let by_weights = match (&from.pose, &to.pose) {
        (BodyPose::Morphed { weights: a, .. }, BodyPose::Morphed { weights: b, .. }) => {
            let pairs = a.iter().flatten().zip(b.iter().flatten());
            pairs.into_iter().any(|(a, b)| (a - b).abs() > MIN_WEIGHT_CHANGE)
        }
        _ => false,
    };
    by_nodes || by_weights
}

/// The node whose own transform changes most, and its turn [rad].
fn leading_joint(from: &BodyPose, to: &BodyPose) -> Option<(usize, f64)> {
    let changes = from.joints()?.iter().zip(to.joints()?).map(|(a, b)| match (a, b) {
        (
            NodeTransform::Trs { translation: t, rotation: r, scale: s },
            NodeTransform::Trs { translation, rotation, scale },
        ) => (r.angle_to(rotation), (t - translation).norm() + (s - scale).norm()),
        _ => (0.0, 0.0),
    });
    let changed = changes.enumerate().filter(|(_, (turn, shift))| *turn > 1e-6 || *shift > 1e-6);
    let most = changed.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    most.map(|(node, (turn, _))| (node, turn))
}

fn largest_distance(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Jumps of which one begins where another ends as one, with the joint of the larger one.
fn joined(jumps: Vec<ClipJump>) -> Vec<ClipJump> {
    let mut all: Vec<ClipJump> = Vec::new();
    for jump in jumps {
        match all.last_mut().filter(|last| jump.start <= last.end) {
            Some(last) => {
                let (start, distance) = (last.start, last.distance + jump.distance);
                let joint = if jump.distance > last.distance { jump.joint } else { last.joint };
                *last = ClipJump { start, distance, joint, ..jump };
            }
            None => all.push(jump),
        }
    }
    all
}
