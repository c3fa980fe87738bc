//! Reads a document's skeleton, skins, morph targets and clips for a `body`.
//!
//! The reader of pieces (`read`) only needs positions in the file's pose. All data of motion are checked here in one pass:
//! joints, weights, keys. Clips animate translation, rotation and scale of nodes and the weights of morph targets; other
//! targets (`KHR_animation_pointer`) are ignored.

use crate::error_list::ErrorList;
use crate::gltf::accessor::Accessors;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::morph::default_weights;
use crate::gltf::scene::read_node_transform;
use crate::gltf::skin::{influence_sets, read_joints};

use crate::tuning::TUNING;
use crease_geometry::math::{Mat4, Vec3};
use crease_model::body::clip::{AnimatedProperty, Channel, Clip, Interpolation};
use crease_model::body::rig::{JointInfluence, MorphWeights, Rig, RigPiece, SkinBinding, normalise_weights};
use crease_model::body::skeleton::{NodeTransform, Skeleton, SkeletonNode};
use crease_model::error::Result;
use crease_model::garment::{SourceAsset, SourcePiece};

/// Reads the rig of `pieces` of `asset`; `None` if the asset is not glTF.
pub fn read_rig(asset: &SourceAsset, pieces: &[&SourcePiece]) -> Result<Option<Rig>> {
    let Some(document) = &asset.document else { return Ok(None) };
    let root = Cursor::root(&document.json);
    let accessors = Accessors::new(document);
    let mut reader = RigReader {
        numbers_left: accessors.byte_count().max(TUNING.min_number_budget),
        root,
        accessors,
        errors: ErrorList::new(&asset.file),
    };
    let skeleton = reader.skeleton();
    let pieces = pieces.iter().filter_map(|piece| reader.piece(piece)).collect();
    let clips = reader.clips(skeleton.nodes().len());
    reader.errors.finish()?;
    Ok(Some(Rig { skeleton, pieces, clips, to_scene: asset.up.to_scene(asset.unit_m) }))
}

struct RigReader<'a> {
    root: Cursor<'a>,
    accessors: Accessors<'a>,
    errors: ErrorList,
    numbers_left: usize,
}

