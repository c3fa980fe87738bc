//! Reads a glTF document: container, extensions, buffers, node tree, then every primitive that the scene shows, in the
//! order of the file. Everything is read from the raw JSON, which is kept for export.
//!
//! A mesh that several nodes show is copied in the document, since one mesh can keep only one set of wrinkles.
//! Skinned meshes are in the pose of the file, morphed ones in the shape of their default weights. Plays no animation.

use crate::error_list::ErrorList;
use crate::gltf::accessor::Accessors;
use crate::gltf::buffers::{drop_unused, load_buffers, used_buffers};
use crate::gltf::container::{is_glb, other_chunks, parse_json, split_glb};
use crate::gltf::json_cursor::Cursor;
use crate::gltf::meshopt::{MESHOPT_EXTENSION, decode_views, remove_extension};
use crate::gltf::names::{DRACO_CURE, DRACO_EXTENSION};
use crate::gltf::piece_reader::PieceReader;
use crate::gltf::primitive::MaskChannel;
use crate::gltf::scene::SceneNodes;
use crate::gltf::shared_meshes::copy_shared_meshes;
use crate::pieces::ReadPieces;
use crate::read::Resolve;
use crease_geometry::math::Mat4;
use crease_model::error::{Error, Result};
use crease_model::garment::GltfDocument;

/// Prefixes of extensions that a file may require although they are not supported: they change the look of surfaces or
/// the behaviour of nodes, not the positions of vertices. Quantised attributes are read, compressed views decoded.
const HARMLESS_EXTENSIONS: [&str; 15] = [
    MESHOPT_EXTENSION,
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
/// Reads the pieces of a glTF file. `resolve` fetches the files that it refers to.
pub(crate) fn read_gltf(
    file: &str,
    bytes: &[u8],
    to_scene: &Mat4,
    masks: [Option<&str>; 2],
    resolve: &mut Resolve,
) -> Result<ReadPieces> {
    let mut errors = ErrorList::new(file);
    let split = if is_glb(bytes) { split_glb(bytes) } else { parse_json(bytes).map(|json| (json, None)) };
    let Some((mut json, binary)) = errors.take(split) else { return Err(failed(errors)) };
    let chunks = if is_glb(bytes) { other_chunks(bytes) } else { Vec::new() };
    let root = Cursor::root(&json);
    check_version(&root, &mut errors);
    check_extensions(&root, &mut errors);
    check_structure(&root, &mut errors);
    if !errors.is_empty() {
        return Err(failed(errors));
    }
    let used = used_buffers(&json);
    let mut buffers = load_buffers(&root, binary, &used, resolve, &mut errors);
    if errors.is_empty() {
        errors.take(decode_views(&root, &mut buffers));
    }
    if !errors.is_empty() {
        return Err(failed(errors));
    }
    remove_extension(&mut json);
    let unused = drop_unused(&mut json, &mut buffers, &used);
    let Some(scene) = errors.take(SceneNodes::read(&Cursor::root(&json))) else { return Err(failed(errors)) };
    copy_shared_meshes(&mut json, &scene.shown);
    let root = Cursor::root(&json);
    check_meshes(&root, &mut errors);
    if !errors.is_empty() {
        return Err(failed(errors));
    }
    let accessors = Accessors::from_parts(&json, &buffers);
    let reader = PieceReader::new(&root, accessors, scene, *to_scene, errors);
    let mut read = reader.read(masks.map(|mask| mask.map(MaskChannel::parse)))?;
    read.diagnostics.extend(unused);
    read.document = Some(GltfDocument { json, buffers, chunks });
    Ok(read)
}

/// Returns the error of a list that is not empty.
fn failed(errors: ErrorList) -> Error {
    match errors.finish() {
        Err(error) => error,
        Ok(()) => Error::Input(Vec::new()),
    }
}

fn check_version(root: &Cursor, errors: &mut ErrorList) {
    let asset = root.member("asset");
    let needed = asset.text("minVersion").or(asset.text("version"));
    match needed {
        Some("2.0") => {}
        Some(version) if version.starts_with("2.") && asset.text("minVersion").is_none() => {}
        Some(version) => {
            errors.push("asset", format!("glTF {version} cannot be read"), "export it as glTF 2.0")
        }
        None => errors.push("asset.version", "it is missing: this is not glTF 2.0", "export it as glTF 2.0"),
    }
}

fn check_extensions(root: &Cursor, errors: &mut ErrorList) {
    for required in root.entries("extensionsRequired") {
        let Some(name) = required.as_text() else { continue };
        // Parts that are not compressed can be read; those that are, are told one by one.
        if name == DRACO_EXTENSION && has_plain_primitive(root) {
            continue;
        }
        if !HARMLESS_EXTENSIONS.iter().any(|harmless| name.starts_with(harmless)) {
            errors.push(
                required.path(),
                format!("the file requires {name}, which cannot be decoded"),
                format!("export it without {name}{}", if name == DRACO_EXTENSION { DRACO_CURE } else { "" }),
            );
        }
    }
}

/// Whether any primitive is not compressed with Draco.
fn has_plain_primitive(root: &Cursor) -> bool {
    let meshes = root.entries("meshes");
    let mut primitives = meshes.iter().flat_map(|mesh| mesh.entries("primitives"));
    primitives.any(|primitive| !primitive.member("extensions").member(DRACO_EXTENSION).exists())
}

/// Reports lists that are no lists: read as empty, they would only show as missing triangles.
fn check_structure(root: &Cursor, errors: &mut ErrorList) {
    let help = "export the file again, or correct it at this location";
    for list in [
        "scenes",
        "nodes",
        "meshes",
        "accessors",
        "bufferViews",
        "buffers",
        "skins",
        "animations",
        "materials",
    ] {
        let member = root.member(list);
        if member.exists() && !member.is_list() {
            errors.push(member.path(), "is not a list", help);
        }
        for entry in root.entries(list).iter().filter(|entry| !entry.is_object()) {
            errors.push(entry.path(), "is not an object", help);
        }
    }
}

/// Reports a document that shows no mesh.
fn check_meshes(root: &Cursor, errors: &mut ErrorList) {
    let shows_mesh = root.entries("nodes").iter().any(|node| node.member("mesh").exists());
    if root.length("meshes") == 0 {
        errors.push("meshes", "there are none in the file", "export the garment as a mesh");
    } else if root.length("nodes") > 0 && !shows_mesh {
        errors.push("nodes", "none of them shows a mesh", "export the scene that shows the garment");
    }
}
