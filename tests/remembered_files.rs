//! What `remember` makes of an animated file is drawn and shown like the result of a bake, also where garment and skin are
//! primitives of one mesh.

#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use common::crease_in;

use serde_json::{Value, json};
use shapes::*;
use std::path::Path;

/// A strip of cloth of 9 x 5 points along x, and an arm behind it, which are folded by 150 degrees at x = 0: two meshes, or two
/// primitives of one.
fn folded_strip(is_one_mesh: bool) -> Vec<u8> {
    let mut document = empty();
    document.json["materials"] = json!([{"name": "linen"}, {"name": "hide"}]);
    let skin = add_arm(&mut document, [Some("upperarm"), Some("lowerarm")], "hips");
    let strip: Vec<[f32; 3]> =
        (0..45u8).map(|k| [0.02 * f32::from(k % 9) - 0.08, 0.02 * f32::from(k / 9), 0.0]).collect();
    let squares = (0..36u16).filter(|k| k % 9 < 8);
    let corners: Vec<u16> = squares.flat_map(|a| [a, a + 1, a + 10, a, a + 10, a + 9]).collect();
    let position = document.positions(&strip);
    let indices = document.indices(&corners);
    let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
    let cloth = document.push("meshes", json!({"primitives": [primitive]}));
    let behind: Vec<[f32; 3]> = tube(0.01, 0.16).iter().map(|[x, y, z]| [*x, *y, z - 0.02]).collect();
    let arm = add_tube(&mut document, &behind, true);
    for (material, (mesh, positions)) in [(cloth, strip), (arm, behind)].into_iter().enumerate() {
        bind(&mut document, mesh, &positions);
        document.json["meshes"][mesh]["primitives"][0]["material"] = json!(material);
    }
    let meshes = if is_one_mesh {
        let other = document.json["meshes"][arm]["primitives"][0].take();
        document.json["meshes"][cloth]["primitives"].as_array_mut().expect("a list").push(other);
        document.json["meshes"].as_array_mut().expect("a list").pop();
        vec![cloth]
    } else {
        vec![cloth, arm]
    };
    for mesh in meshes {
        add_node(&mut document, json!({"name": format!("part {mesh}"), "mesh": mesh, "skin": skin}));
    }
    let bent = [about_y(0.0), about_y(150.0), about_y(150.0)].concat();
    add_clip(&mut document, "fold", 0, "rotation", &[0.0, 1.0, 5.0], &bent);
    document.glb()
}

fn run(folder: &Path, line: &str) -> String {
    let (out, error, code) = crease_in(folder, line);
    assert_eq!(code, 0, "{line}: {error}");
    out
}

/// Width of a picture, and the fraction of its bytes that differ from the background, which its first pixel shows.
fn drawn(folder: &Path, name: &str) -> (u32, f64) {
    let file = std::fs::File::open(folder.join(name)).expect("is written");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("is a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("fits")];
    let info = reader.next_frame(&mut bytes).expect("is whole");
    let size = info.color_type.samples();
    let differs = |(k, byte): (usize, &u8)| byte.abs_diff(bytes[k % size]) > 16;
    let count = bytes.iter().enumerate().filter(|one| differs(*one)).count();
    (info.width, count as f64 / bytes.len() as f64)
}

#[test]
fn a_remembered_garment_is_drawn_and_shown() {
    for is_one_mesh in [false, true] {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        std::fs::write(folder.join("arm.glb"), folded_strip(is_one_mesh)).expect("writes");
        run(folder, "remember arm.glb --garment linen --repeat 5 -o worn.glb --quiet");
        let sidecar = std::fs::read(folder.join("worn.crease.json")).expect("is written");
        let sidecar: Value = serde_json::from_slice(&sidecar).expect("is JSON");
        assert_eq!(sidecar["mesh"]["points_m"].as_array().map(Vec::len), Some(45), "the strip alone");
        for quantity in ["shape", "rest-angle-change", "stiffness"] {
            run(folder, &format!("render worn.glb -o worn.png --size 200 --show {quantity}"));
            let (width, filled) = drawn(folder, "worn.png");
            assert!(width == 200 && filled > 0.02, "{quantity}: {filled} of it is drawn");
        }
        run(folder, "view worn.glb -o worn.html");
        let page = std::fs::read_to_string(folder.join("worn.html")).expect("is written");
        assert!(page.contains("<html") && page.contains("worn.glb"), "is a page of it");
        // Beside the garment as it was.
        run(folder, "view arm.glb worn.glb -o both.html");
    }
}
