//! The node tree of a body and its poses: where every joint stands when each is turned by its own amount.
//!
//! A pose gives every node its own transform; its place in the scene is the product of those from the root down (glTF 2.0
//! specification, 3.5). A node given as a matrix keeps it: the specification lets no clip move such a node, and a script
//! that bends it turns what hangs below. Knows no mesh, no time and no file.

use crate::math::{Mat4, Vec3};
use nalgebra::{Quaternion, Unit, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Transform of a node in its parent's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "NodeTransformNumbers", from = "NodeTransformNumbers")]
pub enum NodeTransform {
    /// Scale first, then rotation, then translation [file units].
    Parts {
        /// [file units].
        translation: Vec3,
        /// Unit quaternion.
        rotation: UnitQuaternion<f64>,
        /// Per axis [-].
        scale: Vec3,
    },
    /// As it is.
    Matrix(Mat4),
}

/// A [`NodeTransform`] as plain numbers, bit for bit, for files.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum NodeTransformNumbers {
    /// Translation, rotation (x, y, z, w), scale.
    Parts([f64; 3], [f64; 4], [f64; 3]),
    /// Columns.
    Matrix([[f64; 4]; 4]),
}

impl From<NodeTransform> for NodeTransformNumbers {
    fn from(local: NodeTransform) -> Self {
        match local {
            NodeTransform::Parts { translation, rotation, scale } => {
                Self::Parts(translation.into(), rotation.coords.into(), scale.into())
            }
            NodeTransform::Matrix(matrix) => Self::Matrix(matrix.into()),
        }
    }
}

impl From<NodeTransformNumbers> for NodeTransform {
    fn from(numbers: NodeTransformNumbers) -> Self {
        match numbers {
            NodeTransformNumbers::Parts(translation, rotation, scale) => Self::Parts {
                translation: translation.into(),
                rotation: Unit::new_unchecked(Quaternion::from(nalgebra::Vector4::from(rotation))),
                scale: scale.into(),
            },
            NodeTransformNumbers::Matrix(matrix) => Self::Matrix(matrix.into()),
        }
    }
}

impl NodeTransform {
    /// As a matrix.
    pub fn matrix(&self) -> Mat4 {
        match self {
            Self::Parts { translation, rotation, scale } => {
                Mat4::new_translation(translation)
                    * rotation.to_homogeneous()
                    * Mat4::new_nonuniform_scaling(scale)
            }
            Self::Matrix(matrix) => *matrix,
        }
    }

    /// Turned by `angle` [rad] about `axis` in its own axes.
    pub fn turned(&self, axis: &Unit<Vec3>, angle: f64) -> Self {
        let turn = UnitQuaternion::from_axis_angle(axis, angle);
        match *self {
            Self::Parts { translation, rotation, scale } => {
                Self::Parts { translation, rotation: rotation * turn, scale }
            }
            Self::Matrix(matrix) => Self::Matrix(matrix * turn.to_homogeneous()),
        }
    }

    /// The way from here to `other`, of which `share` is done; turns take the short way.
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        match (*self, *other) {
            (
                Self::Parts { translation, rotation, scale },
                Self::Parts { translation: t, rotation: r, scale: s },
            ) => Self::Parts {
                translation: translation.lerp(&t, share),
                rotation: turn_towards(&rotation, &r, share),
                scale: scale.lerp(&s, share),
            },
            (_, other) => other,
        }
    }
}

/// Spherical interpolation by the short way round.
pub(super) fn turn_towards(
    from: &UnitQuaternion<f64>,
    to: &UnitQuaternion<f64>,
    share: f64,
) -> UnitQuaternion<f64> {
    let (a, mut b) = (from.quaternion().coords, to.quaternion().coords);
    let mut cosine = a.dot(&b);
    if cosine < 0.0 {
        (b, cosine) = (-b, -cosine);
    }
    // Nearly the same turn: the sine below would be rounding.
    let mixed = if cosine > 1.0 - 1e-12 {
        a.lerp(&b, share)
    } else {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        (a * ((1.0 - share) * angle).sin() + b * (share * angle).sin()) / angle.sin()
    };
    UnitQuaternion::try_new(Quaternion::from(mixed), 1e-12).unwrap_or(*to)
}

/// One node.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Its name; empty when it has none.
    pub name: String,
    /// The node above it; always one with a place in [`Skeleton::new`]'s order before it.
    pub parent: Option<usize>,
    /// In the pose of the file.
    pub rest: NodeTransform,
}

/// The node tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    nodes: Vec<Node>,
    /// Parents before children.
    order: Vec<usize>,
}

/// One transform per node.
pub type Pose = Vec<NodeTransform>;

impl Skeleton {
    /// Of `nodes`. Parents that are not there, or are below themselves, count as none.
    pub fn new(mut nodes: Vec<Node>) -> Self {
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

    /// The pose of the file.
    pub fn rest(&self) -> Pose {
        self.nodes.iter().map(|node| node.rest).collect()
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node called `name`, the first if there are several.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.nodes.iter().position(|node| node.name == name)
    }

    /// Per node: its coordinates to the scene's, in file units.
    pub fn worlds(&self, pose: &[NodeTransform]) -> Vec<Mat4> {
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

/// The pose `share` of the way from one to another.
pub fn between(from: &[NodeTransform], to: &[NodeTransform], share: f64) -> Pose {
    from.iter().zip(to).map(|(a, b)| a.towards(b, share)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn parts(translation: Vec3) -> NodeTransform {
        NodeTransform::Parts { translation, rotation: UnitQuaternion::identity(), scale: Vec3::repeat(1.0) }
    }

    fn arm() -> Skeleton {
        let node = |name: &str, parent, x: f64| Node {
            name: name.into(),
            parent,
            rest: parts(Vec3::new(x, 0.0, 0.0)),
        };
        // The child stands before its parent in the list.
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
        pose[1] = pose[1].turned(&Vec3::z_axis(), FRAC_PI_2);
        let wrist = arm.worlds(&pose)[0].column(3).xyz();
        assert!((wrist - Vec3::new(0.3, 0.26, 0.0)).norm() < 1e-15, "{wrist}");
        assert_eq!(arm.find("elbow"), Some(1));
    }

    #[test]
    fn turns_take_the_short_way() {
        let at = |angle: f64| UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle);
        let half = turn_towards(&at(3.0), &at(-3.0), 0.5);
        assert!(half.angle_to(&at(std::f64::consts::PI)) < 1e-12);
        assert!(turn_towards(&at(0.1), &at(0.1), 0.5).angle_to(&at(0.1)) < 1e-12);
    }

    #[test]
    fn a_circle_of_parents_is_cut() {
        let node = |parent| Node { name: String::new(), parent: Some(parent), rest: parts(Vec3::x()) };
        let worlds = Skeleton::new(vec![node(1), node(0), node(9)]);
        assert!(worlds.worlds(&worlds.rest()).iter().all(|m| m.iter().all(|x| x.is_finite())));
    }
}
