//! The worn shape in a glTF file as other programs read it: small documents of unusual kinds are worn, and the output is
//! read back with the `gltf` crate. Conditions for each: the content of the input is kept with the same bytes; the target
//! `worn` is the displacement asked for; all counts that the specification relates agree.
//!
//! Each output is kept in `target/tmp/export/`, so that the Khronos validator can be run over all of them.

#[path = "export/checks.rs"]
mod checks;
#[path = "export/document.rs"]
mod document;
#[path = "reference/external.rs"]
mod external;
#[path = "export/normals.rs"]
mod normals;
#[path = "export/wearing.rs"]
mod wearing;

use checks::*;
use crease_io::gltf::{
    FORMER_REST_ANGLE_ATTRIBUTE, REST_ANGLE_CHANGE_ATTRIBUTE, join_glb, read_worn, split_glb, write_worn_glb,
};
use crease_io::{ReadOptions, Sidecar, read_asset, read_sidecar, write_sidecar};
use crease_model::garment::{Garment, SourceAsset};
use document::*;
use external::external;
use nalgebra::Vector3;
use serde_json::{Value, json};
use test_attributes::needs_data;
use wearing::*;

/// Positions and normals in one view, a node that rotates and stretches, tangents, texture coordinates, extras anywhere.
#[test]
fn an_interleaved_mesh_under_a_stretched_node() {
    let mut d = Document::new();
    let rows: Vec<f32> = QUAD.iter().flat_map(|p| p.iter().copied().chain([0.0, 0.0, 1.0])).collect();
    let view = d.view(&floats(&rows), Some(24));
    let (low, high) = bounds(&QUAD);
    let position = d.push(
        "accessors",
        json!({"bufferView": view, "componentType": FLOAT, "count": 4, "type": "VEC3", "min": low, "max": high}),
    );
    let normal = d.push(
        "accessors",
        json!({"bufferView": view, "byteOffset": 12, "componentType": FLOAT, "count": 4, "type": "VEC3", "name": "n"}),
    );
    let tangent = d.floats("VEC4", 4, &[1.0, 0.0, 0.0, -1.0].repeat(4));
    let uv = d.floats("VEC2", 2, &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let attributes = json!({"POSITION": position, "NORMAL": normal, "TANGENT": tangent, "TEXCOORD_0": uv});
    let mut primitive = d.quad(attributes);
    primitive["material"] = json!(0);
    d.push("materials", json!({"name": "m", "extensions": {"ACME_unknown": {"deep": {"er": [true]}}}}));
    d.push("meshes", json!({"name": "cloth", "primitives": [primitive], "extras": {"own": [1, 2]}}));
    let (s, c) = (0.3f64.sin(), 0.3f64.cos());
    d.push("nodes", json!({"children": [1], "matrix": [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}));
    d.push(
        "nodes",
        json!({"mesh": 0, "scale": [2.0, 1.0, -0.5], "rotation": [0.0, 0.6, 0.0, 0.8], "extras": 3}),
    );
    let glb = wear("interleaved", &d.glb(), None);
    let (json, _) = split_glb(&glb).unwrap();
    assert_eq!(json["meshes"][0]["extras"]["own"], json!([1, 2]));
    assert_eq!(json["meshes"][0]["weights"], json!([1.0]));
    assert_eq!(json["asset"]["generator"], "somebody else");
}

#[test]
fn a_skinned_quad_whose_joints_turn_and_scale() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let normal = d.floats("VEC3", 3, &QUAD_NORMALS);
    let joint_view = d.view(&[0u8, 1, 0, 0].repeat(4), None);
    let joints = d.push(
        "accessors",
        json!({"bufferView": joint_view, "componentType": UNSIGNED_BYTE, "count": 4, "type": "VEC4"}),
    );
    let weights = [[1.0, 0.0, 0.0, 0.0], [0.75, 0.25, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
    let weights = d.floats("VEC4", 4, weights.as_flattened());
    let identity: [f32; 16] = std::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 });
    let inverse_bind = d.floats("MAT4", 16, &identity.repeat(2));
    let attributes =
        json!({"POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights});
    let primitive = d.quad(attributes);
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("skins", json!({"joints": [1, 2], "inverseBindMatrices": inverse_bind, "skeleton": 1}));
    d.json["scenes"] = json!([{"nodes": [0, 1]}]);
    d.push("nodes", json!({"mesh": 0, "skin": 0}));
    d.push("nodes", json!({"children": [2], "scale": [0.5, 2.0, 1.0]}));
    d.push("nodes", json!({"rotation": [0.0, 0.0, 0.6, 0.8], "translation": [0.1, 0.2, 0.3]}));
    wear("skinned", &d.glb(), None);
}

/// Two targets, one named, default weights on mesh and node; one node animated linearly, by a spline, by small integers,
/// and by pointers to the weights of the mesh and to one weight alone.
fn morphed_and_animated() -> (Document, usize, Vec<f32>) {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let other = d.positions(&QUAD.map(|p| [p[1], p[0], 0.25]));
    let mut primitive = d.quad(json!({"POSITION": position}));
    primitive["targets"] = json!([{"POSITION": other}, {"POSITION": other}]);
    d.push(
        "meshes",
        json!({"primitives": [primitive], "weights": [0.25, 0.5], "extras": {"targetNames": ["smile"]}}),
    );
    d.push("nodes", json!({"mesh": 0, "weights": [0.5, 0.0], "children": [1]}));
    d.push("nodes", json!({"name": "other"}));
    let time = d.floats("SCALAR", 1, &[0.0, 1.0, 2.0]);
    d.json["accessors"][time]["min"] = json!([0.0]);
    d.json["accessors"][time]["max"] = json!([2.0]);
    let linear = d.floats("SCALAR", 1, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    let spline: Vec<f32> = (1..=18).map(|i| i as f32 / 16.0).collect();
    let spline_output = d.floats("SCALAR", 1, &spline);
    let byte_view = d.view(&[0, 51, 102, 153, 204, 255], None);
    let small = d.push(
        "accessors",
        json!({"bufferView": byte_view, "componentType": UNSIGNED_BYTE, "normalized": true, "count": 6, "type": "SCALAR"}),
    );
    let turn = d.floats("VEC3", 3, &[0.0; 9]);
    let animation = |output: usize, how: &str| {
        json!({
            "channels": [
                {"sampler": 1, "target": {"node": 1, "path": "translation"}},
                {"sampler": 0, "target": {"node": 0, "path": "weights"}},
            ],
            "samplers": [
                {"input": time, "output": output, "interpolation": how, "extras": "kept"},
                {"input": time, "output": turn},
            ],
        })
    };
    let one_weight = d.floats("SCALAR", 1, &[0.0, 1.0, 0.0]);
    let pointer = |sampler: usize, pointer: &str| {
        let target =
            json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
        json!({"sampler": sampler, "target": target})
    };
    let pointers = json!({
        "channels": [pointer(0, "/meshes/0/weights"), pointer(1, "/nodes/0/weights/1")],
        "samplers": [{"input": time, "output": linear}, {"input": time, "output": one_weight}],
    });
    d.json["animations"] = json!([
        animation(linear, "LINEAR"),
        animation(spline_output, "CUBICSPLINE"),
        animation(small, "STEP"),
        pointers,
    ]);
    d.json["extensionsUsed"] = json!(["ACME_unknown", "KHR_animation_pointer"]);
    (d, turn, spline)
}

#[test]
fn existing_targets_and_animated_weights_are_extended() {
    let (d, turn, spline) = morphed_and_animated();
    let glb = wear("morph_animated", &d.glb(), None);
    let (json, binary) = split_glb(&glb).unwrap();
    let binary = binary.unwrap();
    assert_eq!(json["meshes"][0]["weights"], json!([0.25, 0.5, 1.0]));
    assert_eq!(json["nodes"][0]["weights"], json!([0.5, 0.0, 1.0]));
    assert_eq!(json["meshes"][0]["extras"]["targetNames"], json!(["smile", "target_1", "worn"]));
    assert_eq!(json["animations"][0]["samplers"][1]["output"], turn, "the other sampler stays");
    let output = |i: usize| numbers(&json, &binary, &json["animations"][i]["samplers"][0]["output"]);
    assert_eq!(output(0), [0.1, 0.2, 1.0, 0.3, 0.4, 1.0, 0.5, 0.6, 1.0]);
    let worn = [0.0, 1.0, 0.0];
    let wanted: Vec<f32> =
        spline.chunks(2).enumerate().flat_map(|(i, w)| [w[0], w[1], worn[i % 3]]).collect();
    assert_eq!(output(1), wanted);
    for (found, wanted) in output(2).iter().zip([0.0, 0.2, 1.0, 0.4, 0.6, 1.0, 0.8, 1.0, 1.0]) {
        assert!((found - wanted).abs() < 1e-6);
    }
    assert_eq!(output(3), output(0), "all weights of the mesh, by pointer");
    let before = &read("again", &morphed_and_animated().0.glb(), None).document.unwrap().json;
    let single = "/animations/3/samplers/1";
    assert_eq!(json.pointer(single), before.pointer(single), "a pointer to one weight still means that one");
}

/// Draco stores vertices in another order than that of the target; the plain copy was worn.
#[test]
fn a_compressed_copy_of_a_worn_primitive_is_dropped() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let mut primitives = [d.quad(json!({"POSITION": position})), d.quad(json!({"POSITION": position}))];
    for (i, primitive) in primitives.iter_mut().enumerate() {
        primitive["material"] = json!(i);
        primitive["extensions"] = json!({
            "ACME_unknown": 1,
            "KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}},
        });
        d.push("materials", json!({"name": format!("material {i}")}));
    }
    d.push("meshes", json!({"primitives": primitives}));
    d.push("nodes", json!({"mesh": 0}));
    let asset = read("draco", &d.glb(), Some("material 0"));
    let garment = garment(&asset);
    let glb = write_worn_glb(&asset, &garment, &some_wear(&garment), &extras()).unwrap();
    let (json, _) = split_glb(&glb).unwrap();
    let extensions = |i: usize| json["meshes"][0]["primitives"][i]["extensions"].clone();
    assert_eq!(extensions(0), json!({"ACME_unknown": 1}));
    assert!(extensions(1)["KHR_draco_mesh_compression"].is_object(), "not worn, so left alone");
}

/// Any value of the document replaced by another after reading: a result or an error, never a panic.
#[test]
fn a_document_with_any_one_value_broken_is_no_panic() {
    let asset = read("broken", &morphed_and_animated().0.glb(), None);
    let garment = garment(&asset);
    let worn = some_wear(&garment);
    let document = &asset.document.as_ref().unwrap().json;
    let mut paths = Vec::new();
    list_paths(document, String::new(), &mut paths);
    assert!(paths.len() > 200);
    let mut refused = 0;
    for path in paths {
        for nonsense in [json!(null), json!(-1), json!(4_000_000_000u64), json!("x"), json!([]), json!({})] {
            let mut broken = asset.clone();
            *broken.document.as_mut().unwrap().json.pointer_mut(&path).unwrap() = nonsense;
            refused += usize::from(write_worn_glb(&broken, &garment, &worn, &extras()).is_err());
        }
    }
    assert!(refused > 100, "{refused}");
}

fn list_paths(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(key, value)| list_paths(value, format!("{path}/{key}"), paths))
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, value)| list_paths(value, format!("{path}/{i}"), paths));
        }
        _ => {}
    }
    paths.push(path);
}

