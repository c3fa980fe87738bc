//! Meshes bound to a skeleton: linear blend skinning on the CPU.
//!
//! ```text
//! x = sum_j w_j (world_j * inverse_bind_j) (p + sum_m v_m target_m)
//! ```
//!
//! (glTF 2.0 specification, 3.7.3). The mesh's own node does not move it. Weights are divided by their sum, as the
//! specification asks readers to make them sum to one; a vertex without weights is bound to its first joint, as in
//! viewers. A piece without skin is bound to its node. Results are in the scene, in metres, y up.

use crate::body::clip::Clip;
use crate::body::skeleton::{NodeTransform, Skeleton};
use crease_geometry::math::{Mat4, Vec3};
use rayon::prelude::*;

/// Binding of the vertices of a piece.
#[derive(Debug, Clone, PartialEq)]
pub enum SkinBinding {
    /// Not bound: the piece does not move.
    Static,
    /// Bound to one node.
    Node(usize),
    /// Bound to the joints of a skin.
    Skin {
        /// Joints of the skin.
        joints: Vec<SkinJoint>,
        /// Per vertex: influences with weights that sum to one.
        influences: Vec<Vec<JointInfluence>>,
    },
}

/// Joint of a skin.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinJoint {
    /// Node of the skeleton.
    pub node: usize,
    /// Transform from the mesh's coordinates to the joint's in the bind pose.
    pub inverse_bind: Mat4,
}

/// Influence of a joint on a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointInfluence {
    /// Number of the joint in its skin.
    pub joint: u32,
    /// Weight [-].
    pub weight: f64,
}

/// Weights of morph targets.
#[derive(Debug, Clone, PartialEq)]
pub struct MorphWeights {
    /// Node whose animated weights apply.
    pub node: usize,
    /// Weights where no clip animates them [-]; missing ones are 0.
    pub rest: Vec<f64>,
}

/// Vertices with one binding.
#[derive(Debug, Clone, PartialEq)]
pub struct RigPiece {
    /// One per vertex, own coordinates, file units.
    pub positions: Vec<Vec3>,
    /// Binding.
    pub binding: SkinBinding,
    /// Weights of the morph targets, if there are any.
    pub morph: Option<MorphWeights>,
    /// Per morph target: one displacement per vertex.
    pub targets: Vec<Vec<Vec3>>,
}

/// Skeleton, the meshes bound to it, and its clips.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Node tree.
    pub skeleton: Skeleton,
    /// Meshes.
    pub pieces: Vec<RigPiece>,
    /// Animation clips.
    pub clips: Vec<Clip>,
    /// Transform from file units and axes to metres, y up.
    pub to_scene: Mat4,
}

impl Rig {
    /// Returns the weights of the morph targets of every piece: those of a clip at a time [s], else of the file.
    pub fn morph_weights(&self, at: Option<(&Clip, f64)>) -> Vec<Vec<f64>> {
        let of_piece = |piece: &RigPiece| {
            let Some(MorphWeights { node, rest }) = &piece.morph else { return Vec::new() };
            at.and_then(|(clip, t)| clip.weights(*node, t)).unwrap_or_else(|| rest.clone())
        };
        self.pieces.iter().map(of_piece).collect()
    }

    /// Returns the positions [m] of the vertices of all pieces in `pose`, piece after piece. With `morph`, these weights of
    /// the morph targets of every piece apply, else those of the file.
    pub fn vertices(&self, pose: &[NodeTransform], morph: Option<&[Vec<f64>]>) -> Vec<Vec3> {
        self.vertices_under(&self.scene_transforms(pose), morph)
    }

    /// Returns the transform of every node to the scene, in metres, y up.
    pub fn scene_transforms(&self, pose: &[NodeTransform]) -> Vec<Mat4> {
        self.skeleton.world_transforms(pose).iter().map(|world| self.to_scene * world).collect()
    }

    /// Returns the positions [m] of the vertices of all pieces where the nodes have the transforms `worlds` to the scene.
    pub fn vertices_under(&self, worlds: &[Mat4], morph: Option<&[Vec<f64>]>) -> Vec<Vec3> {
        let mut all = Vec::with_capacity(self.pieces.iter().map(|piece| piece.positions.len()).sum());
        for (k, piece) in self.pieces.iter().enumerate() {
            let own = piece.morphed(morph.and_then(|all| all.get(k)));
            all.extend(piece.skinned(&own, worlds, &self.to_scene));
        }
        all
    }
}

impl RigPiece {
    /// Returns the own coordinates with the morph targets applied.
    fn morphed(&self, weights: Option<&Vec<f64>>) -> Vec<Vec3> {
        let mut own = self.positions.clone();
        let Some(MorphWeights { rest, .. }) = &self.morph else { return own };
        for (target, weight) in self.targets.iter().zip(weights.unwrap_or(rest)) {
            if *weight != 0.0 {
                own.iter_mut().zip(target).for_each(|(p, d)| *p += d * *weight);
            }
        }
        own
    }

