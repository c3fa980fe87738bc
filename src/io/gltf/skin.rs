//! Skinned meshes in the pose of the file: per vertex the weighted sum of its joints' matrices,
//! sum_j w_j (world_j * inverse bind matrix_j) (glTF 2.0 specification, 3.7.3).
//!
//! By the specification the mesh's own node does not move it. Weights are divided by their sum: files with sums from 0.2
//! to 1 exist, and their vertices would be drawn to the origin. Plays no animation.

use crate::gltf::accessor::{Accessors, Table};
use crate::gltf::json_cursor::Cursor;
use crate::gltf::scene::SceneNodes;
use crate::tuning::TUNING;
use crease_geometry::math::Mat4;
use crease_model::body::rig::SkinJoint;
use crease_model::error::Result;

/// Vertices of a primitive in the pose of its skin.
pub(super) struct SkinnedVertices {
    /// Nodes of the joints that move some vertex, in the order of the skin.
    pub(super) joints: Vec<usize>,
    /// Per vertex: transform from own to scene coordinates, in file units.
    pub(super) transforms: Vec<Mat4>,
    /// Number of vertices whose weights did not sum to one.
    pub(super) normalised_count: usize,
}

/// JOINTS_n and WEIGHTS_n of a primitive, four columns each.
pub(super) struct InfluenceSet {
    joints: Table,
    weights: Table,
}

impl InfluenceSet {
    /// Returns joint and weight of the four influences of `vertex`.
    pub(super) fn row(&self, vertex: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let [joints, weights] = [&self.joints, &self.weights].map(|table| table.row(vertex).unwrap_or(&[]));
        joints.iter().copied().zip(weights.iter().copied())
    }
}

/// Computes the transforms of the vertices of `primitive` with skin `skin`.
pub(super) fn skinned_vertices(
    root: &Cursor,
    accessors: &Accessors,
    scene: &SceneNodes,
    primitive: &Cursor,
    skin: usize,
    vertex_count: usize,
) -> Result<SkinnedVertices> {
    let (nodes, joints) = joint_matrices(root, accessors, scene, primitive, skin)?;
    let sets = influence_sets(accessors, primitive, vertex_count)?;
    let mut skinned = SkinnedVertices {
        joints: Vec::new(),
        transforms: Vec::with_capacity(vertex_count),
        normalised_count: 0,
    };
    let mut is_used = vec![false; joints.len()];
    for vertex in 0..vertex_count {
        let mut influences = Vec::with_capacity(4 * sets.len());
        for set in &sets {
            influences.extend(set.row(vertex).map(|(joint, weight)| (joint as usize, weight)));
        }
        let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
        if !sum.is_finite() {
            return Err(primitive.error(format!("the skin weights of vertex {vertex} are not finite")));
        }
        skinned.normalised_count += usize::from((sum - 1.0).abs() > TUNING.weight_sum_tol);
        if sum <= 0.0 {
            // Without any weight the vertex belongs to the first joint, as in viewers.
            influences.truncate(1);
            influences.iter_mut().for_each(|(_, weight)| *weight = 1.0);
        }
        let sum = if sum > 0.0 { sum } else { 1.0 };
        let mut transform = Mat4::zeros();
        for (joint, weight) in influences.into_iter().filter(|(_, weight)| *weight != 0.0) {
            let Some(matrix) = joints.get(joint) else {
                return Err(primitive.error(format!(
                    "vertex {vertex} follows joint {joint}, skins[{skin}] has {}",
                    joints.len()
                )));
            };
            transform += matrix * (weight / sum);
            is_used[joint] |= weight / sum > TUNING.min_joint_weight;
        }
        skinned.transforms.push(transform);
    }
    skinned.joints = nodes.into_iter().zip(is_used).filter(|(_, is_used)| *is_used).map(|(n, _)| n).collect();
    Ok(skinned)
}

/// Reads the joints of skin `skin`.
pub(super) fn read_joints(
    root: &Cursor,
    accessors: &Accessors,
    primitive: &Cursor,
    skin: usize,
) -> Result<Vec<SkinJoint>> {
    let skin = root.required_entry("skins", skin, primitive.path())?;
    let joints = skin.indices("joints")?;
    let inverse_binds = match skin.index("inverseBindMatrices")? {
        Some(index) => accessors.table_of(index, 16, None, skin.path())?.matrices(),
        None => vec![Mat4::identity(); joints.len()],
    };
    if inverse_binds.len() < joints.len() {
        return Err(skin.error(format!(
            "{} inverse bind matrices for {} joints",
            inverse_binds.len(),
            joints.len()
        )));
    }
    let joint = |(node, inverse_bind)| SkinJoint { node, inverse_bind };
    Ok(joints.into_iter().zip(inverse_binds).map(joint).collect())
}

/// Returns the nodes of the joints of skin `skin`, and the transform of each from own to scene coordinates.
fn joint_matrices(
    root: &Cursor,
    accessors: &Accessors,
    scene: &SceneNodes,
    primitive: &Cursor,
    skin: usize,
) -> Result<(Vec<usize>, Vec<Mat4>)> {
    let joints = read_joints(root, accessors, primitive, skin)?;
    let skin = root.entry("skins", skin);
    let matrix = |joint: &SkinJoint| match scene.worlds.get(joint.node) {
        Some(world) => Ok(world * joint.inverse_bind),
        None => Err(skin.error(format!("its joint nodes[{}] is not in the file", joint.node))),
    };
    let matrices = joints.iter().map(matrix).collect::<Result<_>>()?;
    Ok((joints.into_iter().map(|joint| joint.node).collect(), matrices))
}

/// Reads JOINTS_n and WEIGHTS_n for n = 0, 1, ...
pub(super) fn influence_sets(
    accessors: &Accessors,
    primitive: &Cursor,
    count: usize,
) -> Result<Vec<InfluenceSet>> {
    let attributes = primitive.member("attributes");
    let mut sets = Vec::new();
    loop {
        let number = sets.len();
        let joints = attributes.index(&format!("JOINTS_{number}"))?;
        let weights = attributes.index(&format!("WEIGHTS_{number}"))?;
        let (joints, weights) = match (joints, weights) {
            (Some(joints), Some(weights)) => (joints, weights),
            (None, None) if number > 0 => return Ok(sets),
            (None, None) => {
                return Err(primitive.error("its node has a skin, but it has no JOINTS_0 and WEIGHTS_0"));
            }
            _ => {
                return Err(
                    attributes.error(format!("JOINTS_{number} and WEIGHTS_{number} must come together"))
                );
            }
        };
        let user = attributes.path();
        sets.push(InfluenceSet {
            joints: accessors.table_of(joints, 4, Some(count), user)?,
            weights: accessors.table_of(weights, 4, Some(count), user)?,
        });
    }
}