/// Two nodes animated by one sampler, only one of them worn: the other's channel must still read two weights per key.
#[test]
fn a_sampler_shared_with_another_mesh_is_not_extended_under_it() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let far = d.positions(&QUAD.map(|p| [p[0] + 2.0, p[1], p[2]]));
    for (name, position) in [("worn one", position), ("other", far)] {
        let mut primitive = d.quad(json!({"POSITION": position}));
        primitive["targets"] = json!([{"POSITION": position}]);
        d.push("meshes", json!({"name": name, "primitives": [primitive]}));
    }
    d.push("nodes", json!({"mesh": 0, "children": [1]}));
    d.push("nodes", json!({"mesh": 1}));
    let time = d.floats("SCALAR", 1, &[0.0, 1.0]);
    d.json["accessors"][time]["min"] = json!([0.0]);
    d.json["accessors"][time]["max"] = json!([1.0]);
    let output = d.floats("SCALAR", 1, &[0.0, 0.5]);
    d.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "weights"}}],
        "samplers": [{"input": time, "output": output}],
    }]);
    let channel = json!({"sampler": 0, "target": {"node": 0, "path": "weights"}});
    d.json["animations"][0]["channels"].as_array_mut().unwrap().push(channel);
    let asset = read("shared_sampler", &d.glb(), Some("worn one"));
    let garment = garment(&asset);
    let glb = write_worn_glb(&asset, &garment, &some_wear(&garment), &extras()).unwrap();
    leave("shared_sampler", &glb);
    let (json, binary) = split_glb(&glb).unwrap();
    assert_counts(&json);
    let animation = &json["animations"][0];
    assert_eq!(animation["channels"][0]["sampler"], 0);
    assert_eq!(animation["channels"][1]["sampler"], 1);
    assert_eq!(animation["samplers"][0]["output"], output);
    let extended = numbers(&json, &binary.unwrap(), &animation["samplers"][1]["output"]);
    assert_eq!(extended, [0.0, 1.0, 0.5, 1.0]);
    assert!(json["meshes"][1]["weights"].is_null(), "the other mesh is as it was");
    assert_eq!(json["meshes"][1], asset.document.unwrap().json["meshes"][1]);
}