    /// Returns the positions in the scene of own coordinates; `worlds` are the transforms of all nodes.
    fn skinned(&self, own: &[Vec3], worlds: &[Mat4], to_scene: &Mat4) -> Vec<Vec3> {
        let transform = |m: &Mat4, p: &Vec3| (m * p.push(1.0)).xyz();
        match &self.binding {
            SkinBinding::Static => own.iter().map(|p| transform(to_scene, p)).collect(),
            SkinBinding::Node(node) => {
                let world = worlds.get(*node).unwrap_or(to_scene);
                own.iter().map(|p| transform(world, p)).collect()
            }
            SkinBinding::Skin { joints, influences } => {
                let matrix = |joint: &SkinJoint| {
                    worlds.get(joint.node).map_or(*to_scene, |world| world * joint.inverse_bind)
                };
                let matrices: Vec<Mat4> = joints.iter().map(matrix).collect();
                let blend = |(p, influences): (&Vec3, &Vec<JointInfluence>)| {
                    let term = |i: &JointInfluence| {
                        matrices.get(i.joint as usize).map(|m| transform(m, p) * i.weight)
                    };
                    influences.iter().filter_map(term).sum()
                };
                own.par_iter().zip(influences).map(blend).collect()
            }
        }
    }
}

/// Normalises influences so that their weights sum to one; without any weight the first joint gets all.
pub fn normalise_weights(mut influences: Vec<JointInfluence>) -> Vec<JointInfluence> {
    let sum: f64 = influences.iter().map(|i| i.weight).sum();
    if sum > 0.0 {
        influences.retain(|i| i.weight != 0.0);
        influences.iter_mut().for_each(|i| i.weight /= sum);
    } else {
        influences.truncate(1);
        influences.iter_mut().for_each(|i| i.weight = 1.0);
    }
    influences
}

#[cfg(test)]
mod tests {
    use super::super::skeleton::SkeletonNode;
    use super::*;
    use nalgebra::UnitQuaternion;

    fn on(joint: u32, weight: f64) -> JointInfluence {
        JointInfluence { joint, weight }
    }

    /// Two joints one metre apart along x; the second bent by a right angle about z. By hand: a vertex at (2, 0, 0) that
    /// follows the second alone goes to (1, 1, 0); one at (1.5, 0, 0) with weights 0.1 and 0.3 (which stand for 1/4 and 3/4)
    /// to 1/4 (1.5, 0, 0) + 3/4 (1, 0.5, 0) = (1.125, 0.375, 0).
    #[test]
    fn two_joints_by_hand() {
        let at = |x: f64| NodeTransform::Trs {
            translation: Vec3::new(x, 0.0, 0.0),
            rotation: UnitQuaternion::identity(),
            scale: Vec3::repeat(1.0),
        };
        let node = |name: &str, parent, x| SkeletonNode { name: name.into(), parent, rest: at(x) };
        let skeleton = Skeleton::new(vec![node("upper", None, 0.0), node("lower", Some(0), 1.0)]);
        let joints = vec![
            SkinJoint { node: 0, inverse_bind: Mat4::identity() },
            SkinJoint { node: 1, inverse_bind: Mat4::new_translation(&Vec3::new(-1.0, 0.0, 0.0)) },
        ];
        let influences = vec![
            normalise_weights(vec![on(1, 0.5), on(0, 0.0)]),
            normalise_weights(vec![on(0, 0.1), on(1, 0.3)]),
        ];
        let piece = RigPiece {
            positions: vec![Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.5, 0.0, 0.0)],
            binding: SkinBinding::Skin { joints, influences },
            morph: None,
            targets: Vec::new(),
        };
        let rig = Rig { skeleton, pieces: vec![piece], clips: Vec::new(), to_scene: Mat4::identity() };
        let mut pose = rig.skeleton.rest();
        assert!((rig.vertices(&pose, None)[1] - Vec3::new(1.5, 0.0, 0.0)).norm() < 1e-15);
        pose[1] = pose[1].rotated(&Vec3::z_axis(), std::f64::consts::FRAC_PI_2);
        let x = rig.vertices(&pose, None);
        assert!((x[0] - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-15, "{}", x[0]);
        assert!((x[1] - Vec3::new(1.125, 0.375, 0.0)).norm() < 1e-15, "{}", x[1]);
    }

    #[test]
    fn a_vertex_without_weights_follows_its_first_joint() {
        assert_eq!(normalise_weights(vec![on(3, 0.0), on(1, 0.0)]), [on(3, 1.0)]);
    }
}
