//! Runs that cannot recover end before their script, with a report of what happened, and nothing that looks like a garment; a
//! garment that ends deep inside its body is told.

#[path = "field/character.rs"]
mod character;
#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use character::{cape, character};
use common::crease_in;
use crease::internal::bake::Bake;
use crease::internal::files::GarmentFile;
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, BodyMotion, Sequence};
use crease_model::fabric::Fabric;
use serde_json::{Value, json};
use shapes::*;
use std::path::Path;
use std::sync::Arc;

/// A folder with `in.glb` and the wear script `w.json` of `actions`.
fn folder_with(bytes: &[u8], actions: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let script = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
    std::fs::write(folder.path().join("in.glb"), bytes).expect("writes");
    std::fs::write(folder.path().join("w.json"), script).expect("writes");
    folder
}

fn report_in(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("out.report.json")).expect("has a report");
    serde_json::from_slice(&bytes).expect("is JSON")
}

/// Runs a bake that ends early; checks what is left of it, and returns the reason.
fn ends_early(folder: &Path, options: &str) -> String {
    let line = format!(
        "bake in.glb --body in.glb --wear w.json -o out.glb --quality draft --frames frames {options}"
    );
    let (_, error, code) = crease_in(folder, &line);
    assert_eq!(code, 3, "{error}");
    let report = report_in(folder);
    let stopped = &report["stopped"];
    let reason = stopped["reason"].as_str().expect("has a reason").to_owned();
    assert!(error.contains(&reason) && error.contains("out.report.json"), "{error}");
    let warnings = report["warnings"].as_array().expect("has warnings");
    assert!(warnings.iter().any(|w| w.as_str().is_some_and(|w| w.contains(&reason))), "{warnings:?}");
    assert!(stopped["time_s"].as_f64().is_some_and(|t| t > 0.0), "{stopped}");
    assert_eq!(stopped["time_s"], report["simulated_s"]);
    assert!(stopped["position_m"].as_array().is_some_and(|x| x.len() == 3), "{stopped}");
    for file in ["checkpoint", "last_frame"] {
        let name = stopped[file].as_str().expect("is kept");
        assert!(error.contains(name) && folder.join(name).is_file(), "{file}: {error}");
    }
    assert!(!folder.join("out.glb").exists() && !folder.join("out.crease.json").exists());
    reason
}

/// A sleeve bound to two joints that `clip` pulls apart.
fn sleeve_on_arm(values: &[f32]) -> Vec<u8> {
    let mut document = empty();
    let skin = add_arm(&mut document, [Some("upperarm"), Some("lowerarm")], "hips");
    for (part, radius) in [("sleeve", 0.06), ("body", 0.05)] {
        let positions = tube(radius, 0.5);
        let mesh = add_tube(&mut document, &positions, true);
        bind(&mut document, mesh, &positions);
        add_node(&mut document, json!({"name": part, "mesh": mesh, "skin": skin}));
    }
    add_clip(&mut document, "apart", 0, "translation", &[0.0, 1.5], values);
    document.glb()
}