impl RigReader<'_> {
    fn skeleton(&mut self) -> Skeleton {
        let cursors = self.root.entries("nodes");
        let mut parents = vec![None; cursors.len()];
        for (number, node) in cursors.iter().enumerate() {
            for child in self.errors.take(node.indices("children")).into_iter().flatten() {
                // The reader of pieces has checked that the nodes are a forest.
                if let Some(slot) = parents.get_mut(child) {
                    *slot = Some(number);
                }
            }
        }
        let mut nodes = Vec::with_capacity(cursors.len());
        for (node, parent) in cursors.iter().zip(parents) {
            // The reader of pieces has refused those that depend on a node without a transform.
            let rest = read_node_transform(node).unwrap_or(NodeTransform::Matrix(Mat4::zeros()));
            let name = node.text("name").unwrap_or_default().to_owned();
            nodes.push(SkeletonNode { name, parent, rest });
        }
        Skeleton::new(nodes)
    }

    fn piece(&mut self, piece: &SourcePiece) -> Option<RigPiece> {
        let mesh = self.root.entry("meshes", piece.mesh);
        let primitive = mesh.entry("primitives", piece.primitive);
        let binding = self.binding(piece, &primitive);
        let binding = self.errors.take(binding)?;
        let targets = self.targets(&primitive, piece.positions.len());
        let targets = self.errors.take(targets)?;
        let morph = piece
            .node
            .filter(|_| !targets.is_empty())
            .map(|node| MorphWeights { node, rest: default_weights(&self.root, piece.mesh, Some(node)) });
        // The piece has the shape of the default weights; a rig adds the targets itself.
        let mut positions = piece.positions.clone();
        for (target, weight) in targets.iter().zip(morph.iter().flat_map(|morph| &morph.rest)) {
            positions.iter_mut().zip(target).for_each(|(p, d)| *p -= d * *weight);
        }
        Some(RigPiece { positions, binding, morph, targets })
    }

    fn binding(&self, piece: &SourcePiece, primitive: &Cursor) -> Result<SkinBinding> {
        let Some(node) = piece.node else { return Ok(SkinBinding::Static) };
        let Some(skin) = self.root.entry("nodes", node).index("skin")? else {
            return Ok(SkinBinding::Node(node));
        };
        let joints = read_joints(&self.root, &self.accessors, primitive, skin)?;
        let count = piece.positions.len();
        let sets = influence_sets(&self.accessors, primitive, count)?;
        let mut influences = Vec::with_capacity(count);
        for vertex in 0..count {
            let mut own = Vec::new();
            for set in &sets {
                own.extend(
                    set.row(vertex).map(|(joint, weight)| JointInfluence { joint: joint as u32, weight }),
                );
            }
            let own = normalise_weights(own);
            let is_bad = |i: &&JointInfluence| i.joint as usize >= joints.len() || !i.weight.is_finite();
            if let Some(JointInfluence { joint, .. }) = own.iter().find(is_bad) {
                let message =
                    format!("vertex {vertex} follows joint {joint}, skins[{skin}] has {}", joints.len());
                return Err(primitive.error(message));
            }
            influences.push(own);
        }
        Ok(SkinBinding::Skin { joints, influences })
    }

    fn targets(&mut self, primitive: &Cursor, count: usize) -> Result<Vec<Vec<Vec3>>> {
        let mut targets = Vec::new();
        for target in primitive.entries("targets") {
            self.spend(3 * count, &target)?;
            targets.push(match target.index("POSITION")? {
                Some(index) => {
                    let table = self.accessors.table_of(index, 3, Some(count), target.path())?;
                    table.rows().map(Vec3::from_column_slice).collect()
                }
                None => vec![Vec3::zeros(); count],
            });
        }
        Ok(targets)
    }

    fn clips(&mut self, node_count: usize) -> Vec<Clip> {
        let mut clips = Vec::new();
        for (number, animation) in self.root.entries("animations").iter().enumerate() {
            let channels = animation.entries("channels");
            let read = channels.iter().map(|channel| self.channel(animation, channel, node_count));
            // A damaged clip is refused when it is asked for.
            let (channels, damage) = match read.collect::<Result<Vec<_>>>() {
                Ok(channels) => (channels.into_iter().flatten().collect(), None),
                Err(error) => (Vec::new(), Some(error.to_string())),
            };
            // Unnamed clips get the name that viewers list them by.
            let name = animation.text("name").map_or_else(|| format!("animation {number}"), str::to_owned);
            clips.push(Clip { name, channels, damage });
        }
        clips
    }

    fn channel(
        &mut self,
        animation: &Cursor,
        channel: &Cursor,
        node_count: usize,
    ) -> Result<Option<Channel>> {
        let target = channel.member("target");
        // Without a node an extension defines the target, which is not supported.
        let Some(node) = target.index("node")? else { return Ok(None) };
        if node >= node_count {
            return Err(target.error(format!("nodes[{node}] is not in the file")));
        }
        let property = match target.text("path") {
            Some("translation") => AnimatedProperty::Translation,
            Some("rotation") => AnimatedProperty::Rotation,
            Some("scale") => AnimatedProperty::Scale,
            Some("weights") => AnimatedProperty::Weights,
            _ => return Ok(None),
        };
        let number = channel.required_index("sampler")?;
        let sampler = animation.entry("samplers", number);
        if !sampler.exists() {
            return Err(channel.error(format!("samplers[{number}] is not in the animation")));
        }
        let interpolation = match sampler.text("interpolation") {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(other) => return Err(sampler.error(format!("interpolation \"{other}\" is unknown"))),
        };
        let (input, output) = (sampler.required_index("input")?, sampler.required_index("output")?);
        let keys = self.accessors.row_count(input, sampler.path())?;
        let rows = self.accessors.row_count(output, sampler.path())?;
        self.spend(keys.saturating_add(rows.saturating_mul(4)), &sampler)?;
        let times = self.accessors.table_of(input, 1, None, sampler.path())?.values;
        let values = self.accessors.table(output, sampler.path())?.values;
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let width = property.width().unwrap_or_else(|| values.len() / (per_key * times.len()).max(1));
        let channel = Channel { node, target: property, interpolation, times, values, width };
        if channel.is_valid() {
            return Ok(Some(channel));
        }
        let message = format!(
            "{} keys and {} numbers do not make a channel: times must not fall, and every key needs its value",
            channel.times.len(),
            channel.values.len()
        );
        Err(sampler.error(message))
    }

    fn spend(&mut self, numbers: usize, user: &Cursor) -> Result<()> {
        match self.numbers_left.checked_sub(numbers) {
            Some(left) => {
                self.numbers_left = left;
                Ok(())
            }
            None => Err(user.error("the file asks for more animation data than it can hold")),
        }
    }
}