/// Two primitives with common accessors except the indices; one is worn. The other needs a target of zeros, too.
#[test]
fn a_primitive_that_is_not_worn_gets_zeros() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let normal = d.floats("VEC3", 3, &QUAD_NORMALS);
    let mut primitives = Vec::new();
    for (i, name) in ["cloth", "buttons"].iter().enumerate() {
        let mut primitive = d.quad(json!({"POSITION": position, "NORMAL": normal}));
        primitive["material"] = json!(i);
        d.push("materials", json!({"name": name}));
        primitives.push(primitive);
    }
    d.push("meshes", json!({"primitives": primitives}));
    d.push("nodes", json!({"mesh": 0}));
    let glb = wear("one_of_two", &d.glb(), Some("cloth"));
    let file = gltf::Gltf::from_slice(&glb).expect("the gltf crate finds it valid");
    let buttons = file.meshes().next().unwrap().primitives().nth(1).unwrap();
    let reader = buttons.reader(|_| file.blob.as_deref());
    let zeros: Vec<[f32; 3]> = reader.read_morph_targets().next().unwrap().0.unwrap().collect();
    assert_eq!(zeros, [[0.0; 3]; 4]);
    assert!(buttons.attributes().all(|(name, _)| !matches!(name, gltf::Semantic::Extras(_))));
}