#[test]
fn torn_cloth_ends_the_run_and_leaves_a_report() {
    let bytes = sleeve_on_arm(&[0.2, 0.0, 0.0, 2.2, 0.0, 0.0]);
    let folder = folder_with(&bytes, r#"{"play": {"clip": "apart"}}"#);
    let reason = ends_early(folder.path(), "--garment sleeve --body-node body");
    assert!(reason.contains("torn") && reason.contains("times its length"), "{reason}");
    // The garment of an earlier run is left alone and told.
    std::fs::write(folder.path().join("out.glb"), "earlier").expect("writes");
    let line = "bake in.glb --body in.glb --body-node body --garment sleeve --wear w.json -o out.glb --quality draft --frames frames --quiet --resume";
    let (_, _, code) = crease_in(folder.path(), line);
    assert_eq!(code, 3, "resumed, it ends as before");
    let warnings = report_in(folder.path())["warnings"].to_string();
    assert!(warnings.contains("out.glb is of an earlier run"), "{warnings}");
    assert_eq!(std::fs::read(folder.path().join("out.glb")).expect("is there"), b"earlier");
}

#[test]
fn what_falls_off_leaves_a_report() {
    let bytes = character(&[("cape", cape(6, 9))], 2.0);
    let folder = folder_with(&bytes, r#"{"play": {"clip": "walk", "repeat": 3}}"#);
    let reason = ends_early(folder.path(), "--garment cape --body-node body --hold none");
    assert!(reason.contains("has fallen off the body"), "{reason}");
}

/// A batch names the reason, and takes nothing for its result.
#[test]
fn a_batch_names_a_run_that_ended_early() {
    let bytes = character(&[("cape", cape(6, 9))], 2.0);
    let folder = folder_with(&bytes, r#"{"play": {"clip": "walk", "repeat": 3}}"#);
    let jobs = json!({
        "format": "crease-batch/1", "garments": ["in.glb"], "wear": ["w.json"], "fabrics": ["denim"],
        "bake": ["--garment", "cape", "--body", "in.glb", "--body-node", "body", "--hold", "none", "--quality", "draft"]
    });
    std::fs::write(folder.path().join("jobs.json"), jobs.to_string()).expect("writes");
    let (_, error, code) = crease_in(folder.path(), "batch jobs.json");
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("1 of 1 jobs ended early"), "{error}");
    let summary = std::fs::read(folder.path().join("worn/summary.json")).expect("has a summary");
    let summary: Value = serde_json::from_slice(&summary).expect("is JSON");
    let job = &summary["list"][0];
    assert_eq!((job["state"].as_str(), &job["outputs"]), (Some("not_converged"), &json!({})), "{job}");
    assert!(job["message"].as_str().is_some_and(|m| m.contains("has fallen off the body")), "{job}");
}

/// A cube of this half width [m] around `centre`, outwards.
fn cube(half: f64, centre: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sign = |k: u32, bit: u32| if k & bit > 0 { half } else { -half };
    let corners = (0..8).map(|k| centre + Vec3::new(sign(k, 1), sign(k, 2), sign(k, 4))).collect();
    let sides = [[0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [0, 2, 3, 1], [4, 5, 7, 6]];
    (corners, sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The reason why a sheet of 0.2 m at the origin does not end on a body of these `frames`, 30 per second.
fn reason_inside(frames: Vec<Vec<Vec3>>, triangles: &[[u32; 3]]) -> Option<String> {
    let sheet = GarmentFile::sheet([0.2, 0.2], [4, 4]).expect("is a sheet").garment;
    let first = frames[0].clone();
    let motion = BodyMotion::Sequence(Sequence { rate: 30.0, frames });
    let body = AnimatedBody::new("body", "", motion, &first, triangles);
    let script = r#"{"format": "crease-wear/1", "actions": [{"play": {"clip": "frames"}}]}"#;
    let script = WearScript::parse("w.json", script).expect("is valid");
    let fabric = Fabric::preset("kow-tshirt").expect("exists");
    let baked = Bake::new(&sheet, &fabric, &script).body(Arc::new(body)).run().expect("runs");
    baked.report.inside_body_reason
}

/// A body that comes faster than the cloth gets out of its way swallows it: no triangle crosses it then.
#[test]
fn cloth_that_ends_deep_inside_its_body_is_told() {
    let rising = |top: [f64; 4]| -> Vec<Vec<Vec3>> {
        top.iter().map(|top| cube(0.8, Vec3::new(0.1, top - 0.8, 0.1)).0).collect()
    };
    let triangles = cube(1.0, Vec3::zeros()).1;
    let reason = reason_inside(rising([-0.2, -0.2, 0.15, 0.15]), &triangles).expect("is inside");
    // The mesh on the body is finer than the 25 points of the file.
    let words: Vec<&str> = reason.split(' ').collect();
    let told = words.windows(4).find(|of| of[1] == "of" && of[3] == "simulated").expect("counts points");
    assert_eq!(told[0], told[2], "{reason}");
    // One that grows, beside the sheet at first.
    let growing: Vec<Vec<Vec3>> =
        [0.55, 0.55, 0.9, 0.9].iter().map(|half| cube(*half, Vec3::new(-0.7, 0.0, 0.1)).0).collect();
    let reason = reason_inside(growing, &triangles).expect("is inside");
    assert!(reason.contains("lie deeper than 30 mm"), "{reason}");
    // One that comes slowly carries it.
    assert_eq!(reason_inside(rising([-0.01, -0.005, 0.0, 0.005]), &triangles), None);
}
