//! Garment and body that were not read as they were meant: another unit than either was read in, another pose than that of the
//! file, several parts of one name.

#[path = "common/tool.rs"]
mod common;
#[path = "common/glb.rs"]
mod glb;

use common::{crease_in, write};
use glb::{Part, glb};
use serde_json::{Value, json};
use std::path::Path;

/// A tube open at both ends, of radius `radius` and length `height` along y around `centre`, as an OBJ file.
fn tube_obj(name: &str, radius: f64, height: f64, centre: [f64; 3], rings: usize) -> String {
    let around = 24;
    let mut text = format!("o {name}\n");
    for k in 0..around * rings {
        let angle = std::f64::consts::TAU * (k % around) as f64 / around as f64;
        let along = (k / around) as f64 / (rings - 1) as f64 - 0.5;
        let [x, y, z] = centre;
        text +=
            &format!("v {} {} {}\n", x + radius * angle.sin(), y + along * height, z + radius * angle.cos());
    }
    for k in 0..around * (rings - 1) {
        let (low, next) = (k + 1, k / around * around + (k + 1) % around + 1);
        text += &format!("f {low} {next} {} {}\n", next + around, low + around);
    }
    text
}

/// The warnings of a short bake in `folder` with `options`.
fn warnings(folder: &Path, options: &str) -> Vec<String> {
    let _ = std::fs::remove_file(folder.join("out/worn.report.json"));
    let line = format!("bake {options} --wear wear.json -o out/worn.glb --quiet");
    let (_, err, _) = crease_in(folder, &line);
    let report =
        std::fs::read_to_string(folder.join("out/worn.report.json")).unwrap_or_else(|_| panic!("{err}"));
    let report: Value = serde_json::from_str(&report).expect("is JSON");
    let warnings = report["warnings"].as_array().expect("is a list");
    warnings.iter().map(|text| text.as_str().expect("is text").to_owned()).collect()
}

fn script(folder: &Path, actions: Value) {
    write(folder, "wear.json", json!({"format": "crease-wear/1", "actions": actions}).to_string());
}

/// The boxes of a garment and a body of other units look like those of a short garment on a person: what tells them apart is that
/// far more of the garment lies on the body in another unit.
#[test]
fn a_unit_that_differs_by_an_inch_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    script(folder, json!([{"settle": {"for": 0.1}}]));
    let body = |unit: f64| tube_obj("body", 0.12 / unit, 1.0 / unit, [0.0, 1.2 / unit, 0.0], 20);
    let shirt = |unit: f64| tube_obj("shirt", 0.125 / unit, 0.5 / unit, [0.0, 1.3 / unit, 0.0], 14);
    let (inch, centimetre) = (0.0254, 0.01);
    for (garment_unit, body_unit, cure) in [
        (centimetre, centimetre, None),
        (inch, centimetre, Some("--unit in --body-unit cm")),
        (centimetre, inch, Some("--body-unit in")),
    ] {
        write(folder, "shirt.obj", shirt(garment_unit));
        write(folder, "body.obj", body(body_unit));
        let all = warnings(folder, "shirt.obj --unit cm --body body.obj");
        let told = all.iter().find(|text| text.contains("of the garment lie on the body"));
        assert_eq!(told.is_some(), cure.is_some(), "{all:?}");
        if let (Some(told), Some(cure)) = (told, cure) {
            assert!(told.contains(cure), "{told}");
            // The cure is one; the last of an option counts.
            let all = warnings(folder, &format!("shirt.obj --body body.obj {}", cured(cure)));
            assert!(!all.iter().any(|text| text.contains("of the garment lie on the body")), "{all:?}");
        }
    }
}

/// The options of a bake in centimetres with those of a `cure`.
fn cured(cure: &str) -> String {
    if cure.starts_with("--unit") { cure.to_owned() } else { format!("--unit cm {cure}") }
}

