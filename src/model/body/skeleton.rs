//! Node tree of a body and its poses.
//!
//! A pose gives every node a local transform; its transform to the scene is the product of those from the root down (glTF
//! 2.0 specification, 3.5). A node given as a matrix keeps it: the specification lets no clip animate such a node, and a
//! script that bends it rotates its descendants. Knows no mesh, no time and no file.

use crease_geometry::math::{Mat4, Vec3};
use nalgebra::{Quaternion, Unit, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Transform of a node to its parent's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "NodeTransformNumbers", from = "NodeTransformNumbers")]
pub enum NodeTransform {
    /// Translation, rotation and scale; the scale is applied first, then the rotation.
    Trs {
        /// Translation [file units].
        translation: Vec3,
        /// Rotation.
        rotation: UnitQuaternion<f64>,
        /// Scale per axis [-].
        scale: Vec3,
    },
    /// Matrix, kept as it is.
    Matrix(Mat4),
}

/// [`NodeTransform`] as plain numbers, bit for bit, for files.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum NodeTransformNumbers {
    /// Translation, rotation (x, y, z, w), scale.
    Parts([f64; 3], [f64; 4], [f64; 3]),
    /// Columns.
    Matrix([[f64; 4]; 4]),
}

impl From<NodeTransform> for NodeTransformNumbers {
    fn from(transform: NodeTransform) -> Self {
        match transform {
            NodeTransform::Trs { translation, rotation, scale } => {
                Self::Parts(translation.into(), rotation.coords.into(), scale.into())
            }
            NodeTransform::Matrix(matrix) => Self::Matrix(matrix.into()),
        }
    }
}

impl From<NodeTransformNumbers> for NodeTransform {
    fn from(numbers: NodeTransformNumbers) -> Self {
        match numbers {
            NodeTransformNumbers::Parts(translation, rotation, scale) => Self::Trs {
                translation: translation.into(),
                rotation: Unit::new_unchecked(Quaternion::from(nalgebra::Vector4::from(rotation))),
                scale: scale.into(),
            },
            NodeTransformNumbers::Matrix(matrix) => Self::Matrix(matrix.into()),
        }
    }
}

impl NodeTransform {
    /// Returns the transform as a matrix.
    pub fn matrix(&self) -> Mat4 {
        match self {
            Self::Trs { translation, rotation, scale } => {
                Mat4::new_translation(translation)
                    * rotation.to_homogeneous()
                    * Mat4::new_nonuniform_scaling(scale)
            }
            Self::Matrix(matrix) => *matrix,
        }
    }

    /// Returns the transform rotated by `angle` [rad] about `axis` in its own axes.
    pub fn rotated(&self, axis: &Unit<Vec3>, angle: f64) -> Self {
        let rotate = UnitQuaternion::from_axis_angle(axis, angle);
        match *self {
            Self::Trs { translation, rotation, scale } => {
                Self::Trs { translation, rotation: rotation * rotate, scale }
            }
            Self::Matrix(matrix) => Self::Matrix(matrix * rotate.to_homogeneous()),
        }
    }

    /// Interpolates to `other` at `fraction` (0..1), rotations along the shorter arc; matrices are not interpolated.
    pub fn interpolate(&self, other: &Self, fraction: f64) -> Self {
        match (*self, *other) {
            (
                Self::Trs { translation, rotation, scale },
                Self::Trs { translation: t, rotation: r, scale: s },
            ) => Self::Trs {
                translation: translation.lerp(&t, fraction),
                rotation: slerp(&rotation, &r, fraction),
                scale: scale.lerp(&s, fraction),
            },
            (_, other) => other,
        }
    }
}

/// Interpolates rotations on the sphere along the shorter arc.
pub(super) fn slerp(
    from: &UnitQuaternion<f64>,
    to: &UnitQuaternion<f64>,
    fraction: f64,
) -> UnitQuaternion<f64> {
    let (a, mut b) = (from.quaternion().coords, to.quaternion().coords);
    let mut cosine = a.dot(&b);
    if cosine < 0.0 {
        (b, cosine) = (-b, -cosine);
    }
    // Nearly equal rotations: the sine below would be rounding error.
    let mixed = if cosine > 1.0 - 1e-12 {
        a.lerp(&b, fraction)
    } else {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        (a * ((1.0 - fraction) * angle).sin() + b * (fraction * angle).sin()) / angle.sin()
    };
    UnitQuaternion::try_new(Quaternion::from(mixed), 1e-12).unwrap_or(*to)
}

