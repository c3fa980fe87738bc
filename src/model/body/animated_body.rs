//! The body a garment is worn on: triangles whose points are known in every pose.
//!
//! It does not move, follows a skeleton, or goes through frames. Vertices that its file splits at texture borders are one
//! point, so that its surface is closed where it looks closed. `contact` handles contact with the cloth.

use crate::body::clip::Clip;
use crate::body::lookup::LookupError;
use crate::body::rig::Rig;
use crate::body::root_motion::RootMotion;
use crate::body::sequence::Sequence;
use crate::body::skeleton::{Pose, interpolate_pose};
use crate::error::Message;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::orientation::{enclosed_volume, oriented_sheets};
use crease_geometry::mesh::{INVALID, PointIndex, Topology, Welder};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Vertices nearer to each other than this are one point [m].
const WELD_DISTANCE: f64 = 1e-6;
/// Distance that a vertex moves in a pose if the pose moves the body [m].
const MIN_MOTION: f64 = 1e-4;
/// Travel of a sequence of frames above which it is told [m].
const MAX_FRAME_TRAVEL: f64 = 0.3;
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
    /// Pose of a skeleton whose clips change morph targets.
    Morphed {
        /// Pose of the skeleton.
        joints: Pose,
        /// Per piece of the rig: weights of its morph targets [-].
        weights: Vec<Vec<f64>>,
    },
    /// Time in a sequence [s].
    Time(f64),
}

impl BodyPose {
    /// Returns the pose of the skeleton, if there is one.
    pub fn joints(&self) -> Option<&Pose> {
        match self {
            Self::Joints(joints) | Self::Morphed { joints, .. } => Some(joints),
            Self::Still | Self::Time(_) => None,
        }
    }

    /// Returns the pose of the skeleton, if there is one.
    pub fn joints_mut(&mut self) -> Option<&mut Pose> {
        match self {
            Self::Joints(joints) | Self::Morphed { joints, .. } => Some(joints),
            Self::Still | Self::Time(_) => None,
        }
    }
}

