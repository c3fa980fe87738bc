//! The skeleton of a file in USD: joints, their pose, and the weights of vertices.
//!
//! The pose of the file is both bind pose and rest pose, in the scene, so that the mesh stands as its file has it. Moving a
//! joint from there moves the cloth as in glTF where the file is in its bind pose.

use crate::gltf::read_rig;
use crate::usd::prim::{Prim, identifier, list, matrix};
use crate::usd::scene::ROOT;
use crease_geometry::math::Mat4;
use crease_model::body::rig::SkinBinding;
use crease_model::error::Result;
use crease_model::garment::{SourceAsset, SourcePiece};

/// Joints and weights.
pub(super) struct UsdSkeleton {
    /// Path of each joint: the names of its ancestors and its own.
    paths: Vec<String>,
    /// Per joint: transform to the scene.
    bind: Vec<Mat4>,
    /// Per joint: transform to its parent.
    rest: Vec<Mat4>,
    /// Per vertex of the worn pieces: joints and weights.
    influences: Vec<Vec<(usize, f64)>>,
}

impl UsdSkeleton {
    /// Reads the skeleton of the worn pieces; a single joint that does not move if there is none.
    pub(super) fn of_asset(asset: &SourceAsset) -> Result<Self> {
        let pieces: Vec<&SourcePiece> = asset.worn_pieces().collect();
        let count: usize = pieces.iter().map(|piece| piece.positions.len()).sum();
        let still = Self {
            paths: vec!["Still".to_owned()],
            bind: vec![Mat4::identity()],
            rest: vec![Mat4::identity()],
            influences: vec![vec![(0, 1.0)]; count],
        };
        let Some(rig) = read_rig(asset, &pieces)? else { return Ok(still) };
        let nodes = rig.skeleton.nodes();
        let mut joints: Vec<usize> = Vec::new();
        for piece in &rig.pieces {
            if let SkinBinding::Skin { joints: own, .. } = &piece.binding {
                joints.extend(own.iter().map(|joint| joint.node));
            }
        }
        if joints.is_empty() {
            return Ok(still);
        }
        // Ancestors are joints, too, so that transforms are those of the file.
        let mut all = vec![false; nodes.len()];
        for mut joint in joints {
            while let Some(slot) = all.get_mut(joint).filter(|slot| !**slot) {
                *slot = true;
                let Some(parent) = nodes[joint].parent else { break };
                joint = parent;
            }
        }
        let paths: Vec<String> = (0..nodes.len()).map(|node| path(&rig.skeleton, node)).collect();
        let mut order: Vec<usize> = (0..nodes.len()).filter(|&node| all[node]).collect();
        // A parent comes before its children: its path is shorter by one part.
        order.sort_by_key(|&node| (paths[node].matches('/').count(), node));
        let worlds: Vec<Mat4> =
            rig.skeleton.world_transforms(&rig.skeleton.rest()).iter().map(|w| rig.to_scene * w).collect();
        let to_parent = |&node: &usize| match nodes[node].parent.and_then(|p| worlds[p].try_inverse()) {
            Some(inverse) => inverse * worlds[node],
            None => worlds[node],
        };
        let place = |node: usize| order.iter().position(|&own| own == node).unwrap_or(0);
        let mut influences = Vec::with_capacity(count);
        for piece in &rig.pieces {
            match &piece.binding {
                SkinBinding::Skin { joints, influences: own } => {
                    let places: Vec<usize> = joints.iter().map(|joint| place(joint.node)).collect();
                    let of_vertex = |own: &Vec<crease_model::body::rig::JointInfluence>| {
                        let known =
                            own.iter().filter_map(|i| Some((*places.get(i.joint as usize)?, i.weight)));
                        known.collect()
                    };
                    influences.extend(own.iter().map(of_vertex));
                }
                SkinBinding::Node(_) | SkinBinding::Static => {
                    influences.extend(std::iter::repeat_n(vec![(0, 1.0)], piece.positions.len()));
                }
            }
        }
        Ok(Self {
            bind: order.iter().map(|&node| worlds[node]).collect(),
            rest: order.iter().map(to_parent).collect(),
            paths: order.into_iter().map(|node| paths[node].clone()).collect(),
            influences,
        })
    }

    /// Returns the properties that bind `count` vertices from `start` on.
    pub(super) fn binding(&self, start: usize, count: usize) -> [String; 2] {
        let rows = self.influences.get(start..start + count).unwrap_or(&[]);
        let width = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
        let each = |of: &dyn Fn(&(usize, f64)) -> String, none: &str| {
            let row = |row: &Vec<(usize, f64)>| -> Vec<String> {
                (0..width).map(|k| row.get(k).map_or_else(|| none.to_owned(), of)).collect()
            };
            list(rows.iter().flat_map(row))
        };
        let metadata = format!("(\n        elementSize = {width}\n        interpolation = \"vertex\"\n    )");
        [
            format!("int[] primvars:skel:jointIndices = {} {metadata}", each(&|i| i.0.to_string(), "0")),
            format!(
                "float[] primvars:skel:jointWeights = {} {metadata}",
                each(&|i| (i.1 as f32).to_string(), "0")
            ),
        ]
    }

    /// Makes the skeleton with the animation that shows the wear.
    pub(super) fn prim(&self) -> Prim {
        let joints = list(self.paths.iter().map(|path| format!("\"{path}\"")));
        let animation = Prim::new("SkelAnimation", "Pose")
            .line("uniform token[] blendShapes = [\"worn\"]".into())
            .line("float[] blendShapeWeights = [1]".into())
            // Blender's importer reads samples only.
            .line("float[] blendShapeWeights.timeSamples = {0: [1]}".into());
        Prim::new("Skeleton", "Skeleton")
            .api(&["SkelBindingAPI"])
            .line(format!("uniform matrix4d[] bindTransforms = {}", list(self.bind.iter().map(matrix))))
            .line(format!("uniform token[] joints = {joints}"))
            .line(format!("uniform matrix4d[] restTransforms = {}", list(self.rest.iter().map(matrix))))
            .line(format!("rel skel:animationSource = <{ROOT}/Skeleton/Pose>"))
            .child(animation)
    }
}

/// Returns the path of a node, with names that differ between all nodes.
fn path(skeleton: &crease_model::body::skeleton::Skeleton, node: usize) -> String {
    let nodes = skeleton.nodes();
    let (mut parts, mut at) = (Vec::new(), Some(node));
    while let Some(k) = at.filter(|_| parts.len() <= nodes.len()) {
        let name = identifier(&nodes[k].name, "joint");
        let taken = nodes.iter().take(k).any(|other| identifier(&other.name, "joint") == name);
        parts.push(if taken { format!("{name}_{k}") } else { name });
        at = nodes[k].parent;
    }
    parts.reverse();
    parts.join("/")
}