/// A body that the file shows beside the place of its clip: the garment was modelled on the first key.
#[test]
fn a_garment_that_fits_the_first_key_begins_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    script(folder, json!([{"play": {"clip": "stand"}}]));
    let write_body = |offset: f64| {
        let body = Part::can(24, 0.1, 0.8, [0.0, 1.0, 0.0]);
        let bytes = glb(&[("body", vec![body])], |document| {
            // Two keys at one place, beside the one of the node.
            let key = [offset as f32, 0.0, 0.0];
            let floats: Vec<f32> = [&[0.0, 0.5][..], &key, &key].concat();
            let uri: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
            let list = |document: &mut Value, name: &str, entry: Value| {
                let list = document[name].as_array_mut().expect("is a list");
                list.push(entry);
                list.len() - 1
            };
            let data = format!("data:application/octet-stream;base64,{}", base64(&uri));
            let buffer = list(document, "buffers", json!({"byteLength": uri.len(), "uri": data}));
            let view = |document: &mut Value, at: usize, length: usize| {
                list(
                    document,
                    "bufferViews",
                    json!({"buffer": buffer, "byteOffset": at, "byteLength": length}),
                )
            };
            let (times, values) = (view(document, 0, 8), view(document, 8, 24));
            let times = list(
                document,
                "accessors",
                json!({"bufferView": times, "componentType": 5126, "count": 2,
                "type": "SCALAR", "min": [0.0], "max": [0.5]}),
            );
            let values = list(
                document,
                "accessors",
                json!({"bufferView": values, "componentType": 5126, "count": 2, "type": "VEC3"}),
            );
            document["animations"] = json!([{"name": "stand",
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": times, "output": values}]}]);
        });
        write(folder, "body.glb", bytes);
    };
    write(folder, "shirt.obj", tube_obj("shirt", 0.105, 0.4, [0.15, 1.0, 0.0], 12));
    write_body(0.15);
    let all = warnings(folder, "shirt.obj --body body.glb");
    let told = all.iter().find(|text| text.contains("the wear begins in that key"));
    assert!(
        told.is_some_and(|text| text.contains("0 % inside the first key of the clip \"stand\"")),
        "{all:?}"
    );
    assert!(
        !all.iter().any(|text| text.contains("depenetration") || text.contains("inside the body")),
        "{all:?}"
    );
    // A key that takes the body away from the garment is not the one that it was modelled on.
    write(folder, "shirt.obj", tube_obj("shirt", 0.105, 0.4, [0.02, 1.0, 0.0], 12));
    write_body(0.9);
    let all = warnings(folder, "shirt.obj --body body.glb");
    assert!(!all.iter().any(|text| text.contains("begins in that key")), "{all:?}");
    // A garment that fits the pose of the file is led to the first key with its body.
    write(folder, "shirt.obj", tube_obj("shirt", 0.105, 0.4, [0.0, 1.0, 0.0], 12));
    write_body(0.02);
    let all = warnings(folder, "shirt.obj --body body.glb");
    assert!(!all.iter().any(|text| text.contains("begins in that key")), "{all:?}");
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for triple in bytes.chunks(3) {
        let number = (0..3).fold(0u32, |sum, k| sum << 8 | u32::from(*triple.get(k).unwrap_or(&0)));
        for k in 0..4 {
            let digit = DIGITS[(number >> (18 - 6 * k) & 63) as usize] as char;
            text.push(if k <= triple.len() { digit } else { '=' });
        }
    }
    text
}

/// Two meshes of one name are worn together, and the file says so with the numbers that tell them apart; parts of one mesh and
/// material names are no doubt.
#[test]
fn meshes_of_one_name_are_told_apart_by_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let sheet = |x: f64| Part::sheet(4, 0.4, [x, 0.0, 0.0]);
    let boots =
        glb(&[("boot", vec![sheet(0.0)]), ("lace", vec![sheet(1.0)]), ("boot", vec![sheet(2.0)])], |_| ());
    write(folder, "boots.glb", boots);
    let inspect = |file: &str, names: &str| crease_in(folder, &format!("inspect {file} --garment {names}")).0;
    let both = inspect("boots.glb", "boot");
    for part in [
        "2 meshes are called \"boot\"",
        "piece#0 (nodes[0], 32 triangles)",
        "piece#2 (nodes[2], 32 triangles)",
    ] {
        assert!(both.contains(part), "{part}: {both}");
    }
    assert!(!inspect("boots.glb", "piece#2").contains("are called"));
    assert!(!inspect("boots.glb", "lace").contains("are called"));
    // Two primitives of one mesh, and one material on two meshes.
    let coat =
        glb(&[("coat", vec![sheet(0.0).of(0), sheet(1.0).of(1)]), ("hood", vec![sheet(2.0).of(0)])], |d| {
            d["materials"] = json!([{"name": "wool"}, {"name": "silk"}]);
        });
    write(folder, "coat.glb", coat);
    for name in ["coat", "wool"] {
        assert!(!inspect("coat.glb", name).contains("are called"), "{name}");
    }
}