/// A mesh that two nodes show is two garments: each has a shape of its own, on the accessors of both.
#[test]
fn each_node_of_a_mesh_that_two_show_wears_its_own() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let mut primitive = d.quad(json!({"POSITION": position}));
    primitive["targets"] = json!([{"POSITION": position}]);
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0, "children": [1]}));
    d.push("nodes", json!({"mesh": 0, "translation": [3.0, 0.0, 0.0], "weights": [0.5]}));
    let (json, _) = split_glb(&wear("two_nodes", &d.glb(), None)).unwrap();
    assert_eq!(json["meshes"].as_array().unwrap().len(), 2);
    assert_eq!([0, 1].map(|k| json["nodes"][k]["mesh"].clone()), [json!(0), json!(1)]);
    assert_eq!(json["nodes"][1]["weights"], json!([0.5, 1.0]));
}

/// The same mesh, where the piece of the second node is not worn.
#[test]
fn a_node_with_an_unworn_piece_of_the_same_mesh_keeps_its_shape() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let primitive = d.quad(json!({"POSITION": position}));
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0, "children": [1]}));
    d.push("nodes", json!({"mesh": 0, "translation": [3.0, 0.0, 0.0]}));
    let mut asset = read("copy", &d.glb(), None);
    assert_eq!(asset.pieces.iter().map(|piece| piece.node).collect::<Vec<_>>(), [Some(0), Some(1)]);
    asset.pieces[1].worn = false;
    let garment = garment(&asset);
    let worn = some_wear(&garment);
    let glb = write_worn_glb(&asset, &garment, &worn, &extras()).unwrap();
    leave("copied_mesh", &glb);
    assert_displaced(&asset, &garment, &worn, &glb);
    let (json, _) = split_glb(&glb).unwrap();
    let primitive = |node: usize| {
        let mesh = json["nodes"][node]["mesh"].as_u64().unwrap() as usize;
        json["meshes"][mesh]["primitives"][0].clone()
    };
    assert!(primitive(0)["targets"].is_array());
    assert_eq!(primitive(1), asset.document.unwrap().json["meshes"][0]["primitives"][0]);
}

