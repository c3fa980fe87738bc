//! The body a garment is worn on, as a motion: triangles whose points are known for every posture.
//!
//! It stands still, follows a skeleton or goes through given frames. Vertices that its file splits at texture borders
//! are one point, so that its surface is closed where it looks closed. How the cloth meets it is `contact::Body`'s.

use crate::body::clip::Clip;
use crate::body::rig::Rig;
use crate::body::sequence::Sequence;
use crate::body::skeleton::{Pose, between};
use crate::math::Vec3;
use crate::mesh::{PointIndex, Welder};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Vertices nearer than this are one point [m].
const WELD_DISTANCE: f64 = 1e-6;
/// Name by which a sequence of frames is played.
pub const FRAMES_CLIP: &str = "frames";

/// What moves it.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyMotion {
    /// Nothing.
    Still,
    /// A skeleton with its skin.
    Rig(Box<Rig>),
    /// Given frames.
    Sequence(Sequence),
}

/// A posture of the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyPose {
    /// The only one it has.
    Still,
    /// Of a skeleton.
    Joints(Pose),
    /// Time in a sequence [s].
    Time(f64),
}

/// The body a garment is worn on.
#[derive(Clone, PartialEq)]
pub struct AnimatedBody {
    /// What its file is called, for messages.
    pub file: String,
    /// Hash of what it was made from.
    pub sha256: String,
    motion: BodyMotion,
    /// Per point: the first of its vertices.
    first_vertex: Vec<u32>,
    triangles: Vec<[PointIndex; 3]>,
    /// In the posture of the file [m].
    start: Vec<Vec3>,
}

/// A body and where it stands, as an action leaves it.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedBody {
    /// The body.
    pub body: Arc<AnimatedBody>,
    /// Its posture.
    pub pose: BodyPose,
    /// Its points in that posture [m].
    pub points: Arc<[Vec3]>,
}

impl PosedBody {
    /// `body` in `pose`.
    pub fn new(body: &Arc<AnimatedBody>, pose: BodyPose) -> Self {
        Self { points: body.points(&pose).into(), body: body.clone(), pose }
    }
}

impl fmt::Debug for AnimatedBody {
    /// Says which body it is, not all of its numbers.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "AnimatedBody({}, {} points, {})", self.file, self.start.len(), self.sha256)
    }
}

impl AnimatedBody {
    /// A body of `vertices` (as [`BodyMotion`] gives them in the posture of the file [m]) and `triangles` between them.
    /// Numbers are checked when the cloth meets it (`contact::Body::new`).
    pub fn new(
        file: impl Into<String>,
        sha256: impl Into<String>,
        motion: BodyMotion,
        vertices: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Self {
        let mut welder = Welder::new(vertices, WELD_DISTANCE);
        welder.join_open_edges(triangles);
        let (point_of, count) = welder.points();
        let mut first_vertex = vec![0u32; count];
        for (vertex, point) in point_of.iter().enumerate().rev() {
            first_vertex[point.at()] = vertex as u32;
        }
        let corner = |v: u32| point_of.get(v as usize).copied().unwrap_or(PointIndex(u32::MAX));
        let start = first_vertex.iter().map(|v| vertices[*v as usize]).collect();
        let triangles = triangles.iter().map(|t| t.map(corner)).collect();
        let (file, sha256) = (file.into(), sha256.into());
        Self { file, sha256, motion, first_vertex, triangles, start }
    }

    /// Points in the posture of the file [m].
    pub fn rest_points(&self) -> &[Vec3] {
        &self.start
    }

    /// Triangles between points.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// The rig, if it has one.
    pub fn rig(&self) -> Option<&Rig> {
        match &self.motion {
            BodyMotion::Rig(rig) => Some(rig),
            _ => None,
        }
    }

    /// The posture of the file.
    pub fn rest(&self) -> BodyPose {
        match &self.motion {
            BodyMotion::Still => BodyPose::Still,
            BodyMotion::Rig(rig) => BodyPose::Joints(rig.skeleton.rest()),
            BodyMotion::Sequence(_) => BodyPose::Time(0.0),
        }
    }

    /// Its points in a posture [m]. A posture of another kind of body leaves it where its file has it.
    pub fn points(&self, pose: &BodyPose) -> Vec<Vec3> {
        let vertices = match (&self.motion, pose) {
            (BodyMotion::Rig(rig), BodyPose::Joints(pose)) => rig.vertices(pose, None),
            (BodyMotion::Sequence(sequence), BodyPose::Time(t)) => sequence.at(*t),
            _ => return self.start.clone(),
        };
        let place = |v: &u32| vertices.get(*v as usize).copied();
        self.first_vertex.iter().zip(&self.start).map(|(v, start)| place(v).unwrap_or(*start)).collect()
    }

    /// How long the clip `name` is [s]; `None` if there is none.
    pub fn clip_length(&self, name: &str) -> Option<f64> {
        match &self.motion {
            BodyMotion::Still => None,
            BodyMotion::Rig(rig) => rig.clip(name).map(Clip::length),
            BodyMotion::Sequence(sequence) => (name == FRAMES_CLIP).then(|| sequence.length()),
        }
    }

    /// Posture at `t` [s] of the clip `name`.
    pub fn clip_pose(&self, name: &str, t: f64) -> Option<BodyPose> {
        match &self.motion {
            BodyMotion::Still => None,
            BodyMotion::Rig(rig) => Some(BodyPose::Joints(rig.clip(name)?.pose(&rig.skeleton.rest(), t))),
            BodyMotion::Sequence(_) => (name == FRAMES_CLIP).then_some(BodyPose::Time(t)),
        }
    }

    /// Names of the clips there are.
    pub fn clip_names(&self) -> Vec<String> {
        match &self.motion {
            BodyMotion::Still => Vec::new(),
            BodyMotion::Rig(rig) => rig.clips.iter().map(|clip| clip.name.clone()).collect(),
            BodyMotion::Sequence(_) => vec![FRAMES_CLIP.to_owned()],
        }
    }

    /// Names of its joints: nodes that some skin follows.
    pub fn joint_names(&self) -> Vec<String> {
        let Some(rig) = self.rig() else { return Vec::new() };
        let nodes = rig.skeleton.nodes();
        nodes.iter().map(|node| node.name.clone()).filter(|name| !name.is_empty()).collect()
    }
}

/// The posture `share` of the way from one to another.
pub fn interpolate_body_pose(from: &BodyPose, to: &BodyPose, share: f64) -> BodyPose {
    match (from, to) {
        (BodyPose::Joints(a), BodyPose::Joints(b)) => BodyPose::Joints(between(a, b, share)),
        (BodyPose::Time(a), BodyPose::Time(b)) => BodyPose::Time(a + share * (b - a)),
        (_, other) => other.clone(),
    }
}
