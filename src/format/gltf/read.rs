//! A glTF document's bytes to pieces: container, extensions, buffers, node tree, then every primitive a scene shows,
//! in the order of the file. Everything is read from the raw JSON, which is kept for export.
//!
//! A mesh that several nodes show is worn through the first of them: one mesh can keep only one set of wrinkles.
//! Skinned meshes stand in the pose of the file; morph targets are left alone. Plays no animation.

use super::accessor::Accessors;
use super::buffers::load_buffers;
use super::container::{is_glb, parse_json, split_glb};
use super::cursor::Cursor;
use super::primitive::{Drawn, MaskChannel, MeshData, read_primitive};
use super::scene::Scene;
use super::skin::place_skinned;
use crate::format::fault_list::FaultList;
use crate::format::read::{NamedPiece, ReadPieces};
use crate::format::{GltfDocument, Placement, SourcePiece};
use crate::garment::{Finding, Severity};
use crate::math::Mat4;
use crate::{Error, Result};

/// Beginnings of extensions that may be required without our knowing them: they change how surfaces look or what
/// happens to nodes, not where vertices are. Quantised attributes are read.
const HARMLESS_EXTENSIONS: [&str; 14] = [
    "KHR_mesh_quantization",
    "KHR_texture_",
    "KHR_materials_",
    "KHR_lights_",
    "KHR_animation_pointer",
    "KHR_node_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "MSFT_texture_",
    "MSFT_packing_",
    "AGI_",
    "VRMC_materials_",
];
const DRACO: &str = "KHR_draco_mesh_compression";
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The pieces of a glTF file. `resolve` fetches what it refers to.
pub(in crate::format) fn read_gltf(
    file: &str,
    bytes: &[u8],
    to_scene: &Mat4,
    mask: Option<&str>,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<ReadPieces> {
    let mut faults = FaultList::new(file);
    let split = if is_glb(bytes) { split_glb(bytes) } else { parse_json(bytes).map(|json| (json, None)) };
    let Some((json, binary)) = faults.take(split) else { return Err(failed(faults)) };
    let root = Cursor::root(&json);
    check_version(&root, &mut faults);
    check_extensions(&root, &mut faults);
    if !faults.is_empty() {
        return Err(failed(faults));
    }
    let buffers = load_buffers(&root, binary, resolve, &mut faults);
    if !faults.is_empty() {
        return Err(failed(faults));
    }
    let Some(scene) = faults.take(Scene::read(&root)) else { return Err(failed(faults)) };
    let mut reader = Reader {
        accessors: Accessors::of(&json, &buffers),
        root: root.clone(),
        scene,
        to_scene: *to_scene,
        mask: mask.map(MaskChannel::parse),
        faults,
        read: ReadPieces { pieces: Vec::new(), document: None, findings: Vec::new() },
    };
    reader.read_scene();
    reader.check_mask();
    let (faults, mut read) = (reader.faults, reader.read);
    faults.finish()?;
    read.document = Some(GltfDocument { json, buffers });
    Ok(read)
}

/// The error of a list that is known to hold a fault.
fn failed(faults: FaultList) -> Error {
    match faults.finish() {
        Err(error) => error,
        Ok(()) => Error::Input(Vec::new()),
    }
}

fn check_version(root: &Cursor, faults: &mut FaultList) {
    let asset = root.member("asset");
    let needed = asset.text("minVersion").or(asset.text("version"));
    match needed {
        Some("2.0") => {}
        Some(version) if version.starts_with("2.") && asset.text("minVersion").is_none() => {}
        Some(version) => {
            faults.push("asset", format!("glTF {version} cannot be read"), "export it as glTF 2.0")
        }
        None => faults.push("asset.version", "it is missing: this is not glTF 2.0", "export it as glTF 2.0"),
    }
}

fn check_extensions(root: &Cursor, faults: &mut FaultList) {
    for required in root.entries("extensionsRequired") {
        let Some(name) = required.as_text() else { continue };
        if !HARMLESS_EXTENSIONS.iter().any(|harmless| name.starts_with(harmless)) {
            faults.push(
                required.path(),
                format!("the file requires {name}, which cannot be decoded"),
                format!("export it without {name}"),
            );
        }
    }
}

struct Reader<'a> {
    root: Cursor<'a>,
    accessors: Accessors<'a>,
    scene: Scene,
    to_scene: Mat4,
    mask: Option<MaskChannel>,
    faults: FaultList,
    read: ReadPieces,
}

