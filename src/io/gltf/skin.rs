//! A skinned mesh in the pose its file shows: per vertex the weighted sum of its joints' matrices,
//! sum_j w_j (world_j * inverse bind matrix_j) (glTF 2.0 specification, 3.7.3).
//!
//! The mesh's own node does not move it, says the specification. Weights are divided by their sum: files with sums
//! from 0.2 to 1 exist, and left alone their vertices fly to the origin. Plays no animation.

use crate::Result;
use crate::io::gltf::accessor::{Accessors, Table};
use crate::io::gltf::json_cursor::Cursor;
use crate::io::gltf::scene::Scene;
use crate::math::Mat4;

/// Weights whose sum is off one by more than this are reported; quantised ones are off by less.
const SUM_TOLERANCE: f64 = 0.01;

/// A vertex follows a joint that moves it by more than this share.
const FOLLOWED: f64 = 0.01;

/// Where a skin puts each vertex.
pub(super) struct SkinnedVertices {
    /// Nodes of the joints that some vertex follows, in the order of the skin.
    pub(super) joints: Vec<usize>,
    /// Per vertex: own coordinates to scene coordinates, in file units.
    pub(super) transforms: Vec<Mat4>,
    /// Vertices whose weights did not sum to one.
    pub(super) normalised_count: usize,
}

/// Places the vertices of `primitive` by skin `skin`.
pub(super) fn place_skinned(
    root: &Cursor,
    accessors: &Accessors,
    scene: &Scene,
    primitive: &Cursor,
    skin: usize,
    vertex_count: usize,
) -> Result<SkinnedVertices> {
    let (nodes, joints) = joint_matrices(root, accessors, scene, primitive, skin)?;
    let sets = influence_sets(accessors, primitive, vertex_count)?;
    let mut placed = SkinnedVertices {
        joints: Vec::new(),
        transforms: Vec::with_capacity(vertex_count),
        normalised_count: 0,
    };
    let mut followed = vec![false; joints.len()];
    for vertex in 0..vertex_count {
        let mut influences = Vec::with_capacity(4 * sets.len());
        for (numbers, weights) in &sets {
            let rows = numbers.row(vertex).unwrap_or(&[]).iter().zip(weights.row(vertex).unwrap_or(&[]));
            influences.extend(rows.map(|(&joint, &weight)| (joint as usize, weight)));
        }
        let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
        if !sum.is_finite() {
            return Err(primitive.fault(format!("the skin weights of vertex {vertex} are not finite")));
        }
        placed.normalised_count += usize::from((sum - 1.0).abs() > SUM_TOLERANCE);
        if sum <= 0.0 {
            // Without any weight the first joint takes the vertex, as viewers do.
            influences.truncate(1);
            influences.iter_mut().for_each(|(_, weight)| *weight = 1.0);
        }
        let sum = if sum > 0.0 { sum } else { 1.0 };
        let mut transform = Mat4::zeros();
        for (joint, weight) in influences.into_iter().filter(|(_, weight)| *weight != 0.0) {
            let Some(matrix) = joints.get(joint) else {
                return Err(primitive.fault(format!(
                    "vertex {vertex} follows joint {joint}, skins[{skin}] has {}",
                    joints.len()
                )));
            };
            transform += matrix * (weight / sum);
            followed[joint] |= weight / sum > FOLLOWED;
        }
        placed.transforms.push(transform);
    }
    placed.joints =
        nodes.into_iter().zip(followed).filter(|(_, followed)| *followed).map(|(n, _)| n).collect();
    Ok(placed)
}

/// Joints of skin `skin` with their inverse bind matrices.
pub(super) fn joints_of(
    root: &Cursor,
    accessors: &Accessors,
    primitive: &Cursor,
    skin: usize,
) -> Result<Vec<(usize, Mat4)>> {
    let skin = root.required_entry("skins", skin, primitive.path())?;
    let joints = skin.indices("joints")?;
    let inverse_binds = match skin.index("inverseBindMatrices")? {
        Some(index) => accessors.table_of(index, 16, None, skin.path())?.matrices(),
        None => vec![Mat4::identity(); joints.len()],
    };
    if inverse_binds.len() < joints.len() {
        return Err(skin.fault(format!(
            "{} inverse bind matrices for {} joints",
            inverse_binds.len(),
            joints.len()
        )));
    }
    Ok(joints.into_iter().zip(inverse_binds).collect())
}

/// Nodes of the joints of skin `skin`, and what each does to a vertex in bind pose.
fn joint_matrices(
    root: &Cursor,
    accessors: &Accessors,
    scene: &Scene,
    primitive: &Cursor,
    skin: usize,
) -> Result<(Vec<usize>, Vec<Mat4>)> {
    let joints = joints_of(root, accessors, primitive, skin)?;
    let skin = root.entry("skins", skin);
    let matrix = |(joint, inverse_bind): &(usize, Mat4)| match scene.worlds.get(*joint) {
        Some(world) => Ok(world * inverse_bind),
        None => Err(skin.fault(format!("its joint nodes[{joint}] is not in the file"))),
    };
    let matrices = joints.iter().map(matrix).collect::<Result<_>>()?;
    Ok((joints.into_iter().map(|(node, _)| node).collect(), matrices))
}

/// The pairs JOINTS_n, WEIGHTS_n for n = 0, 1, ...
pub(super) fn influence_sets(
    accessors: &Accessors,
    primitive: &Cursor,
    count: usize,
) -> Result<Vec<(Table, Table)>> {
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
                return Err(primitive.fault("its node has a skin, but it has no JOINTS_0 and WEIGHTS_0"));
            }
            _ => {
                return Err(
                    attributes.fault(format!("JOINTS_{number} and WEIGHTS_{number} must come together"))
                );
            }
        };
        let user = attributes.path();
        sets.push((
            accessors.table_of(joints, 4, Some(count), user)?,
            accessors.table_of(weights, 4, Some(count), user)?,
        ));
    }
}
