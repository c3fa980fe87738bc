//! The body a garment is worn on: triangles whose points are known in every pose.
//!
//! It does not move, follows a skeleton, or goes through frames. Vertices that its file splits at texture borders are one
//! point, so that its surface is closed where it looks closed. `contact` handles contact with the cloth.

use crate::body::clip::Clip;
use crate::body::rig::Rig;
use crate::body::sequence::Sequence;
use crate::body::skeleton::{Pose, interpolate_pose};
use crate::math::Vec3;
use crate::mesh::{INVALID, PointIndex, Welder};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Vertices nearer to each other than this are one point [m].
const WELD_DISTANCE: f64 = 1e-6;
/// Name of the only clip of a sequence of frames.
pub const FRAMES_CLIP: &str = "frames";

/// Motion of a body.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyMotion {
    /// None.
    Still,
    /// A skeleton with its skin.
    Rig(Box<Rig>),
    /// Frames.
    Sequence(Sequence),
}

/// Pose of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyPose {
    /// The only pose of a body that does not move.
    Still,
    /// Pose of a skeleton.
    Joints(Pose),
    /// Time in a sequence [s].
    Time(f64),
}

/// Body that a garment is worn on.
///
/// ```
/// use crease::body::BodyMotion;
/// use crease::{AnimatedBody, Vec3};
/// // A table top that does not move.
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]].map(Vec3::from);
/// let triangles = [[0, 3, 2], [0, 2, 1]];
/// let table = AnimatedBody::new("table", "", BodyMotion::Still, &corners, &triangles);
/// assert_eq!(table.points(&table.rest()), corners);
/// ```
#[derive(Clone, PartialEq)]
pub struct AnimatedBody {
    /// Name of its file, for messages.
    pub file: String,
    /// SHA-256 of its file, lower-case hex.
    pub sha256: String,
    motion: BodyMotion,
    /// Per point: its first vertex.
    first_vertex: Vec<u32>,
    triangles: Vec<[PointIndex; 3]>,
    /// Points in the pose of the file [m].
    start: Vec<Vec3>,
}

/// Body in a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedBody {
    /// Body.
    pub body: Arc<AnimatedBody>,
    /// Pose.
    pub pose: BodyPose,
    /// Points in that pose [m].
    pub points: Arc<[Vec3]>,
}

impl PosedBody {
    /// Poses `body`.
    pub fn new(body: &Arc<AnimatedBody>, pose: BodyPose) -> Self {
        Self { points: body.points(&pose).into(), body: body.clone(), pose }
    }
}

impl fmt::Debug for AnimatedBody {
    /// Writes file, size and hash, not all numbers.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "AnimatedBody({}, {} points, {})", self.file, self.start.len(), self.sha256)
    }
}

impl AnimatedBody {
    /// Creates a body of `vertices` \[m\] (in the pose of the file, as `motion` gives them) and `triangles` between them.
    /// Coincident vertices are welded to points.
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
        let corner = |v: u32| point_of.get(v as usize).copied().unwrap_or(PointIndex(INVALID));
        let start = first_vertex.iter().map(|v| vertices[*v as usize]).collect();
        let triangles = triangles.iter().map(|t| t.map(corner)).collect();
        let (file, sha256) = (file.into(), sha256.into());
        Self { file, sha256, motion, first_vertex, triangles, start }
    }

    /// Returns the points in the pose of the file [m].
    pub fn rest_points(&self) -> &[Vec3] {
        &self.start
    }

    /// Returns the triangles between points.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// Returns the rig, if the body has one.
    pub fn rig(&self) -> Option<&Rig> {
        match &self.motion {
            BodyMotion::Rig(rig) => Some(rig),
            _ => None,
        }
    }

    /// Returns the pose of the file.
    pub fn rest(&self) -> BodyPose {
        match &self.motion {
            BodyMotion::Still => BodyPose::Still,
            BodyMotion::Rig(rig) => BodyPose::Joints(rig.skeleton.rest()),
            BodyMotion::Sequence(_) => BodyPose::Time(0.0),
        }
    }

    /// Returns the points in a pose [m]; a pose of another kind of body gives those of the file.
    pub fn points(&self, pose: &BodyPose) -> Vec<Vec3> {
        let vertices = match (&self.motion, pose) {
            (BodyMotion::Rig(rig), BodyPose::Joints(pose)) => rig.vertices(pose, None),
            (BodyMotion::Sequence(sequence), BodyPose::Time(t)) => sequence.positions(*t),
            _ => return self.start.clone(),
        };
        let position = |v: &u32| vertices.get(*v as usize).copied();
        self.first_vertex.iter().zip(&self.start).map(|(v, start)| position(v).unwrap_or(*start)).collect()
    }

    /// Returns the duration of the clip `name` [s]; `None` if there is no such clip.
    pub fn clip_length(&self, name: &str) -> Option<f64> {
        match &self.motion {
            BodyMotion::Still => None,
            BodyMotion::Rig(rig) => rig.clip(name).map(Clip::length),
            BodyMotion::Sequence(sequence) => (name == FRAMES_CLIP).then(|| sequence.length()),
        }
    }

    /// Returns the pose at `t` [s] of the clip `name`; `None` if there is no such clip.
    pub fn clip_pose(&self, name: &str, t: f64) -> Option<BodyPose> {
        match &self.motion {
            BodyMotion::Still => None,
            BodyMotion::Rig(rig) => Some(BodyPose::Joints(rig.clip(name)?.pose(&rig.skeleton.rest(), t))),
            BodyMotion::Sequence(_) => (name == FRAMES_CLIP).then_some(BodyPose::Time(t)),
        }
    }

    /// Returns the names of the clips.
    pub fn clip_names(&self) -> Vec<String> {
        match &self.motion {
            BodyMotion::Still => Vec::new(),
            BodyMotion::Rig(rig) => rig.clips.iter().map(|clip| clip.name.clone()).collect(),
            BodyMotion::Sequence(_) => vec![FRAMES_CLIP.to_owned()],
        }
    }

    /// Returns the names of the named nodes.
    pub fn joint_names(&self) -> Vec<String> {
        let Some(rig) = self.rig() else { return Vec::new() };
        let nodes = rig.skeleton.nodes();
        nodes.iter().map(|node| node.name.clone()).filter(|name| !name.is_empty()).collect()
    }
}

/// Interpolates between two poses of a body at `fraction` (0..1); poses of different kinds give `to`.
pub fn interpolate_body_pose(from: &BodyPose, to: &BodyPose, fraction: f64) -> BodyPose {
    match (from, to) {
        (BodyPose::Joints(a), BodyPose::Joints(b)) => BodyPose::Joints(interpolate_pose(a, b, fraction)),
        (BodyPose::Time(a), BodyPose::Time(b)) => BodyPose::Time(a + fraction * (b - a)),
        (_, other) => other.clone(),
    }
}
