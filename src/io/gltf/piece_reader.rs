//! Reads the pieces of a glTF document: every primitive that the scene shows, with placement, joints and names.

use crate::error_list::ErrorList;
use crate::gltf::accessor::Accessors;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::morph::default_weights;
use crate::gltf::names::{DRACO_CURE, DRACO_EXTENSION, INSTANCING_EXTENSION};
use crate::gltf::primitive::{MaskChannel, MeshData, PrimitiveData, read_primitive};
use crate::gltf::scene::SceneNodes;
use crate::gltf::skin::skinned_vertices;
use crate::pieces::{DamagedPiece, MASK_SETTINGS, NamedPiece, ReadPieces};
use crate::tuning::TUNING;
use crease_geometry::math::{Mat3, Mat4};
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{ImportDiagnostic, Placement, Severity, SourceJoint, SourcePiece};
use rustc_hash::FxHashSet;

/// Reader of the pieces of one document.
pub(super) struct PieceReader<'a> {
    root: Cursor<'a>,
    accessors: Accessors<'a>,
    scene: SceneNodes,
    to_scene: Mat4,
    masks: [Option<MaskChannel>; 2],
    errors: ErrorList,
    read: ReadPieces,
    /// Per mesh: names of the nodes that show it.
    node_names: Vec<Vec<&'a str>>,
    /// Vertices and triangles that may still be read.
    elements_left: usize,
}

impl<'a> PieceReader<'a> {
    /// Creates a reader; `errors` are those found so far, `to_scene` is the transform from file units and axes.
    pub(super) fn new(
        root: &Cursor<'a>,
        accessors: Accessors<'a>,
        scene: SceneNodes,
        to_scene: Mat4,
        errors: ErrorList,
    ) -> Self {
        Self {
            elements_left: accessors.byte_count().max(TUNING.min_element_budget),
            node_names: vec![Vec::new(); root.length("meshes")],
            accessors,
            root: root.clone(),
            scene,
            to_scene,
            masks: [None, None],
            errors,
            read: ReadPieces {
                pieces: Vec::new(),
                damaged: Vec::new(),
                document: None,
                obj: None,
                frame: None,
                diagnostics: Vec::new(),
            },
        }
    }

    /// Reads all pieces, with the masks of memory and of sewing of attributes where they are given. Fails with all errors of the file.
    pub(super) fn read(mut self, masks: [Option<MaskChannel>; 2]) -> Result<ReadPieces> {
        self.masks = masks;
        self.read_scene();
        self.check_masks();
        self.errors.finish()?;
        Ok(self.read)
    }

    fn read_scene(&mut self) {
        let nodes = self.root.entries("nodes");
        // All meshes are read from a file whose scene shows none.
        let any_shown =
            nodes.iter().zip(&self.scene.shown).any(|(node, shown)| *shown && node.member("mesh").exists());
        let mut first_node: Vec<Option<usize>> = vec![None; self.root.length("meshes")];
        for (number, node) in nodes.iter().enumerate() {
            let Some(Some(mesh)) = self.errors.take(node.index("mesh")) else { continue };
            let Some(first) = first_node.get_mut(mesh) else {
                self.errors.push(
                    node.path(),
                    format!("meshes[{mesh}] is not in the file"),
                    "export it again",
                );
                continue;
            };
            if any_shown && !self.scene.shown.get(number).copied().unwrap_or(false) {
                self.note(node.path(), "its mesh is not in the default scene: not read");
                continue;
            }
            if let (Some(names), Some(name)) = (self.node_names.get_mut(mesh), node.text("name")) {
                names.push(name);
            }
            match first {
                Some(first) => {
                    let message = format!(
                        "meshes[{mesh}] is shown by too many nodes: worn through nodes[{first}] only"
                    );
                    self.note(node.path(), message);
                }
                None => *first = Some(number),
            }
        }
        let mut shown: Vec<(Option<usize>, usize)> =
            first_node.iter().enumerate().filter_map(|(mesh, node)| Some((Some((*node)?), mesh))).collect();
        shown.sort_unstable();
        if nodes.is_empty() {
            shown = (0..first_node.len()).map(|mesh| (None, mesh)).collect();
        }
        for (node, mesh) in shown {
            self.read_mesh(node, mesh);
        }
    }