/// Positions in 16 bits that a node scales back, normals in 8, as KHR_mesh_quantization allows.
#[test]
fn quantised_positions_get_a_target_in_their_own_units() {
    let mut d = Document::new();
    let quantised = |x: f32| (x * 20_000.0) as i16;
    let rows: Vec<[i16; 4]> =
        QUAD.iter().map(|p| [quantised(p[0]), quantised(p[1]), quantised(p[2]), 0]).collect();
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let view = d.view(&bytes, Some(8));
    let position = d.push(
        "accessors",
        json!({
            "bufferView": view, "componentType": SHORT, "count": 4, "type": "VEC3",
            "min": [0, 0, 0], "max": [quantised(0.5), quantised(0.5), quantised(0.1)],
        }),
    );
    let normal_view = d.view(&[0u8, 0, 127, 0].repeat(4), Some(4));
    let normal = d.push(
        "accessors",
        json!({"bufferView": normal_view, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"}),
    );
    let primitive = d.quad(json!({"POSITION": position, "NORMAL": normal}));
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0, "scale": [0.00005, 0.00005, 0.00005]}));
    d.json["extensionsUsed"] = json!(["ACME_unknown", "KHR_mesh_quantization"]);
    d.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    wear("quantised", &d.glb(), None);
}

/// A .gltf with three buffers, one of odd length: all in one binary chunk afterwards, an image's bytes too.
#[test]
fn several_buffers_become_one_and_keep_their_bytes() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let primitive = d.quad(json!({"POSITION": position}));
    d.push("meshes", json!({"primitives": [primitive], "extras": "just text"}));
    d.push("nodes", json!({"mesh": 0}));
    let first = d.bytes.len();
    d.json["bufferViews"][0]["buffer"] = json!(2);
    d.json["bufferViews"][1]["buffer"] = json!(2);
    let other = d.view(b"not a picture", None);
    d.json["bufferViews"][other] = json!({"buffer": 1, "byteOffset": 2, "byteLength": 13});
    d.json["buffers"] = json!([
        {"uri": "empty.bin", "byteLength": 3, "name": "kept"},
        {"uri": "data:application/octet-stream;base64,eHhub3QgYSBwaWN0dXJl", "byteLength": 15},
        {"uri": "mesh%20data.bin", "byteLength": first},
    ]);
    let bytes = d.bytes[..first].to_vec();
    let mut resolve = |uri: &str| Ok(if uri == "mesh data.bin" { bytes.clone() } else { b"abc".to_vec() });
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..Default::default() };
    let text = d.json.to_string();
    let (asset, _) = read_asset("several.gltf", text.as_bytes(), &options, &mut resolve).unwrap();
    let (json, _) = split_glb(&wear_asset_keeping("several_buffers", &asset)).unwrap();
    assert_eq!(json["buffers"][0]["name"], "kept");
    assert_eq!(
        json["meshes"][0]["extras"]["extras"], "just text",
        "extras that are no object are kept in one"
    );
}