/// Body that a garment is worn on.
///
/// ```
/// use crease_model::body::BodyMotion;
/// use crease_geometry::math::Vec3;
/// use crease_model::body::AnimatedBody;
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
    /// Points in the pose that it starts in [m].
    start: Vec<Vec3>,
    /// That pose, where it is not the one of the file.
    start_pose: Option<BodyPose>,
    /// Properties of the file that the user should know.
    notes: Vec<Message>,
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
    /// Coincident vertices are welded to points. Triangles that face inwards are turned ([`crease_geometry::mesh::orientation`]): cloth is
    /// kept on their outer side.
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
        let start: Vec<Vec3> = first_vertex.iter().map(|v| vertices[*v as usize]).collect();
        let mut triangles: Vec<[PointIndex; 3]> = triangles.iter().map(|t| t.map(corner)).collect();
        let (file, sha256) = (file.into(), sha256.into());
        let flipped = orient_outward(&start, &mut triangles);
        let notes = if flipped > 0 {
            let count = triangles.len();
            let note =
                format!("{file}: {flipped} of {count} triangles of the body faced inwards: turned outwards");
            vec![Message::from(note)]
        } else {
            Vec::new()
        };
        Self { file, sha256, motion, first_vertex, triangles, start, start_pose: None, notes }
    }

    /// Returns the body that starts in `pose`.
    pub fn starting_in(&self, pose: BodyPose) -> Self {
        Self { start: self.points(&pose), start_pose: Some(pose), ..self.clone() }
    }

    /// Returns what the user should know about the file, for the report.
    pub fn notes(&self) -> &[Message] {
        &self.notes
    }

    /// Removes the triangles of which most corners are vertices that `is_removed` names by their number; returns how many.
    pub(super) fn remove_triangles(&mut self, is_removed: impl Fn(usize) -> bool) -> usize {
        let before = self.triangles.len();
        let removed: Vec<bool> = self.first_vertex.iter().map(|v| is_removed(*v as usize)).collect();
        let is_gone = |p: &&PointIndex| removed.get(p.at()).copied().unwrap_or(false);
        self.triangles.retain(|t| t.iter().filter(is_gone).count() < 2);
        before - self.triangles.len()
    }

    /// Adds a note on the file.
    pub fn add_note(&mut self, note: impl Into<Message>) {
        self.notes.push(note.into());
    }

    /// Returns the points in the pose that it starts in, by default that of the file [m].
    pub fn rest_points(&self) -> &[Vec3] {
        &self.start
    }

    /// Returns the lowest and highest corner of the bounding box in the pose that it starts in [m]; `None` without points.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let corners = self.start.iter().map(|p| (*p, *p));
        corners.reduce(|(low, high), (p, _)| (low.inf(&p), high.sup(&p)))
    }

    /// Returns the triangles between points.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// Returns how it moves.
    pub(super) fn motion(&self) -> &BodyMotion {
        &self.motion
    }

    /// Returns the rig, if the body has one.
    pub fn rig(&self) -> Option<&Rig> {
        match &self.motion {
            BodyMotion::Rig(rig) => Some(rig),
            _ => None,
        }
    }

    /// Returns the pose that it starts in, by default that of the file.
    pub fn rest(&self) -> BodyPose {
        if let Some(pose) = &self.start_pose {
            return pose.clone();
        }
        match &self.motion {
            BodyMotion::Still => BodyPose::Still,
            BodyMotion::Rig(rig) => rig_pose(rig, rig.skeleton.rest(), None),
            BodyMotion::Sequence(_) => BodyPose::Time(0.0),
        }
    }

    /// Returns the points in a pose [m]; a pose of another kind of body gives those of the file.
    pub fn points(&self, pose: &BodyPose) -> Vec<Vec3> {
        let vertices = match (&self.motion, pose) {
            (BodyMotion::Rig(rig), BodyPose::Joints(pose)) => rig.vertices(pose, None),
            (BodyMotion::Rig(rig), BodyPose::Morphed { joints, weights }) => {
                rig.vertices(joints, Some(weights))
            }
            (BodyMotion::Sequence(sequence), BodyPose::Time(t)) => sequence.positions(*t),
            _ => return self.start.clone(),
        };
        let position = |v: &u32| vertices.get(*v as usize).copied();
        self.first_vertex.iter().zip(&self.start).map(|(v, start)| position(v).unwrap_or(*start)).collect()
    }

    /// Returns the joint called `wanted`, or numbered so (`joint#14`), that moves the body.
    pub fn find_joint(&self, wanted: &str) -> Result<usize, LookupError> {
        match &self.motion {
            BodyMotion::Rig(rig) => rig.find_joint(wanted),
            _ => Err(LookupError::nothing("joint", wanted)),
        }
    }

    /// Returns the number of the clip called `wanted`, or numbered so (`clip#2`); of several of that name the one that moves
    /// the body.
    pub fn find_clip(&self, wanted: &str) -> Result<usize, LookupError> {
        match &self.motion {
            BodyMotion::Rig(rig) => rig.find_clip(wanted),
            BodyMotion::Sequence(_) if wanted == FRAMES_CLIP => Ok(0),
            _ => Err(LookupError::nothing("clip", wanted)),
        }
    }

    /// Returns the duration of a clip [s]; 0 if there is no such clip.
    pub fn clip_length(&self, clip: usize) -> f64 {
        match &self.motion {
            BodyMotion::Still => 0.0,
            BodyMotion::Rig(rig) => rig.clips.get(clip).map_or(0.0, Clip::length),
            BodyMotion::Sequence(sequence) => sequence.length(),
        }
    }

    /// Returns what is doubtful about playing a clip: that it moves nothing, or that its frames carry the body away.
    pub fn clip_doubts(&self, clip: usize) -> Vec<String> {
        let mut doubts = Vec::new();
        match &self.motion {
            BodyMotion::Still => {}
            BodyMotion::Sequence(sequence) => {
                let travel = sequence.travel();
                if travel > MAX_FRAME_TRAVEL {
                    doubts.push(format!(
                        "its frames carry the body {travel:.2} m away, and the cloth follows by contact alone: export them in place"
                    ));
                }
            }
            BodyMotion::Rig(rig) => {
                let Some(own) = rig.clips.get(clip) else { return doubts };
                // A clip of one pose moves the body into it.
                let pose = || self.points(&self.clip_pose(clip, 0.0, None));
                let is_at_rest =
                    || pose().iter().zip(self.rest_points()).all(|(x, rest)| (x - rest).norm() < MIN_MOTION);
                if !rig.is_moved_by(own) && is_at_rest() {
                    doubts.push("it moves nothing of the body".to_owned());
                }
            }
        }
        doubts
    }

    /// Returns the root motion of a clip, if it does not stay in place.
    pub fn root_motion(&self, clip: usize) -> Option<RootMotion> {
        let rig = self.rig()?;
        rig.root_motion(rig.clips.get(clip)?)
    }

    /// Returns the pose at `t` [s] of a clip, with the motion of the root `in_place` removed if one is given.
    pub fn clip_pose(&self, clip: usize, t: f64, in_place: Option<&RootMotion>) -> BodyPose {
        match &self.motion {
            BodyMotion::Still => BodyPose::Still,
            BodyMotion::Sequence(_) => BodyPose::Time(t),
            BodyMotion::Rig(rig) => {
                let rest = rig.skeleton.rest();
                let clip = rig.clips.get(clip);
                let mut pose = clip.map_or(rest.clone(), |clip| clip.pose(&rest, t));
                if let Some(root) = in_place {
                    rig.remove_root_motion(root.node, &mut pose);
                }
                rig_pose(rig, pose, clip.map(|clip| (clip, t)))
            }
        }
    }

    /// Returns the name of a node, or its number if it has none.
    pub fn node_name(&self, node: usize) -> String {
        let name = self.rig().and_then(|rig| rig.skeleton.nodes().get(node)).map(|node| &node.name);
        name.filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("joint#{node}"))
    }
}

