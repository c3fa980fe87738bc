//! Root motion: the part of a clip that carries the whole body through the scene, as walking does.
//!
//! The root is the lowest node above all nodes that move vertices. Its motion relative to the pose of the file, without the
//! tilt, is a rotation about the vertical and a translation. Poses in place have it removed: seen from the root, the garment
//! has the same wear, and the cloth need not be carried by friction at the speed of a walk. What is lost are the forces of
//! inertia in a moving frame: a skirt does not swing out when the body turns.

use crate::body::clip::Clip;
use crate::body::rig::Rig;
use crate::body::skeleton::NodeTransform;
use crease_geometry::math::{Mat4, Vec3};
use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion};

/// Travel of the root from its position in the file that is removed [m]: less is swaying and breathing.
const MIN_TRAVEL_M: f64 = 0.3;
/// Turn of the root about the vertical that is removed [rad]: less is swinging of the hips.
const MIN_TURN: f64 = 1.0;
/// Samples of a clip per second.
const SAMPLE_RATE: f64 = 15.0;
/// Most samples of a clip.
const MAX_SAMPLES: f64 = 2000.0;

/// Root motion of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct RootMotion {
    /// Root.
    pub node: usize,
    /// Its largest distance from its position in the file [m].
    pub travel_m: f64,
    /// Its largest turn about the vertical from its direction in the file [rad], 0 to pi.
    pub turn: f64,
}

impl Rig {
    /// Returns the root motion of `clip`; `None` if the clip stays in place, or if the body has no root beside what the clip
    /// moves.
    pub fn root_motion(&self, clip: &Clip) -> Option<RootMotion> {
        let node = self.root_node()?;
        let rest = self.skeleton.rest();
        let home = self.root_frame(node, &rest);
        let length = clip.length();
        let count = (length * SAMPLE_RATE).clamp(1.0, MAX_SAMPLES).ceil();
        let mut motion = RootMotion { node, travel_m: 0.0, turn: 0.0 };
        for k in 0..=count as u32 {
            let pose = clip.pose(&rest, length * f64::from(k) / count);
            let shift = Shift::between(&home, &self.root_frame(node, &pose));
            motion.travel_m = motion.travel_m.max(shift.travel);
            motion.turn = motion.turn.max(shift.rotation.angle());
        }
        (motion.travel_m > MIN_TRAVEL_M || motion.turn > MIN_TURN).then_some(motion)
    }

    /// Removes the motion of the root `node` from `pose`.
    pub fn remove_root_motion(&self, node: usize, pose: &mut [NodeTransform]) {
        let home = self.root_frame(node, &self.skeleton.rest());
        let now = self.root_frame(node, pose);
        let shift = Shift::between(&home, &now);
        let Some(to_file) = self.to_scene.try_inverse() else { return };
        let rotation = shift.rotation.inverse();
        let translation = home.position - rotation * now.position;
        let moved = Mat4::new_translation(&translation) * rotation.to_homogeneous();
        let in_file = to_file * moved * self.to_scene;
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(
            in_file.fixed_view::<3, 3>(0, 0).into_owned(),
        ));
        let top = self.skeleton.ancestors(node).last().unwrap_or(node);
        let Some(local) = pose.get_mut(top) else { return };
        *local = match *local {
            NodeTransform::Trs { translation, rotation, scale } => NodeTransform::Trs {
                translation: (in_file * translation.push(1.0)).xyz(),
                rotation: turn * rotation,
                scale,
            },
            NodeTransform::Matrix(matrix) => NodeTransform::Matrix(in_file * matrix),
        };
    }

    /// Returns the lowest node above all nodes that move vertices; `None` if there is none, or if it is the only one that
    /// moves vertices: its motion is all that the body has.
    fn root_node(&self) -> Option<usize> {
        let direct = self.influencing_nodes();
        let mut moving = (0..direct.len()).filter(|&node| direct[node]);
        let first = moving.next()?;
        let mut chain: Vec<usize> = std::iter::once(first).chain(self.skeleton.ancestors(first)).collect();
        let mut has_others = false;
        for node in moving {
            has_others = true;
            let above: Vec<usize> = std::iter::once(node).chain(self.skeleton.ancestors(node)).collect();
            chain.retain(|up| above.contains(up));
        }
        chain.first().copied().filter(|_| has_others)
    }

    fn root_frame(&self, node: usize, pose: &[NodeTransform]) -> RootFrame {
        let worlds = self.skeleton.world_transforms(pose);
        let world = worlds.get(node).map_or(self.to_scene, |world| self.to_scene * world);
        let linear = world.fixed_view::<3, 3>(0, 0).into_owned();
        RootFrame {
            position: world.column(3).xyz(),
            rotation: UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&linear)),
        }
    }
}

/// Position [m] and rotation of the root in the scene.
struct RootFrame {
    position: Vec3,
    rotation: UnitQuaternion<f64>,
}

/// Motion of the root from the pose of the file, without the tilt.
struct Shift {
    /// Distance [m].
    travel: f64,
    /// Rotation about the vertical.
    rotation: UnitQuaternion<f64>,
}

impl Shift {
    fn between(home: &RootFrame, now: &RootFrame) -> Self {
        let turn = now.rotation * home.rotation.inverse();
        // Swing-twist decomposition: the twist about an axis keeps the part of the vector along it.
        let twist = Quaternion::new(turn.w, 0.0, turn.j, 0.0);
        let rotation =
            if twist.norm() > 1e-6 { Unit::new_normalize(twist) } else { UnitQuaternion::identity() };
        Self { travel: (now.position - home.position).norm(), rotation }
    }
}
