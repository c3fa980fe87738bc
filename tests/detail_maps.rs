//! Normal maps of wrinkles for textures as people make them: halves that mirror one another in one place of the texture, and
//! garments without texture coordinates.

#[path = "common/tool.rs"]
mod common;
#[path = "common/glb.rs"]
mod glb;

use common::{Pose, crease_in, wavy_sheet};
use crease_io::gltf::DetailOutput;
use glb::{Part, detail_map, glb as file, json_of};
use serde_json::{Value, json};

/// The map of one primitive, and the worn file, where the height of wrinkles at (x, y) is `height` [m].
fn mapped(part: Part, height: impl Fn(f64, f64) -> f64) -> (DetailOutput, Value) {
    let name = |json: &mut Value| json["materials"] = json!([{"name": "linen"}]);
    detail_map(&file(&[("cloth", vec![part.of(0)])], name), |p| height(p.x, p.y), 128)
}

/// Two halves, left and right of x = 0, whose texture is one: the right one is the mirror image of the left one.
fn mirrored_halves() -> Part {
    let mut both = Part::sheet(6, 0.2, [-0.1, 0.0, 0.0]);
    let right = Part::sheet(6, 0.2, [0.1, 0.0, 0.0]).textured(|[u, v]| [1.0 - u, v]);
    let first = both.positions.len() as u32;
    both.triangles.extend(right.triangles.iter().map(|t| t.map(|v| v + first)));
    both.positions.extend(right.positions);
    both.uvs.extend(right.uvs);
    both
}

fn ripple(x: f64, y: f64) -> f64 {
    0.003 * (130.0 * x + 40.0 * y + 200.0 * x * x).sin()
}

#[test]
fn mirrored_halves_share_their_map_where_their_wrinkles_mirror_one_another() {
    let (output, json) = mapped(mirrored_halves(), |x, y| ripple(x.abs(), y));
    let map = &output.maps[0];
    assert!(map.in_material && map.conflicting_fraction < 0.05, "{}", map.conflicting_fraction);
    assert!(map.mean_tilt_deg > 1.0, "there are wrinkles: {}", map.mean_tilt_deg);
    assert!(json["materials"][0]["normalTexture"].is_object(), "{:?}", output.notes);
    assert!(!output.notes.iter().any(|note| note.contains("contradict")), "{:?}", output.notes);
    // Wrinkles of one side cannot be in the texture of both.
    let (output, json) = mapped(mirrored_halves(), ripple);
    assert!(!output.maps[0].in_material && json["materials"][0].get("normalTexture").is_none());
    let told = output.notes.iter().find(|note| note.contains("contradict")).expect("is told");
    assert!(told.contains("linen") && told.contains("give every part its own place"), "{told}");
}

/// An OBJ file without `vt`.
#[test]
fn a_garment_without_texture_coordinates_is_told_what_it_lacks() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.obj"), wavy_sheet(4, 0.003, Pose::Hanging)).expect("writes");
    let script = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front", "over": 0.1}}]}"#;
    std::fs::write(folder.path().join("w.json"), script).expect("writes");
    let line = "bake a.obj --wear w.json -o out.glb --quality draft --resolution 25 --detail-map=64";
    let (_, error, code) = crease_in(folder.path(), line);
    assert_eq!(code, 0, "{error}");
    let told = error.lines().find(|line| line.contains("texture coordinates")).unwrap_or_default();
    assert!(told.contains("no texture coordinates and gets no map") && told.contains("unwrap"), "{error}");
    let report = std::fs::read_to_string(folder.path().join("out.report.json")).expect("is written");
    assert!(report.contains("no texture coordinates and gets no map"), "{report}");
    let glb = std::fs::read(folder.path().join("out.glb")).expect("is written");
    assert!(json_of(&glb).get("images").is_none(), "there is no map in it");
}
