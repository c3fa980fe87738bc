//! Normals of the base shape in the output.

use crate::checks::numbers;
use crate::document::{Document, QUAD};
use crate::wearing::{garment, read, some_wear};
use crease_io::gltf::{split_glb, write_worn_glb};
use serde_json::{Value, json};

/// Zeros at a vertex of no triangle and at a corner, half the length, numbers that are none: readers refuse them, whoever wrote them.
#[test]
fn normals_that_are_no_unit_vectors_are_mended() {
    let up = [0.0f32, 0.0, 1.0];
    let none = [0.0f32; 3];
    for (name, mirrored, normals) in [
        ("stray", false, [up, up, up, up, none]),
        ("corner", false, [up, none, up, up, up]),
        ("mirrored", true, [none; 5]),
        ("short", false, [[0.0, 0.0, 0.5]; 5]),
        ("nan", false, [up, [f32::NAN, 0.0, 0.0], up, up, up]),
    ] {
        let mut d = Document::new();
        let rows: Vec<[f32; 3]> = QUAD.iter().copied().chain([[5.0, 0.0, 0.0]]).collect();
        let (position, normal) = (d.positions(&rows), d.floats("VEC3", 3, normals.as_flattened()));
        let primitive = d.quad(json!({"POSITION": position, "NORMAL": normal}));
        d.push("meshes", json!({"primitives": [primitive]}));
        d.push("nodes", json!({"mesh": 0, "scale": [if mirrored { -1 } else { 1 }, 1, 1]}));
        let asset = read(name, &d.glb(), None);
        let garment = garment(&asset);
        let glb = write_worn_glb(&asset, &garment, &some_wear(&garment), &Value::Null).unwrap();
        let (json, binary) = split_glb(&glb).unwrap();
        let binary = binary.unwrap();
        let primitive = &json["meshes"][0]["primitives"][0];
        let base = numbers(&json, &binary, &primitive["attributes"]["NORMAL"]);
        let target = numbers(&json, &binary, &primitive["targets"][0]["NORMAL"]);
        let lengths = |rows: &[f32]| -> Vec<f32> {
            rows.as_chunks::<3>().0.iter().map(|n| n.iter().map(|x| x * x).sum::<f32>().sqrt()).collect()
        };
        assert!(lengths(&base).iter().all(|l| (l - 1.0).abs() < 1e-3), "{name}: {base:?}");
        let worn: Vec<f32> = base.iter().zip(&target).map(|(a, b)| a + b).collect();
        assert!(lengths(&worn).iter().all(|l| (l - 1.0).abs() < 1e-3), "{name}: {worn:?}");
        assert!(base.as_chunks::<3>().0.iter().take(4).all(|n| n[2] > 0.9), "{name}: {base:?}");
    }
}