    fn read_mesh(&mut self, node: Option<usize>, mesh: usize) {
        let cursor = self.root.entry("meshes", mesh);
        let node_cursor = node.map(|node| self.root.entry("nodes", node));
        if node_cursor
            .as_ref()
            .is_some_and(|node| node.member("extensions").member(INSTANCING_EXTENSION).exists())
        {
            self.note(cursor.path(), "it is drawn many times (EXT_mesh_gpu_instancing): worn once");
        }
        let weights = default_weights(&self.root, mesh, node);
        if weights.iter().any(|weight| *weight != 0.0) {
            self.note(cursor.path(), "morph targets are on in the file: the shape that they make is worn");
        }
        for number in 0..cursor.length("primitives") {
            let primitive = cursor.entry("primitives", number);
            let result = self.read_piece(node, mesh, number, &primitive, &weights);
            match result {
                Ok(piece) => self.read.pieces.extend(piece),
                Err(Error::Input(errors)) => {
                    let names = self.names(node, mesh, &primitive);
                    self.read.damaged.push(DamagedPiece { names, errors });
                }
                Err(other) => self.errors.push(primitive.path(), other.to_string(), ""),
            }
        }
    }

    fn read_piece(
        &mut self,
        node: Option<usize>,
        mesh: usize,
        number: usize,
        primitive: &Cursor<'a>,
        weights: &[f64],
    ) -> Result<Option<NamedPiece>> {
        if self.elements_left == 0 {
            return Err(primitive.error("the file draws more than its data can hold"));
        }
        self.check_draco(primitive)?;
        let data = match read_primitive(&self.accessors, primitive, &self.masks, weights)? {
            PrimitiveData::Mesh(data) => data,
            PrimitiveData::Skipped(message) => {
                self.note(primitive.path(), format!("{message}: skipped"));
                return Ok(None);
            }
        };
        self.elements_left = self.elements_left.saturating_sub(data.positions.len() + data.triangles.len());
        self.note_repairs(primitive, &data);
        let (placement, joints) = self.placement(node, primitive, &data)?;
        let [mask, sewing_mask] = data.masks;
        let mut triangles = data.triangles;
        SourcePiece::orient_by_placement(&placement, &mut triangles);
        let names = self.names(node, mesh, primitive);
        let material =
            primitive.index("material")?.and_then(|m| self.root.entry("materials", m).text("name"));
        let piece = SourcePiece {
            name: names.first().cloned().unwrap_or_default(),
            material: material.map(str::to_owned),
            mesh,
            primitive: number,
            node,
            positions: data.positions,
            position_ids: None,
            normals: data.normals,
            uvs: data.uvs,
            mask,
            sewing_mask,
            triangles,
            placement,
            joints,
            worn: true,
        };
        Ok(Some(NamedPiece { piece, names }))
    }

    /// Rejects a Draco primitive without plain data: its accessors would read as zeros.
    fn check_draco(&self, primitive: &Cursor) -> Result<()> {
        if !primitive.member("extensions").member(DRACO_EXTENSION).exists() {
            return Ok(());
        }
        let position = primitive.member("attributes").index("POSITION")?;
        let has_plain_data =
            position.is_some_and(|index| self.root.entry("accessors", index).member("bufferView").exists());
        if has_plain_data {
            Ok(())
        } else {
            let message = format!("its data is compressed with {DRACO_EXTENSION}, which cannot be decoded");
            let help = format!("export it without {DRACO_EXTENSION}{DRACO_CURE}");
            Err(Error::input("glTF", primitive.path(), message, help))
        }
    }

    /// Returns the placement of a piece, and the joints that move it.
    fn placement(
        &mut self,
        node: Option<usize>,
        primitive: &Cursor,
        data: &MeshData,
    ) -> Result<(Placement, Vec<SourceJoint>)> {
        let Some(node) = node else { return Ok((Placement::Rigid(self.to_scene), Vec::new())) };
        let cursor = self.root.entry("nodes", node);
        if let Some(skin) = cursor.index("skin")? {
            let count = data.positions.len();
            let skinned = skinned_vertices(&self.root, &self.accessors, &self.scene, primitive, skin, count)?;
            if skinned.normalised_count > 0 {
                let message = format!(
                    "the skin weights of {} of {count} vertices do not sum to 1: divided by their sum",
                    skinned.normalised_count
                );
                self.note(primitive.path(), message);
            }
            let transforms: Vec<Mat4> = skinned.transforms.iter().map(|m| self.to_scene * m).collect();
            if let Some(vertex) = transforms.iter().position(is_degenerate) {
                let fault = skinned.joints.iter().find_map(|&joint| self.scene.fault_above(joint));
                return Err(
                    fault.unwrap_or_else(|| primitive.error(format!("its skin flattens vertex {vertex}")))
                );
            }
            let name =
                |node: usize| self.root.entry("nodes", node).text("name").unwrap_or_default().to_owned();
            let is_joint: FxHashSet<usize> = skinned.joints.iter().copied().collect();
            let above = |node: usize| {
                let ancestors = std::iter::successors(self.scene.parents[node], |up| self.scene.parents[*up]);
                ancestors.into_iter().find(|up| is_joint.contains(up))
            };
            let joint = |&node: &usize| {
                let world = self.to_scene * self.scene.worlds[node];
                let axis = |k: usize| {
                    let along = world.column(k).xyz().try_normalize(f64::MIN_POSITIVE);
                    along.unwrap_or_else(|| Mat3::identity().column(k).into())
                };
                SourceJoint {
                    name: name(node),
                    position: world.column(3).xyz(),
                    axes: Mat3::from_columns(&[axis(0), axis(1), axis(2)]),
                    parent: above(node).map(name),
                }
            };
            // Their nodes are in the file, as the vertices have been transformed by them.
            let joints = skinned.joints.iter().map(joint).collect();
            return Ok((Placement::Skinned(transforms), joints));
        }
        let transform = self.to_scene * self.scene.worlds.get(node).copied().unwrap_or_else(Mat4::identity);
        if is_degenerate(&transform) {
            let fault = self.scene.fault_above(node);
            return Err(fault
                .unwrap_or_else(|| cursor.error("its transform, with those above it, flattens the mesh")));
        }
        Ok((Placement::Rigid(transform), Vec::new()))
    }

