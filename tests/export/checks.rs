//! Conditions that hold for every written document.

use crate::wearing::extras;
use crease_io::gltf::{WORN_TARGET, join_glb, split_glb};
use crease_model::garment::{Garment, SourceAsset, WornGarment};
use nalgebra::{Matrix4, Vector3};
use serde_json::{Value, json};

/// Asserts that the content of `before` is in `after`, except where the worn target must change it.
pub fn assert_kept(before: &Value, after: &Value, path: &str) {
    // Normals of flat cloth are tilted: `assert_same_bytes` compares them.
    let changed =
        ["/byteLength", "/output", "/weights", "/targetNames", "/buffers/0/uri", "/attributes/NORMAL"];
    let moved =
        path.starts_with("/bufferViews") && (path.ends_with("/buffer") || path.ends_with("/byteOffset"));
    if moved || changed.iter().any(|end| path.ends_with(end)) {
        return;
    }
    match (before, after) {
        (Value::Object(before), Value::Object(after)) => {
            for (key, value) in before {
                let path = format!("{path}/{key}");
                let Some(after) = after.get(key) else {
                    assert!(path.ends_with("/uri") && path.starts_with("/buffers"), "{path} is gone");
                    continue;
                };
                assert_kept(value, after, &path);
            }
        }
        (Value::Array(before), Value::Array(after)) if path != "/buffers" => {
            assert!(after.len() >= before.len(), "{path} became shorter");
            for (i, (before, after)) in before.iter().zip(after).enumerate() {
                assert_kept(before, after, &format!("{path}/{i}"));
            }
        }
        (Value::Array(before), Value::Array(after)) => assert_kept(&before[0], &after[0], "/buffers/0"),
        _ => assert_eq!(before, after, "{path} changed"),
    }
}

/// Asserts that every view of the input has the same bytes.
pub fn assert_same_bytes(before: &Value, buffers: &[Vec<u8>], after: &Value, binary: &[u8]) {
    let slice = |view: &Value, bytes: &[u8]| {
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        bytes[start..start + view["byteLength"].as_u64().unwrap() as usize].to_vec()
    };
    let views = before["bufferViews"].as_array().unwrap();
    for (i, view) in views.iter().enumerate() {
        let old = slice(view, &buffers[view["buffer"].as_u64().unwrap() as usize]);
        assert_eq!(after["bufferViews"][i]["buffer"], 0);
        assert_eq!(old, slice(&after["bufferViews"][i], binary), "bufferViews[{i}]");
    }
    for (m, mesh) in before["meshes"].as_array().unwrap().iter().enumerate() {
        for (p, primitive) in mesh["primitives"].as_array().unwrap().iter().enumerate() {
            let old = &primitive["attributes"]["NORMAL"];
            let new = &after["meshes"][m]["primitives"][p]["attributes"]["NORMAL"];
            if old != new && is_plain(before, old) {
                assert_tilted(&numbers(after, binary, old), &numbers(after, binary, new));
            }
        }
    }
    assert_eq!(after["buffers"].as_array().unwrap().len(), 1);
    assert!(after["buffers"][0].get("uri").is_none());
}

/// Whether `numbers` reads the accessor `index`: floats at the start of a view of their own.
fn is_plain(json: &Value, index: &Value) -> bool {
    let accessor = &json["accessors"][index.as_u64().unwrap() as usize];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    accessor["componentType"] == 5126
        && accessor["byteOffset"].as_u64().unwrap_or(0) == 0
        && matches!(view["byteStride"].as_u64(), None | Some(12))
}

/// Asserts that unit normals differ by at most 0.2 degrees; others are written anew.
fn assert_tilted(old: &[f32], new: &[f32]) {
    for (old, new) in old.chunks_exact(3).zip(new.chunks_exact(3)) {
        let [old, new] = [old, new].map(|n| Vector3::new(n[0], n[1], n[2]).map(f64::from));
        let is_unit = (old.norm() - 1.0).abs() < 0.006;
        assert!(!is_unit || old.dot(&new) / old.norm() > 0.2f64.to_radians().cos(), "{old} became {new}");
    }
}

pub fn length(list: &Value) -> usize {
    list.as_array().map_or(0, Vec::len)
}

/// Asserts that targets, names and weights of meshes and nodes, and animated weights agree.
pub fn assert_counts(json: &Value) {
    let accessor_count =
        |index: &Value| json["accessors"][index.as_u64().unwrap() as usize]["count"].as_u64().unwrap();
    for mesh in json["meshes"].as_array().unwrap() {
        let primitives = mesh["primitives"].as_array().unwrap();
        let count = length(&primitives[0]["targets"]);
        for primitive in primitives {
            assert_eq!(length(&primitive["targets"]), count);
            let vertices = accessor_count(&primitive["attributes"]["POSITION"]);
            for target in primitive["targets"].as_array().into_iter().flatten() {
                target.as_object().unwrap().values().for_each(|a| assert_eq!(accessor_count(a), vertices));
            }
        }
        if mesh["extras"]["crease"].is_object() {
            assert_eq!(length(&mesh["weights"]), count);
            assert_eq!(length(&mesh["extras"]["targetNames"]), count);
            assert_eq!(mesh["extras"]["crease"], extras()["crease"]);
        }
    }
    let target_count = |node: &Value| {
        let mesh = json["nodes"][node.as_u64().unwrap() as usize]["mesh"].as_u64().unwrap() as usize;
        length(&json["meshes"][mesh]["primitives"][0]["targets"]) as u64
    };
    for (i, node) in json["nodes"].as_array().unwrap().iter().enumerate() {
        if node["weights"].is_array() {
            assert_eq!(length(&node["weights"]) as u64, target_count(&json!(i)));
        }
    }
    for animation in json["animations"].as_array().into_iter().flatten() {
        for channel in animation["channels"].as_array().unwrap() {
            if channel["target"]["path"] == "weights" {
                let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
                let groups = if sampler["interpolation"] == "CUBICSPLINE" { 3 } else { 1 };
                let wanted =
                    accessor_count(&sampler["input"]) * groups * target_count(&channel["target"]["node"]);
                assert_eq!(accessor_count(&sampler["output"]), wanted);
            }
        }
    }
}