/// As [`wear_asset`], without the comparison of extras that had to be wrapped.
fn wear_asset_keeping(name: &str, asset: &SourceAsset) -> Vec<u8> {
    let mut unwrapped = asset.clone();
    unwrapped.document.as_mut().unwrap().json["meshes"][0].as_object_mut().unwrap().remove("extras");
    wear_asset(name, &unwrapped);
    let garment = garment(asset);
    write_worn_glb(asset, &garment, &some_wear(&garment), &extras()).unwrap()
}

/// A mesh that is worn twice must not show the sum of both shapes.
#[test]
fn a_mesh_worn_before_has_its_worn_target_replaced() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let mut primitive = d.quad(json!({"POSITION": position}));
    primitive["targets"] = json!([{"POSITION": position}]);
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0}));
    let once = wear("once", &d.glb(), None);
    let asset = read("twice", &once, None);
    let garment = garment(&asset);
    let mut worn = some_wear(&garment);
    worn.displacement.iter_mut().for_each(|d| *d *= -2.0);
    let twice = write_worn_glb(&asset, &garment, &worn, &extras()).unwrap();
    leave("twice", &twice);
    assert_displaced(&asset, &garment, &worn, &twice);
    let (json, _) = split_glb(&twice).unwrap();
    assert_counts(&json);
    assert_eq!(json["meshes"][0]["extras"]["targetNames"], json!(["target_0", "worn"]));
    assert_eq!(json["meshes"][0]["weights"], json!([0.0, 1.0]));
}

/// Files of earlier versions call the change of rest angle `_CREASE_REST_ANGLE`: they are read as before, and worn again
/// they carry the present name only.
#[test]
fn the_former_name_of_the_rest_angle_attribute_is_read_and_replaced() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let primitive = d.quad(json!({"POSITION": position}));
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0}));
    let present = wear("present_name", &d.glb(), None);
    let (mut json, binary) = split_glb(&present).unwrap();
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap();
    let index = attributes.shift_remove(REST_ANGLE_CHANGE_ATTRIBUTE).unwrap();
    attributes.insert(FORMER_REST_ANGLE_ATTRIBUTE.into(), index);
    let former = join_glb(&json, &binary.unwrap());
    let [asset, old_asset] = [&present, &former].map(|glb| read("rest_angle", glb, None));
    let angles = read_worn(&old_asset).unwrap().rest_angle_deg;
    assert!(angles.iter().any(|angle| *angle != 0.0));
    assert_eq!(angles, read_worn(&asset).unwrap().rest_angle_deg);
    let garment = garment(&old_asset);
    let again = write_worn_glb(&old_asset, &garment, &some_wear(&garment), &extras()).unwrap();
    let (json, _) = split_glb(&again).unwrap();
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().unwrap();
    assert!(attributes.contains_key(REST_ANGLE_CHANGE_ATTRIBUTE));
    assert!(!attributes.contains_key(FORMER_REST_ANGLE_ATTRIBUTE));
}

