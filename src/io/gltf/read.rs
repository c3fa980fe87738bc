//! A glTF document's bytes to pieces: container, extensions, buffers, node tree, then every primitive a scene shows,
//! in the order of the file. Everything is read from the raw JSON, which is kept for export.
//!
//! A mesh that several nodes show is worn through the first of them: one mesh can keep only one set of wrinkles.
//! Skinned meshes stand in the pose of the file; morph targets are left alone. Plays no animation.

use crate::garment::{GltfDocument, ImportDiagnostic, Placement, Severity, SourceJoint, SourcePiece};
use crate::io::diagnostics::DiagnosticList;
use crate::io::gltf::accessor::Accessors;
use crate::io::gltf::buffers::load_buffers;
use crate::io::gltf::container::{is_glb, parse_json, split_glb};
use crate::io::gltf::json_cursor::Cursor;
use crate::io::gltf::primitive::{Drawn, MaskChannel, MeshData, read_primitive};
use crate::io::gltf::scene::Scene;
use crate::io::gltf::skin::skinned_vertices;
use crate::io::read::{NamedPiece, ReadPieces};
use crate::math::{Mat3, Mat4};
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
/// Vertices and triangles granted to a file of any size; beyond, as many as its buffers have bytes. Primitives may
/// share accessors, and a short file could otherwise ask for the same million vertices a million times.
const FREE_ELEMENTS: usize = 4_000_000;
const DRACO: &str = "KHR_draco_mesh_compression";
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// The pieces of a glTF file. `resolve` fetches what it refers to.
pub(in crate::io) fn read_gltf(
    file: &str,
    bytes: &[u8],
    to_scene: &Mat4,
    mask: Option<&str>,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<ReadPieces> {
    let mut faults = DiagnosticList::new(file);
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
    let accessors = Accessors::of(&json, &buffers);
    let mut reader = Reader {
        elements_left: accessors.byte_count().max(FREE_ELEMENTS),
        node_names: vec![Vec::new(); root.length("meshes")],
        accessors,
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
fn failed(faults: DiagnosticList) -> Error {
    match faults.finish() {
        Err(error) => error,
        Ok(()) => Error::Input(Vec::new()),
    }
}

fn check_version(root: &Cursor, faults: &mut DiagnosticList) {
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

fn check_extensions(root: &Cursor, faults: &mut DiagnosticList) {
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
    faults: DiagnosticList,
    read: ReadPieces,
    /// Per mesh: names of the nodes that show it.
    node_names: Vec<Vec<&'a str>>,
    /// Vertices and triangles that may still be read.
    elements_left: usize,
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
            if let (Some(names), Some(name)) = (self.node_names.get_mut(mesh), node.text("name")) {
                names.push(name);
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
        if self.elements_left == 0 {
            return Err(primitive.fault("the file draws more than its data could hold"));
        }
        self.check_draco(primitive)?;
        let data = match read_primitive(&self.accessors, primitive, self.mask.as_ref())? {
            Drawn::Mesh(data) => data,
            Drawn::Skipped(what) => {
                self.note(primitive.path(), format!("{what}: skipped"));
                return Ok(None);
            }
        };
        self.elements_left = self.elements_left.saturating_sub(data.positions.len() + data.triangles.len());
        self.report(primitive, &data);
        let (placement, joints) = self.place(node, primitive, &data)?;
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
            joints,
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

    /// Where a piece stands, and the joints that move it.
    fn place(
        &mut self,
        node: Option<usize>,
        primitive: &Cursor,
        data: &MeshData,
    ) -> Result<(Placement, Vec<SourceJoint>)> {
        let Some(node) = node else { return Ok((Placement::Rigid(self.to_scene), Vec::new())) };
        let cursor = self.root.entry("nodes", node);
        if let Some(skin) = cursor.index("skin")? {
            let count = data.positions.len();
            let placed = skinned_vertices(&self.root, &self.accessors, &self.scene, primitive, skin, count)?;
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
            let name =
                |node: usize| self.root.entry("nodes", node).text("name").unwrap_or_default().to_owned();
            let above = |node: usize| {
                let ancestors = std::iter::successors(self.scene.parents[node], |up| self.scene.parents[*up]);
                ancestors.into_iter().find(|up| placed.joints.contains(up))
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
            // Their nodes are in the file: the vertices could not have been placed otherwise.
            let joints = placed.joints.iter().map(joint).collect();
            return Ok((Placement::Skinned(transforms), joints));
        }
        let transform = self.to_scene * self.scene.worlds.get(node).copied().unwrap_or_else(Mat4::identity);
        if flattens(&transform) {
            return Err(cursor.fault("its transform, with those above it, squeezes the mesh flat"));
        }
        Ok((Placement::Rigid(transform), Vec::new()))
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
        for name in self.node_names.get(mesh).into_iter().flatten() {
            add(Some(name));
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
        self.read.findings.push(ImportDiagnostic { severity, location: place.into(), message: what.into() });
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

#[cfg(test)]
mod tests {
    use crate::garment::{ImportDiagnostic, SourceAsset, UpAxis};
    use crate::io::gltf::join_glb;
    use crate::io::{ReadOptions, read_asset};
    use crate::math::{Vec2, Vec3};
    use serde_json::{Value, json};

    fn read_with(
        document: &Value,
        binary: &[u8],
        options: &ReadOptions,
    ) -> crate::Result<(SourceAsset, Vec<ImportDiagnostic>)> {
        read_asset("test.glb", &join_glb(document, binary), options, &mut |uri| {
            Err(crate::Error::input(uri, "", "asked for", ""))
        })
    }

    fn read(document: &Value, binary: &[u8]) -> (SourceAsset, Vec<ImportDiagnostic>) {
        read_with(document, binary, &ReadOptions::default()).unwrap()
    }

    fn message(document: &Value, binary: &[u8]) -> String {
        read_with(document, binary, &ReadOptions::default()).unwrap_err().to_string()
    }

    fn floats(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|x| x.to_le_bytes()).collect()
    }

    /// One triangle (0,0,0) (1,0,0) (0,1,0) under node "Cloth"; views: 0 its positions.
    fn triangle() -> (Value, Vec<u8>) {
        let binary = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let document = json!({
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "Cloth", "mesh": 0}],
            "meshes": [{"name": "Sheet", "primitives": [{"attributes": {"POSITION": 0}}]}],
            "buffers": [{"byteLength": 36}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        });
        (document, binary)
    }

    #[test]
    fn the_document_is_kept_as_it_is() {
        let (mut document, binary) = triangle();
        document["extensions"] = json!({"UNKNOWN_thing": {"z": 1, "a": [null, 0.1]}});
        let (asset, findings) = read(&document, &binary);
        let kept = asset.document.unwrap();
        assert_eq!(kept.json.to_string(), document.to_string());
        assert_eq!(kept.buffers, [binary]);
        assert!(findings.is_empty(), "{findings:?}");
        assert_eq!((asset.pieces[0].name.as_str(), asset.pieces[0].node), ("Cloth", Some(0)));
        assert_eq!(asset.sha256.len(), 64);
    }

    #[test]
    fn transforms_come_in_the_right_order() {
        let (mut document, binary) = triangle();
        document["nodes"] = json!([
            {"mesh": 0, "translation": [0, 0, 1], "scale": [2, 2, 2]},
            {"children": [0], "rotation": [0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2]}
        ]);
        document["scenes"] = json!([{"nodes": [1]}]);
        let (asset, _) = read(&document, &binary);
        // x is doubled, moved along z, then turned a quarter about z.
        let p = asset.pieces[0].scene_position(1).unwrap();
        assert!((p - Vec3::new(0.0, 2.0, 1.0)).norm() < 1e-12, "{p}");
        let options = ReadOptions { unit_m: Some(0.5), up: Some(UpAxis::Z), ..ReadOptions::default() };
        let (asset, _) = read_with(&document, &binary, &options).unwrap();
        let p = asset.pieces[0].scene_position(1).unwrap();
        assert!((p - Vec3::new(0.0, 0.5, -1.0)).norm() < 1e-12, "unit and axis come last: {p}");
    }

    #[test]
    fn quantised_interleaved_and_sparse_data_are_read() {
        // Per vertex: i16 x 3 position, padding, u16 x 2 normalised texture coordinates: stride 12.
        let mut binary = Vec::new();
        for (p, uv) in [([0i16, 0, 0], [0u16, 65535]), ([100, 0, 0], [32768, 0]), ([0, -50, 0], [0, 0])] {
            p.iter().for_each(|x| binary.extend(x.to_le_bytes()));
            binary.extend([0xEE; 2]);
            uv.iter().for_each(|x| binary.extend(x.to_le_bytes()));
        }
        binary.extend([2u8, 0, 0, 0]); // sparse index
        binary.extend([7i16, 8, 9].iter().flat_map(|x| x.to_le_bytes()));
        binary.extend([0; 2]);
        let document = json!({
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
            "nodes": [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 2}}]}],
            "buffers": [{"byteLength": 48}],
            "bufferViews": [
                {"buffer": 0, "byteLength": 36, "byteStride": 12},
                {"buffer": 0, "byteOffset": 36, "byteLength": 1},
                {"buffer": 0, "byteOffset": 40, "byteLength": 6}
            ],
            "accessors": [
                {"bufferView": 0, "componentType": 5122, "count": 3, "type": "VEC3", "sparse": {
                    "count": 1,
                    "indices": {"bufferView": 1, "componentType": 5121},
                    "values": {"bufferView": 2}
                }},
                {"bufferView": 0, "byteOffset": 8, "componentType": 5123, "normalized": true, "count": 3, "type": "VEC2"},
                {"componentType": 5126, "count": 3, "type": "VEC3"}
            ],
        });
        let (asset, findings) = read(&document, &binary);
        let piece = &asset.pieces[0];
        assert_eq!(piece.positions[1], Vec3::new(100.0, 0.0, 0.0));
        assert_eq!(piece.positions[2], Vec3::new(7.0, 8.0, 9.0), "the sparse row replaces");
        assert_eq!(piece.uvs.as_ref().unwrap()[0], Vec2::new(0.0, 1.0));
        assert!((piece.uvs.as_ref().unwrap()[1].x - 32768.0 / 65535.0).abs() < 1e-15);
        assert_eq!(piece.normals.as_ref().unwrap()[0], Vec3::y(), "zero normals (no buffer view) are mended");
        assert!(findings.iter().any(|f| f.message.starts_with("3 normals")), "{findings:?}");
    }

    /// Joint 0 moved by +x, joint 1 by +y, both bound at the origin; the mesh's node is far away, which must not matter.
    #[test]
    fn a_skin_places_vertices_and_its_node_does_not() {
        let (mut document, mut binary) = triangle();
        let joints = [[0u8, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]];
        let weights = [[0.25f32, 0.75, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0; 4]];
        binary.extend(joints.iter().flatten());
        binary.extend(floats(weights.as_flattened()));
        document["buffers"][0]["byteLength"] = json!(binary.len());
        document["bufferViews"].as_array_mut().unwrap().extend([
            json!({"buffer": 0, "byteOffset": 36, "byteLength": 12}),
            json!({"buffer": 0, "byteOffset": 48, "byteLength": 48}),
        ]);
        document["accessors"].as_array_mut().unwrap().extend([
            json!({"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"}),
            json!({"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4"}),
        ]);
        document["meshes"][0]["primitives"][0]["attributes"] =
            json!({"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2});
        document["nodes"] = json!([
            {"mesh": 0, "skin": 0, "translation": [1000, 0, 0]},
            {"translation": [1, 0, 0]}, {"translation": [0, 1, 0]}
        ]);
        document["scenes"] = json!([{"nodes": [0, 1, 2]}]);
        document["skins"] = json!([{"joints": [1, 2]}]);
        let (asset, findings) = read(&document, &binary);
        let at = |v| asset.pieces[0].scene_position(v).unwrap();
        assert!((at(0) - Vec3::new(0.25, 0.75, 0.0)).norm() < 1e-12, "{}", at(0));
        assert!(
            (at(1) - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-12,
            "weights are divided by their sum: {}",
            at(1)
        );
        assert!(
            (at(2) - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-12,
            "without weights the first joint: {}",
            at(2)
        );
        assert!(findings.iter().any(|f| f.message.contains("2 of 3 vertices")), "{findings:?}");

        document["skins"] = json!([{"joints": [1]}]);
        assert!(message(&document, &binary).contains("follows joint 1"));
    }

    #[test]
    fn a_mesh_of_two_nodes_is_worn_once() {
        let (mut document, binary) = triangle();
        document["nodes"] =
            json!([{"name": "Left", "mesh": 0}, {"name": "Right", "mesh": 0, "translation": [1, 0, 0]}]);
        document["scenes"] = json!([{"nodes": [0, 1]}]);
        let (asset, findings) = read(&document, &binary);
        assert_eq!((asset.pieces.len(), asset.pieces[0].node), (1, Some(0)));
        assert_eq!(findings[0].location, "nodes[1]");
    }

    #[test]
    fn pieces_answer_to_all_their_names() {
        let (mut document, binary) = triangle();
        document["nodes"] = json!([{"name": "Cloth", "mesh": 0}, {"name": "Body", "mesh": 1}, {"name": "Outfit", "children": [0]}]);
        document["scenes"] = json!([{"nodes": [1, 2]}]);
        document["materials"] = json!([{"name": "denim"}]);
        document["meshes"] = json!([
            {"name": "Sheet", "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]},
            {"name": "Human", "primitives": [{"attributes": {"POSITION": 0}}]}
        ]);
        for name in ["Cloth", "Sheet", "denim", "Outfit", "mesh 0"] {
            let options = ReadOptions { garment: Some(name.into()), ..ReadOptions::default() };
            let (asset, _) = read_with(&document, &binary, &options).unwrap();
            assert_eq!(asset.pieces.iter().map(|p| p.worn).collect::<Vec<_>>(), [true, false], "{name}");
        }
        let options = ReadOptions { garment: Some("cloth".into()), ..ReadOptions::default() };
        let message = read_with(&document, &binary, &options).unwrap_err().to_string();
        assert!(message.contains("Cloth, Sheet, denim, Outfit, mesh 0, Body, Human"), "{message}");
    }

    #[test]
    fn damage_is_named_with_its_place() {
        type Damage = fn(&mut Value);
        let cases: [(&str, &str, Damage); 17] = [
            ("asset", "glTF 1.0 cannot be read", |d| d["asset"]["version"] = json!("1.0")),
            ("extensionsRequired[0]", "FOO_boxes", |d| d["extensionsRequired"] = json!(["FOO_boxes"])),
            ("nodes[0]", "its own ancestor", |d| d["nodes"] = json!([{"children": [1]}, {"children": [0]}])),
            ("nodes[1]", "also a child", |d| {
                d["nodes"] = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}])
            }),
            ("nodes[0]", "meshes[7]", |d| d["nodes"][0]["mesh"] = json!(7)),
            ("nodes[0]", "rotation is zero", |d| d["nodes"][0]["rotation"] = json!([0, 0, 0, 0])),
            ("nodes[0].matrix", "16 numbers", |d| d["nodes"][0]["matrix"] = json!([1, 2, 3])),
            ("nodes[0]", "flat", |d| d["nodes"][0]["scale"] = json!([1, 0, 1])),
            ("meshes[0].primitives[0]", "accessors[9]", |d| {
                d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(9);
            }),
            ("meshes[0].primitives[0]", "KHR_draco_mesh_compression", |d| {
                d["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}});
                d["accessors"][0].as_object_mut().unwrap().remove("bufferView");
            }),
            ("accessors[0]", "do not fit", |d| d["accessors"][0]["count"] = json!(4)),
            ("accessors[0].count", "not an index", |d| d["accessors"][0]["count"] = json!(-3)),
            ("accessors[0]", "type", |d| d["accessors"][0]["type"] = json!("VEC9")),
            ("accessors[0]", "without any data", |d| {
                d["accessors"][0] =
                    json!({"componentType": 5126, "count": 4_000_000_000_u32, "type": "VEC3"});
            }),
            ("bufferViews[0]", "which has 36", |d| d["bufferViews"][0]["byteOffset"] = json!(1)),
            ("buffers[0]", "promises 99 bytes", |d| d["buffers"][0]["byteLength"] = json!(99)),
            ("accessors[0]", "unsigned whole numbers", |d| {
                d["meshes"][0]["primitives"][0]["indices"] = json!(0);
            }),
        ];
        for (place, what, damage) in cases {
            let (mut document, binary) = triangle();
            damage(&mut document);
            let message = message(&document, &binary);
            assert!(
                message.contains(&format!("test.glb: {place}: ")) && message.contains(what),
                "{what}: {message}"
            );
        }
    }

    #[test]
    fn several_damaged_primitives_are_told_at_once() {
        let (mut document, binary) = triangle();
        document["meshes"][0]["primitives"] = json!([
            {"attributes": {"POSITION": 5}}, {"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 6}}
        ]);
        assert_eq!(message(&document, &binary).lines().count(), 2);
    }

    #[test]
    fn outside_buffers_are_asked_for_by_name() {
        let (mut document, binary) = triangle();
        document["buffers"][0]["uri"] = json!("my%20mesh.bin");
        let text = document.to_string();
        let mut asked = String::new();
        let read = read_asset("a.gltf", text.as_bytes(), &ReadOptions::default(), &mut |uri| {
            asked = uri.to_owned();
            Ok(binary.clone())
        });
        assert_eq!(read.unwrap().0.pieces[0].positions.len(), 3);
        assert_eq!(asked, "my mesh.bin");
    }

    #[test]
    fn a_mask_is_read_and_a_missing_one_refused() {
        let (mut document, mut binary) = triangle();
        binary.extend([0u8, 51, 255, 0]);
        document["buffers"][0]["byteLength"] = json!(40);
        document["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({"buffer": 0, "byteOffset": 36, "byteLength": 3}));
        document["accessors"].as_array_mut().unwrap().push(
            json!({"bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "SCALAR"}),
        );
        document["meshes"][0]["primitives"][0]["attributes"]["_PIN"] = json!(1);
        let options = ReadOptions { mask: Some("_PIN".into()), ..ReadOptions::default() };
        let (asset, _) = read_with(&document, &binary, &options).unwrap();
        assert_eq!(asset.pieces[0].mask.as_deref(), Some(&[0.0, 0.2, 1.0][..]));
        let options = ReadOptions { mask: Some("COLOR_0".into()), ..ReadOptions::default() };
        let message = read_with(&document, &binary, &options).unwrap_err().to_string();
        assert!(message.contains("COLOR_0") && message.contains("POSITION, _PIN"), "{message}");
    }
}