/// Asserts that the worn target of every worn vertex, transformed to the scene, is its point's displacement.
pub fn assert_displaced(asset: &SourceAsset, garment: &Garment, worn: &WornGarment, glb: &[u8]) {
    // The crate cannot read pointers as animation targets; the meshes do not need them.
    let (mut json, binary) = split_glb(glb).unwrap();
    json.as_object_mut().unwrap().remove("animations");
    let file = gltf::Gltf::from_slice_without_validation(&join_glb(&json, &binary.unwrap())).unwrap();
    let binary = file.blob.as_deref().unwrap();
    let mut points = garment.source_point.iter();
    let mut checked = 0;
    for piece in asset.worn_pieces() {
        let mesh = match piece.node {
            Some(node) => file.nodes().nth(node).unwrap().mesh().unwrap(),
            None => file.meshes().nth(piece.mesh).unwrap(),
        };
        let primitive = mesh.primitives().nth(piece.primitive).unwrap();
        let index = worn_index(mesh.extras().as_ref().unwrap().get());
        let reader = primitive.reader(|_| Some(binary));
        let target = reader.read_morph_targets().nth(index).unwrap();
        let rows: Vec<[f32; 3]> = target.0.unwrap().collect();
        assert_eq!(rows.len(), piece.positions.len());
        for (v, row) in rows.iter().enumerate() {
            let transform =
                if asset.document.is_some() { *piece.placement.matrix(v) } else { Matrix4::identity() };
            let local = Vector3::from(row.map(f64::from));
            let moved = transform.fixed_view::<3, 3>(0, 0) * local;
            let wanted = worn.displacement[points.next().unwrap().at()];
            assert!(
                (moved - wanted).norm() < 1e-6,
                "vertex {v} of {}: {moved:?}, not {wanted:?}",
                piece.name
            );
            checked += 1;
        }
        assert!(
            primitive
                .attributes()
                .any(|(name, _)| name == gltf::Semantic::Extras("CREASE_REST_ANGLE_CHANGE".into()))
        );
        assert!(
            primitive.attributes().any(|(name, _)| name == gltf::Semantic::Extras("CREASE_STIFFNESS".into()))
        );
        assert_normals(&primitive, binary, index);
    }
    assert!(checked > 0);
    assert!(points.next().is_none());
}

/// Asserts that worn normals and tangents, as a viewer computes them, are unit vectors.
pub fn assert_normals(primitive: &gltf::Primitive, binary: &[u8], index: usize) {
    let reader = primitive.reader(|_| Some(binary));
    let (_, normals, tangents) = reader.read_morph_targets().nth(index).unwrap();
    let unit = |base: [f32; 3], delta: [f32; 3]| {
        let sum = Vector3::from(base) + Vector3::from(delta);
        assert!((sum.norm() - 1.0).abs() < 1e-3, "{base:?} + {delta:?}");
    };
    assert_eq!(primitive.get(&gltf::Semantic::Normals).is_some(), normals.is_some());
    assert_eq!(primitive.get(&gltf::Semantic::Tangents).is_some(), tangents.is_some());
    // The crate reads base normals as floats only.
    let is_float =
        |semantic| primitive.get(&semantic).is_some_and(|a| a.data_type() == gltf::accessor::DataType::F32);
    if is_float(gltf::Semantic::Normals) {
        reader.read_normals().unwrap().zip(normals.unwrap()).for_each(|(n, d)| unit(n, d));
    }
    if is_float(gltf::Semantic::Tangents) {
        reader.read_tangents().unwrap().zip(tangents.unwrap()).for_each(|(t, d)| unit([t[0], t[1], t[2]], d));
    }
}

pub fn worn_index(extras: &str) -> usize {
    let extras: Value = serde_json::from_str(extras).unwrap();
    extras["targetNames"].as_array().unwrap().iter().position(|name| name == WORN_TARGET).unwrap()
}

/// Returns the numbers of a float accessor of an output.
pub fn numbers(json: &Value, binary: &[u8], index: &Value) -> Vec<f32> {
    let accessor = &json["accessors"][index.as_u64().unwrap() as usize];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
    let count = accessor["count"].as_u64().unwrap() as usize;
    let bytes = &binary[start..start + count * 4];
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}