const TWO_GROUPS: &str = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 50 50 10\nv 100 0 0\nv 100 50 10\n\
    vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n\
    g left\nusemtl blue\nf 1/1 2/2 3/3\nf 3/3 2/2 4/4\ng right\nusemtl red\nf 2 5 4\nf 4 5 6\ng again\nusemtl blue\nf 1/4 3/3 2/2\n";

#[test]
fn an_obj_becomes_a_document_in_metres() {
    let options = ReadOptions {
        unit_m: Some(0.01),
        any_size: true,
        garment: Some("right".into()),
        ..Default::default()
    };
    let (asset, _) =
        read_asset("dir/shirt.v2.obj", TWO_GROUPS.as_bytes(), &options, &mut |_| Ok(Vec::new())).unwrap();
    let glb = wear_asset("obj", &asset);
    let file = gltf::Gltf::from_slice(&glb).expect("the gltf crate finds it valid");
    let mesh = file.meshes().next().unwrap();
    assert_eq!(mesh.name(), Some("shirt.v2"));
    assert_eq!(mesh.primitives().count(), asset.pieces.len());
    let materials: Vec<_> = mesh.primitives().map(|p| p.material().name().map(str::to_owned)).collect();
    assert_eq!(materials[0].as_deref(), Some("blue"));
    assert_eq!(materials[1].as_deref(), Some("red"));
    assert_eq!(file.materials().count(), 2, "one material for each name");
    for (piece, primitive) in asset.pieces.iter().zip(mesh.primitives()) {
        let reader = primitive.reader(|_| file.blob.as_deref());
        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        assert_eq!(positions.len(), piece.positions.len());
        for (found, wanted) in positions.iter().zip(&piece.positions) {
            assert!((Vector3::from(found.map(f64::from)) - wanted * 0.01).norm() < 1e-7);
        }
        let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(corners, piece.triangles.as_flattened());
        assert_eq!(reader.read_tex_coords(0).is_some(), piece.uvs.is_some());
    }
}

#[test]
fn parts_that_do_not_belong_together_are_rejected_with_all_errors() {
    let asset = read("quad.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", None);
    let mut garment = garment(&asset);
    let mut worn = some_wear(&garment);
    garment.source_point.pop();
    worn.displacement[0].x = f64::NAN;
    worn.memory.rest_angle.push(0.0);
    let message = write_worn_glb(&asset, &garment, &worn, &Value::Null).unwrap_err().to_string();
    for part in ["source_point", "finite displacement", "rest_angle"] {
        assert!(message.contains(part), "{part} missing in {message}");
    }
    worn.displacement.pop();
    assert!(write_worn_glb(&asset, &garment, &worn, &json!([1])).is_err());
}

/// Foreign files.
#[needs_data("garments")]
#[test]
fn real_files_come_back_whole_with_a_worn_target() {
    let folder = external("garments");
    let files = [
        ("khronos-small/RiggedFigure.glb", 1.0),
        ("khronos-small/AnimatedMorphCube.glb", 1.0),
        ("khronos-small/SimpleSkin.gltf", 1.0),
        ("khronos-small/SimpleSparseAccessor.gltf", 1.0),
        ("khronos-small/BoxInterleaved.glb", 1.0),
        ("makehuman-body-sweater/derived/mh_sweater_left_elbow.glb", 1.0),
        ("diffavatar-tshirt/tshirt.obj", 0.01),
        ("diffcloth-tshirt-folds/tshirt1900-flattened.obj", 0.065),
    ];
    for (file, unit_m) in files {
        let path = folder.join(file);
        let bytes = std::fs::read(&path).expect(file);
        let folder = path.parent().unwrap();
        let mut resolve = |uri: &str| Ok(std::fs::read(folder.join(uri)).unwrap());
        let options = ReadOptions { unit_m: Some(unit_m), any_size: true, ..Default::default() };
        let (asset, _) = read_asset(file, &bytes, &options, &mut resolve).unwrap();
        let (garment, _) = Garment::from_asset(&asset).unwrap();
        wear_garment(path.file_stem().unwrap().to_str().unwrap(), &asset, &garment);
        let worn = some_wear(&garment);
        let sidecar = Sidecar::new(&asset, &garment, &worn, json!({}), json!({}), json!({})).unwrap();
        assert_eq!(read_sidecar("again", &write_sidecar(&sidecar)).unwrap(), sidecar);
    }
}