impl<'a> Reader<'a> {
    fn read_scene(&mut self) {
        let nodes = self.root.entries("nodes");
        // A file whose scene shows no mesh at all is taken as a shelf of meshes.
        let any_shown =
            nodes.iter().zip(&self.scene.shown).any(|(node, shown)| *shown && node.member("mesh").exists());
        let mut first_node: Vec<Option<usize>> = vec![None; self.root.length("meshes")];
        for (number, node) in nodes.iter().enumerate() {
            let Some(Some(mesh)) = self.faults.take(node.index("mesh")) else { continue };
            let Some(first) = first_node.get_mut(mesh) else {
                self.faults.push(
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
            match first {
                Some(first) => {
                    let what =
                        format!("meshes[{mesh}] is also shown by nodes[{first}], and worn through that one");
                    self.note(node.path(), what);
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
        if node_cursor.as_ref().is_some_and(|node| node.member("extensions").member(INSTANCING).exists()) {
            self.note(cursor.path(), "it is drawn many times (EXT_mesh_gpu_instancing): worn once");
        }
        let weighted = node_cursor.as_ref().filter(|node| node.member("weights").exists()).unwrap_or(&cursor);
        if weighted.any_nonzero("weights") {
            let place = weighted.path().to_owned();
            self.note(place, "morph targets are on by default: the base shape is worn, the targets are kept");
        }
        for number in 0..cursor.length("primitives") {
            let primitive = cursor.entry("primitives", number);
            let result = self.read_piece(node, mesh, number, &primitive);
            if let Some(Some(piece)) = self.faults.take(result) {
                self.read.pieces.push(piece);
            }
        }
    }

    fn read_piece(
        &mut self,
        node: Option<usize>,
        mesh: usize,
        number: usize,
        primitive: &Cursor<'a>,
    ) -> Result<Option<NamedPiece>> {
        self.check_draco(primitive)?;
        let data = match read_primitive(&self.accessors, primitive, self.mask.as_ref())? {
            Drawn::Mesh(data) => data,
            Drawn::Skipped(what) => {
                self.note(primitive.path(), format!("{what}: skipped"));
                return Ok(None);
            }
        };
        self.report(primitive, &data);
        let placement = self.place(node, primitive, &data)?;
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
            normals: data.normals,
            uvs: data.uvs,
            mask: data.mask,
            triangles: data.triangles,
            placement,
            worn: true,
        };
        Ok(Some(NamedPiece { piece, names }))
    }

    /// A Draco primitive may carry plain data as well; without, its accessors would read as zeros.
    fn check_draco(&self, primitive: &Cursor) -> Result<()> {
        if !primitive.member("extensions").member(DRACO).exists() {
            return Ok(());
        }
        let position = primitive.member("attributes").index("POSITION")?;
        let plain =
            position.is_some_and(|index| self.root.entry("accessors", index).member("bufferView").exists());
        if plain {
            Ok(())
        } else {
            Err(primitive.fault(format!("its data is compressed with {DRACO}, which cannot be decoded")))
        }
    }

    fn place(&mut self, node: Option<usize>, primitive: &Cursor, data: &MeshData) -> Result<Placement> {
        let Some(node) = node else { return Ok(Placement::Rigid(self.to_scene)) };
        let cursor = self.root.entry("nodes", node);
        if let Some(skin) = cursor.index("skin")? {
            let count = data.positions.len();
            let placed = place_skinned(&self.root, &self.accessors, &self.scene, primitive, skin, count)?;
            if placed.normalised_count > 0 {
                let what = format!(
                    "the skin weights of {} of {count} vertices do not sum to 1: divided by their sum",
                    placed.normalised_count
                );
                self.note(primitive.path(), what);
            }
            let transforms: Vec<Mat4> = placed.transforms.iter().map(|m| self.to_scene * m).collect();
            if let Some(vertex) = transforms.iter().position(flattens) {
                return Err(primitive.fault(format!("its skin squeezes vertex {vertex} to nothing")));
            }
            return Ok(Placement::Skinned(transforms));
        }
        let transform = self.to_scene * self.scene.worlds.get(node).copied().unwrap_or_else(Mat4::identity);
        if flattens(&transform) {
            return Err(cursor.fault("its transform, with those above it, squeezes the mesh flat"));
        }
        Ok(Placement::Rigid(transform))
    }

    /// Names of the nodes that show the mesh, of the nodes above, of the mesh and of the material; the best first.
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
        for other in self.root.entries("nodes") {
            if other.index("mesh").ok().flatten() == Some(mesh) {
                add(other.text("name"));
            }
        }
        let material = primitive.index("material").ok().flatten();
        add(material.and_then(|material| self.root.entry("materials", material).text("name")));
        let mut above = node.and_then(|node| self.scene.parents.get(node).copied().flatten());
        while let Some(parent) = above {
            add(self.root.entry("nodes", parent).text("name"));
            above = self.scene.parents.get(parent).copied().flatten();
        }
        add(Some(&format!("mesh {mesh}")));
        names
    }

    fn report(&mut self, primitive: &Cursor, data: &MeshData) {
        if data.leftover_corners > 0 {
            let what = format!("{} corners beyond the last whole triangle dropped", data.leftover_corners);
            self.find(Severity::Repaired, primitive.path(), what);
        }
        if data.mended_count > 0 {
            let what =
                format!("{} normals or texture coordinates that are not numbers replaced", data.mended_count);
            self.find(Severity::Repaired, primitive.path(), what);
        }
    }

    fn check_mask(&mut self) {
        let Some(mask) = &self.mask else { return };
        if !self.faults.is_empty() || self.read.pieces.iter().any(|named| named.piece.mask.is_some()) {
            return;
        }
        let mut known: Vec<&str> = Vec::new();
        for mesh in self.root.entries("meshes") {
            for primitive in mesh.entries("primitives") {
                for key in primitive.member("attributes").keys() {
                    if !known.contains(&key) && known.len() < 40 {
                        known.push(key);
                    }
                }
            }
        }
        let what = format!("no vertex attribute called \"{}\"", mask.attribute);
        self.faults.push("", what, format!("--mask takes one of: {}", known.join(", ")));
    }

    fn note(&mut self, place: impl Into<String>, what: impl Into<String>) {
        self.find(Severity::Note, place, what);
    }

    fn find(&mut self, severity: Severity, place: impl Into<String>, what: impl Into<String>) {
        self.read.findings.push(Finding { severity, place: place.into(), what: what.into() });
    }
}

/// Whether a transform has no inverse, so that wrinkles could not be brought back into the file. Relative to its own
/// size, as units make all entries small alike.
fn flattens(transform: &Mat4) -> bool {
    let linear = transform.fixed_view::<3, 3>(0, 0).into_owned();
    let size = linear.norm();
    let volume = linear.determinant().abs();
    // Anything that is not a number counts as flat.
    let full = volume > 1e-9 * size * size * size;
    !full
}