    /// Returns the names of the nodes that show the mesh, of their ancestors, of the mesh and of the material; the most
    /// specific first.
    fn names(&self, node: Option<usize>, mesh: usize, primitive: &Cursor) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let mut add = |name: Option<&str>| {
            if let Some(name) =
                name.filter(|name| !name.is_empty() && !names.iter().any(|known| known == name))
            {
                names.push(name.to_owned());
            }
        };
        add(node.and_then(|node| self.root.entry("nodes", node).text("name")));
        add(self.root.entry("meshes", mesh).text("name"));
        for name in self.node_names.get(mesh).into_iter().flatten() {
            add(Some(name));
        }
        let material = primitive.index("material").ok().flatten();
        add(material.and_then(|material| self.root.entry("materials", material).text("name")));
        let parent = |node: usize| self.scene.parents.get(node).copied().flatten();
        let above = std::iter::successors(node.and_then(parent), |up| parent(*up));
        for node in above.take(TUNING.max_named_ancestors) {
            add(self.root.entry("nodes", node).text("name"));
        }
        add(Some(&format!("mesh {mesh}")));
        names
    }

    fn note_repairs(&mut self, primitive: &Cursor, data: &MeshData) {
        if data.leftover_corners > 0 {
            let message = format!("{} corners beyond the last whole triangle dropped", data.leftover_corners);
            self.add_diagnostic(Severity::Repaired, primitive.path(), message);
        }
        if data.replaced_count > 0 {
            let message = format!(
                "{} normals or texture coordinates that are not numbers replaced",
                data.replaced_count
            );
            self.add_diagnostic(Severity::Repaired, primitive.path(), message);
        }
    }

    /// Refuses masks that no piece has.
    fn check_masks(&mut self) {
        if !self.errors.is_empty() {
            return;
        }
        let pieces = &self.read.pieces;
        let is_found = [
            pieces.iter().any(|named| named.piece.mask.is_some()),
            pieces.iter().any(|named| named.piece.sewing_mask.is_some()),
        ];
        let channels = self.masks.iter().zip(is_found).zip(MASK_SETTINGS);
        let missing = channels.filter(|((_, is_found), _)| !is_found);
        let missing: Vec<(String, Setting)> = missing
            .filter_map(|((channel, _), setting)| Some((channel.as_ref()?.attribute.clone(), setting)))
            .collect();
        if missing.is_empty() {
            return;
        }
        let mut known: Vec<&str> = Vec::new();
        for mesh in self.root.entries("meshes") {
            for primitive in mesh.entries("primitives") {
                for key in primitive.member("attributes").keys() {
                    if !known.contains(&key) && known.len() < TUNING.max_listed_names {
                        known.push(key);
                    }
                }
            }
        }
        for (attribute, setting) in missing {
            let message = format!("no vertex attribute called \"{attribute}\"");
            let help = Message::from(setting) + format!(" takes one of: {}", known.join(", "));
            self.errors.push("", message, help);
        }
    }

    fn note(&mut self, location: impl Into<String>, message: impl Into<Message>) {
        self.add_diagnostic(Severity::Note, location, message);
    }

    fn add_diagnostic(
        &mut self,
        severity: Severity,
        location: impl Into<String>,
        message: impl Into<Message>,
    ) {
        self.read.diagnostics.push(ImportDiagnostic {
            severity,
            location: location.into(),
            message: message.into(),
        });
    }
}

/// Returns whether a transform has no inverse, so that wrinkles could not be transformed back to the file. Relative to
/// its size, as units scale all entries.
fn is_degenerate(transform: &Mat4) -> bool {
    let linear = transform.fixed_view::<3, 3>(0, 0).into_owned();
    let size = linear.norm();
    let volume = linear.determinant().abs();
    // A transform that is not finite counts as degenerate.
    let is_invertible = volume > TUNING.min_volume_fraction * size * size * size;
    !is_invertible
}