/// Pictures of base colour and normals go beside a USD scene, which reads them by the first texture coordinates; others are left out.
#[test]
fn usd_scenes_have_the_textures_of_the_file() {
    let mut d = Document::new();
    let position = d.positions(&QUAD);
    let uv = d.floats("VEC2", 2, &[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    let mut primitive = d.quad(json!({"POSITION": position, "TEXCOORD_0": uv}));
    primitive["material"] = json!(0);
    let png = d.view(&[0x89, b'P', b'N', b'G', 1, 2, 3], None);
    d.push("images", json!({"bufferView": png, "mimeType": "image/png"}));
    d.push("images", json!({"uri": "data:image/jpeg;base64,/9j/4A=="}));
    d.push("samplers", json!({"wrapS": 33_071}));
    d.push("textures", json!({"source": 0, "sampler": 0}));
    d.push("textures", json!({"source": 1}));
    d.push(
        "materials",
        json!({"name": "checked", "alphaMode": "MASK", "alphaCutoff": 0.25, "normalTexture": {"index": 1},
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1], "roughnessFactor": 0.7}}),
    );
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0}));
    let scene = |asset: &SourceAsset| {
        let garment = garment(asset);
        let fabric = crease::Fabric::preset("denim").unwrap();
        let mut worn = some_wear(&garment);
        worn.memory.rest_angle.clone_from(&worn.memory.source_angle);
        let file = crease::Export::Usd.make("shirt", asset, &garment, &worn, &fabric, None).unwrap();
        (String::from_utf8(file.bytes).unwrap(), file.beside)
    };
    let asset = read("usd", &d.glb(), None);
    let (text, beside) = scene(&asset);
    let names: Vec<(&str, usize)> = beside.iter().map(|(name, bytes)| (name.as_str(), bytes.len())).collect();
    assert_eq!(names, [("texture-0.png", 7), ("texture-1.jpg", 4)]);
    let path = "/Garment/Materials/Surface_checked";
    for line in [
        "asset inputs:file = @./shirt.texture-0.png@",
        "asset inputs:file = @./shirt.texture-1.jpg@",
        "float4 inputs:scale = (0.5, 1, 1, 1)",
        "float4 inputs:bias = (-1, -1, -1, 0)",
        "token inputs:wrapS = \"clamp\"",
        "float inputs:opacityThreshold = 0.25",
        "float inputs:roughness = 0.7",
        &format!("color3f inputs:diffuseColor.connect = <{path}/BaseColour.outputs:rgb>"),
        &format!("normal3f inputs:normal.connect = <{path}/NormalMap.outputs:rgb>"),
    ] {
        assert!(text.contains(line), "{line}");
    }
    assert!(!text.contains("color3f inputs:diffuseColor = "), "the texture counts, with the factor in it");

    // A texture that is transformed would be shown elsewhere: its factor counts alone.
    let mut moved = asset;
    let optics = &mut moved.document.as_mut().unwrap().json["materials"][0]["pbrMetallicRoughness"];
    optics["baseColorTexture"]["extensions"] = json!({"KHR_texture_transform": {"scale": [2, 2]}});
    let (text, beside) = scene(&moved);
    assert_eq!(beside.len(), 1);
    assert!(text.contains("color3f inputs:diffuseColor = (0.5, 1, 1)") && !text.contains("texture-0"));
}
