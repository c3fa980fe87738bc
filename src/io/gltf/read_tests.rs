//! Tests of reading glTF documents: transforms, layouts, skins, names, and damaged files.

use crate::gltf::join_glb;
use crate::{ReadOptions, read_asset};
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::{ImportDiagnostic, SourceAsset, UpAxis};
use serde_json::{Value, json};

fn read_with(
    document: &Value,
    binary: &[u8],
    options: &ReadOptions,
) -> crease_model::error::Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    read_asset("test.glb", &join_glb(document, binary), options, &mut |uri| {
        Err(crease_model::error::Error::input(uri, "", "asked for", ""))
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
    let (asset, diagnostics) = read(&document, &binary);
    let kept = asset.document.unwrap();
    assert_eq!(kept.json.to_string(), document.to_string());
    assert_eq!(kept.buffers, [binary]);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
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
    // x is doubled, moved along z, then rotated by a quarter about z.
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
    let (asset, diagnostics) = read(&document, &binary);
    let piece = &asset.pieces[0];
    assert_eq!(piece.positions[1], Vec3::new(100.0, 0.0, 0.0));
    assert_eq!(piece.positions[2], Vec3::new(7.0, 8.0, 9.0), "the sparse row replaces");
    assert_eq!(piece.uvs.as_ref().unwrap()[0], Vec2::new(0.0, 1.0));
    assert!((piece.uvs.as_ref().unwrap()[1].x - 32768.0 / 65535.0).abs() < 1e-15);
    assert_eq!(piece.normals.as_ref().unwrap()[0], Vec3::y(), "zero normals (no buffer view) are mended");
    assert!(diagnostics.iter().any(|f| f.message.starts_with("3 normals")), "{diagnostics:?}");
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
    let (asset, diagnostics) = read(&document, &binary);
    let at = |v| asset.pieces[0].scene_position(v).unwrap();
    assert!((at(0) - Vec3::new(0.25, 0.75, 0.0)).norm() < 1e-12, "{}", at(0));
    assert!((at(1) - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-12, "weights are divided by their sum: {}", at(1));
    assert!((at(2) - Vec3::new(1.0, 1.0, 0.0)).norm() < 1e-12, "without weights the first joint: {}", at(2));
    assert!(diagnostics.iter().any(|f| f.message.contains("2 of 3 vertices")), "{diagnostics:?}");

    document["skins"] = json!([{"joints": [1]}]);
    assert!(message(&document, &binary).contains("follows joint 1"));
}

#[test]
fn each_node_of_a_mesh_of_two_is_a_piece() {
    let (mut document, binary) = triangle();
    document["nodes"] =
        json!([{"name": "Left", "mesh": 0}, {"name": "Right", "mesh": 0, "translation": [1, 0, 0]}]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    let (asset, _) = read(&document, &binary);
    assert_eq!(asset.pieces.iter().map(|piece| piece.node).collect::<Vec<_>>(), [Some(0), Some(1)]);
    let apart = asset.pieces[1].scene_position(0).unwrap() - asset.pieces[0].scene_position(0).unwrap();
    assert_eq!(apart, Vec3::x());
}

#[test]
fn pieces_are_chosen_by_all_their_names() {
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
fn damage_is_reported_with_its_location() {
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
            d["accessors"][0] = json!({"componentType": 5126, "count": 4_000_000_000_u32, "type": "VEC3"});
        }),
        ("bufferViews[0]", "which has 36", |d| d["bufferViews"][0]["byteOffset"] = json!(1)),
        ("buffers[0]", "states 99 bytes", |d| d["buffers"][0]["byteLength"] = json!(99)),
        ("accessors[0]", "unsigned whole numbers", |d| {
            d["meshes"][0]["primitives"][0]["indices"] = json!(0);
        }),
    ];
    for (location, expected, damage) in cases {
        let (mut document, binary) = triangle();
        damage(&mut document);
        let message = message(&document, &binary);
        assert!(
            message.contains(&format!("test.glb: {location}: ")) && message.contains(expected),
            "{expected}: {message}"
        );
    }
}

#[test]
fn all_damaged_primitives_are_reported() {
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
    assert_eq!(asset.pieces[0].sewing_mask, None);
    let options = ReadOptions { sewing_mask: Some("_PIN".into()), ..ReadOptions::default() };
    let (asset, _) = read_with(&document, &binary, &options).unwrap();
    assert_eq!(asset.pieces[0].sewing_mask.as_deref(), Some(&[0.0, 0.2, 1.0][..]));
    assert_eq!(asset.pieces[0].mask, None);
    let options = ReadOptions { sewing_mask: Some("_SEWN".into()), ..ReadOptions::default() };
    let message = read_with(&document, &binary, &options).unwrap_err().to_string();
    assert!(
        message.contains("_SEWN") && message.contains("ReadOptions::sewing_mask takes one of"),
        "{message}"
    );
    let options = ReadOptions { mask: Some("COLOR_0".into()), ..ReadOptions::default() };
    let message = read_with(&document, &binary, &options).unwrap_err().to_string();
    assert!(message.contains("COLOR_0") && message.contains("POSITION, _PIN"), "{message}");
}

/// A file whose hair is compressed and whose shirt is not: the shirt, by its name, is read; the hair alone is refused.
#[test]
fn one_compressed_part_does_not_refuse_the_others() {
    let (mut document, binary) = triangle();
    document["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let accessor = document["accessors"][0].clone();
    let compressed = document["accessors"].as_array().map_or(0, Vec::len);
    document["accessors"].as_array_mut().unwrap().push(accessor);
    document["accessors"][compressed].as_object_mut().unwrap().remove("bufferView");
    document["meshes"].as_array_mut().unwrap().push(json!({"primitives": [{
        "attributes": {"POSITION": compressed},
        "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}},
    }]}));
    document["nodes"][0]["name"] = json!("shirt");
    document["nodes"].as_array_mut().unwrap().push(json!({"mesh": 1, "name": "hair"}));
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    let read = |part: &str| {
        let options = ReadOptions { garment: Some(part.into()), ..ReadOptions::default() };
        read_with(&document, &binary, &options)
    };
    assert_eq!(read("shirt").unwrap().0.worn_pieces().count(), 1);
    let refusal = read("hair").unwrap_err().to_string();
    assert!(refusal.contains("meshes[1].primitives[0]") && refusal.contains("draco"), "{refusal}");
    document["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}});
    assert!(message(&document, &binary).contains("the file requires KHR_draco_mesh_compression"));
}