/// Node of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct SkeletonNode {
    /// Name; empty when it has none.
    pub name: String,
    /// Parent; `None` for a root.
    pub parent: Option<usize>,
    /// Transform in the pose of the file.
    pub rest: NodeTransform,
}

/// Node tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    nodes: Vec<SkeletonNode>,
    /// Node numbers, parents before children.
    order: Vec<usize>,
}

/// One transform per node.
pub type Pose = Vec<NodeTransform>;

impl Skeleton {
    /// Creates a skeleton. Parents that do not exist, or would close a cycle, count as none.
    pub fn new(mut nodes: Vec<SkeletonNode>) -> Self {
        let count = nodes.len();
        nodes.iter_mut().for_each(|node| node.parent = node.parent.filter(|p| *p < count));
        let mut order = Vec::with_capacity(count);
        let mut done = vec![false; count];
        for start in 0..count {
            let mut upward = Vec::new();
            let mut at = Some(start);
            while let Some(node) = at.filter(|node| !done[*node] && upward.len() <= count) {
                upward.push(node);
                at = nodes[node].parent;
            }
            if upward.len() > count {
                nodes[start].parent = None;
                upward = vec![start];
            }
            for node in upward.into_iter().rev().filter(|node| !std::mem::replace(&mut done[*node], true)) {
                order.push(node);
            }
        }
        Self { nodes, order }
    }

    /// Returns the pose of the file.
    pub fn rest(&self) -> Pose {
        self.nodes.iter().map(|node| node.rest).collect()
    }

    /// Returns the nodes.
    pub fn nodes(&self) -> &[SkeletonNode] {
        &self.nodes
    }

    /// Returns the ancestors of `node`, its parent first.
    pub fn ancestors(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let parent = |node: usize| self.nodes.get(node).and_then(|node| node.parent);
        std::iter::successors(parent(node), move |up| parent(*up))
    }

    /// Returns the transform of every node to the scene, in file units.
    pub fn world_transforms(&self, pose: &[NodeTransform]) -> Vec<Mat4> {
        let mut worlds = vec![Mat4::identity(); self.nodes.len()];
        for &node in &self.order {
            let own = pose.get(node).unwrap_or(&self.nodes[node].rest).matrix();
            worlds[node] = match self.nodes[node].parent {
                Some(parent) => worlds[parent] * own,
                None => own,
            };
        }
        worlds
    }
}

/// Interpolates between two poses at `fraction` (0..1).
pub fn interpolate_pose(from: &[NodeTransform], to: &[NodeTransform], fraction: f64) -> Pose {
    from.iter().zip(to).map(|(a, b)| a.interpolate(b, fraction)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn parts(translation: Vec3) -> NodeTransform {
        NodeTransform::Trs { translation, rotation: UnitQuaternion::identity(), scale: Vec3::repeat(1.0) }
    }

    fn arm() -> Skeleton {
        let node = |name: &str, parent, x: f64| SkeletonNode {
            name: name.into(),
            parent,
            rest: parts(Vec3::new(x, 0.0, 0.0)),
        };
        // The child comes before its parent in the list.
        Skeleton::new(vec![
            node("wrist", Some(1), 0.26),
            node("elbow", Some(2), 0.3),
            node("shoulder", None, 0.0),
        ])
    }

    #[test]
    fn a_bent_elbow_carries_the_wrist() {
        let arm = arm();
        let mut pose = arm.rest();
        pose[1] = pose[1].rotated(&Vec3::z_axis(), FRAC_PI_2);
        let wrist = arm.world_transforms(&pose)[0].column(3).xyz();
        assert!((wrist - Vec3::new(0.3, 0.26, 0.0)).norm() < 1e-15, "{wrist}");
        assert_eq!(arm.ancestors(0).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let at = |angle: f64| UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle);
        let half = slerp(&at(3.0), &at(-3.0), 0.5);
        assert!(half.angle_to(&at(std::f64::consts::PI)) < 1e-12);
        assert!(slerp(&at(0.1), &at(0.1), 0.5).angle_to(&at(0.1)) < 1e-12);
    }

    #[test]
    fn a_cycle_of_parents_is_cut() {
        let node =
            |parent| SkeletonNode { name: String::new(), parent: Some(parent), rest: parts(Vec3::x()) };
        let skeleton = Skeleton::new(vec![node(1), node(0), node(9)]);
        assert!(skeleton.world_transforms(&skeleton.rest()).iter().all(|m| m.iter().all(|x| x.is_finite())));
    }
}