/// Returns the pose `joints` of `rig`, with the weights of morph targets that the clip has at its time [s], if any clip has some.
fn rig_pose(rig: &Rig, joints: Pose, at: Option<(&Clip, f64)>) -> BodyPose {
    match rig.clips.iter().any(|clip| rig.is_morphed_by(clip)) {
        true => BodyPose::Morphed { joints, weights: rig.morph_weights(at) },
        false => BodyPose::Joints(joints),
    }
}

/// Orients triangles outwards, sheet by sheet; returns the number of those flipped.
fn orient_outward(points: &[Vec3], triangles: &mut [[PointIndex; 3]]) -> usize {
    let has_corners = |[a, b, c]: &[PointIndex; 3]| {
        a != b && b != c && c != a && [a, b, c].iter().all(|p| p.at() < points.len())
    };
    let numbers: Vec<usize> = (0..triangles.len()).filter(|&t| has_corners(&triangles[t])).collect();
    let sound: Vec<[PointIndex; 3]> = numbers.iter().map(|&t| triangles[t]).collect();
    let mut flipped = 0;
    for sheet in oriented_sheets(&Topology::new(points.len(), &sound)) {
        for &t in &sheet.minority {
            triangles[numbers[t]].swap(1, 2);
        }
        let own: Vec<[PointIndex; 3]> = sheet.triangles.iter().map(|&t| triangles[numbers[t]]).collect();
        if enclosed_volume(points, &own).is_some_and(|volume| volume < 0.0) {
            sheet.triangles.iter().for_each(|&t| triangles[numbers[t]].swap(1, 2));
            flipped += sheet.triangles.len() - sheet.minority.len();
        } else {
            flipped += sheet.minority.len();
        }
    }
    flipped
}

/// Interpolates between two poses of a body at `fraction` (0..1); poses of different kinds give `to`.
pub fn interpolate_body_pose(from: &BodyPose, to: &BodyPose, fraction: f64) -> BodyPose {
    match (from, to) {
        (BodyPose::Joints(a), BodyPose::Joints(b)) => BodyPose::Joints(interpolate_pose(a, b, fraction)),
        (BodyPose::Morphed { joints: a, weights: from }, BodyPose::Morphed { joints: b, weights: to }) => {
            let between = |(a, b): (&f64, &f64)| a + fraction * (b - a);
            let weights = from.iter().zip(to).map(|(a, b)| a.iter().zip(b).map(between).collect()).collect();
            BodyPose::Morphed { joints: interpolate_pose(a, b, fraction), weights }
        }
        (BodyPose::Time(a), BodyPose::Time(b)) => BodyPose::Time(a + fraction * (b - a)),
        (_, other) => other.clone(),
    }
}
