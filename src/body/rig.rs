//! Meshes that follow a skeleton: linear blend skinning on the CPU.
//!
//! ```text
//! x = sum_j w_j (world_j * inverse_bind_j) (p + sum_m v_m target_m)
//! ```
//!
//! (glTF 2.0 specification, 3.7.3). The mesh's own node does not move it. Weights are divided by their sum, as the
//! specification asks readers to make them sum to one; a vertex without any follows its first joint, as viewers have it.
//! A piece without skin follows its node. Everything comes out in the scene, in metres, y up.

use crate::body::clip::Clip;
use crate::body::skeleton::{NodeTransform, Skeleton};
use crate::math::{Mat4, Vec3};
use rayon::prelude::*;

/// What moves the vertices of a piece.
#[derive(Debug, Clone, PartialEq)]
pub enum SkinBinding {
    /// Nothing: the transform of the file.
    Nothing,
    /// One node.
    Node(usize),
    /// Joints of a skin.
    Skin {
        /// Per joint of the skin: its node and its inverse bind matrix.
        joints: Vec<(usize, Mat4)>,
        /// Per vertex: joints of the skin with weights that sum to one.
        influences: Vec<Vec<(u32, f64)>>,
    },
}

/// A run of vertices that is moved in one way.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// One per vertex, own coordinates, file units.
    pub positions: Vec<Vec3>,
    /// What it follows.
    pub follows: SkinBinding,
    /// The node whose morph weights count, and the weights of the file.
    pub morph: Option<(usize, Vec<f64>)>,
    /// Per morph target: one displacement per vertex.
    pub targets: Vec<Vec<Vec3>>,
}

/// A skeleton, what follows it, and how it can move.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The node tree.
    pub skeleton: Skeleton,
    /// What follows it.
    pub pieces: Vec<Piece>,
    /// How it can move.
    pub clips: Vec<Clip>,
    /// File units and axes to metres, y up.
    pub to_scene: Mat4,
}

impl Rig {
    /// Every vertex of every piece in `pose` [m], one after the other. With a clip and its time, morph targets move, too.
    pub fn vertices(&self, pose: &[NodeTransform], clip: Option<(&Clip, f64)>) -> Vec<Vec3> {
        let worlds: Vec<Mat4> =
            self.skeleton.worlds(pose).iter().map(|world| self.to_scene * world).collect();
        let mut all = Vec::with_capacity(self.pieces.iter().map(|piece| piece.positions.len()).sum());
        for piece in &self.pieces {
            let own = piece.morphed(clip);
            all.extend(piece.placed(&own, &worlds, &self.to_scene));
        }
        all
    }

    /// The clip called `name`.
    pub fn clip(&self, name: &str) -> Option<&Clip> {
        self.clips.iter().find(|clip| clip.name == name)
    }
}

impl Piece {
    /// Own coordinates with the morph targets of this time.
    fn morphed(&self, clip: Option<(&Clip, f64)>) -> Vec<Vec3> {
        let mut own = self.positions.clone();
        let Some((node, rest)) = &self.morph else { return own };
        let moved = clip.and_then(|(clip, t)| clip.weights(*node, t));
        for (target, weight) in self.targets.iter().zip(moved.as_ref().unwrap_or(rest)) {
            if *weight != 0.0 {
                own.iter_mut().zip(target).for_each(|(p, d)| *p += d * *weight);
            }
        }
        own
    }

    fn placed(&self, own: &[Vec3], worlds: &[Mat4], to_scene: &Mat4) -> Vec<Vec3> {
        let by = |m: &Mat4, p: &Vec3| (m * p.push(1.0)).xyz();
        match &self.follows {
            SkinBinding::Nothing => own.iter().map(|p| by(to_scene, p)).collect(),
            SkinBinding::Node(node) => {
                let world = worlds.get(*node).unwrap_or(to_scene);
                own.iter().map(|p| by(world, p)).collect()
            }
            SkinBinding::Skin { joints, influences } => {
                let matrix = |(node, inverse_bind): &(usize, Mat4)| {
                    worlds.get(*node).map_or(*to_scene, |world| world * inverse_bind)
                };
                let matrices: Vec<Mat4> = joints.iter().map(matrix).collect();
                let place = |(p, influences): (&Vec3, &Vec<(u32, f64)>)| {
                    let share = |(j, w): &(u32, f64)| matrices.get(*j as usize).map(|m| by(m, p) * *w);
                    influences.iter().filter_map(share).sum()
                };
                own.par_iter().zip(influences).map(place).collect()
            }
        }
    }
}

/// Influences with weights that sum to one.
pub fn normalised(mut influences: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
    let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
    if sum > 0.0 {
        influences.retain(|(_, weight)| *weight != 0.0);
        influences.iter_mut().for_each(|(_, weight)| *weight /= sum);
    } else {
        influences.truncate(1);
        influences.iter_mut().for_each(|(_, weight)| *weight = 1.0);
    }
    influences
}

#[cfg(test)]
mod tests {
    use super::super::skeleton::Node;
    use super::*;
    use nalgebra::UnitQuaternion;

    /// Two joints one metre apart along x; the second bent by a right angle about z. By hand: a vertex at (2, 0, 0) that
    /// follows the second alone goes to (1, 1, 0); one at (1.5, 0, 0) with weights 0.1 and 0.3 (which stand for 1/4 and 3/4)
    /// to 1/4 (1.5, 0, 0) + 3/4 (1, 0.5, 0) = (1.125, 0.375, 0).
    #[test]
    fn two_joints_by_hand() {
        let at = |x: f64| NodeTransform::Parts {
            translation: Vec3::new(x, 0.0, 0.0),
            rotation: UnitQuaternion::identity(),
            scale: Vec3::repeat(1.0),
        };
        let node = |name: &str, parent, x| Node { name: name.into(), parent, rest: at(x) };
        let skeleton = Skeleton::new(vec![node("upper", None, 0.0), node("lower", Some(0), 1.0)]);
        let joints = vec![(0, Mat4::identity()), (1, Mat4::new_translation(&Vec3::new(-1.0, 0.0, 0.0)))];
        let influences = vec![normalised(vec![(1, 0.5), (0, 0.0)]), normalised(vec![(0, 0.1), (1, 0.3)])];
        let piece = Piece {
            positions: vec![Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.5, 0.0, 0.0)],
            follows: SkinBinding::Skin { joints, influences },
            morph: None,
            targets: Vec::new(),
        };
        let rig = Rig { skeleton, pieces: vec![piece], clips: Vec::new(), to_scene: Mat4::identity() };
        let mut pose = rig.skeleton.rest();
        assert!((rig.vertices(&pose, None)[1] - Vec3::new(1.5, 0.0, 0.0)).norm() < 1e-15);
        pose[1] = pose[1].turned(&Vec3::z_axis(), std::f64::consts::FRAC_PI_2);
        let x = rig.vertices(&pose, None);
        assert!((x[0] - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-15, "{}", x[0]);
        assert!((x[1] - Vec3::new(1.125, 0.375, 0.0)).norm() < 1e-15, "{}", x[1]);
    }

    #[test]
    fn a_vertex_without_weights_follows_its_first_joint() {
        assert_eq!(normalised(vec![(3, 0.0), (1, 0.0)]), [(3, 1.0)]);
    }
}
