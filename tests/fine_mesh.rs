//! `--fine`: the finer mesh beside the worn garment.

#[path = "common/tool.rs"]
mod common;

use common::{Pose, crease_in, wavy_sheet, write, write_script};
use serde_json::Value;

/// A sheet that is folded and held, in a folder of its own.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "a.obj", wavy_sheet(8, 0.001, Pose::Lying));
    let fold = r#"{"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 5}}"#;
    let lay = r#"{"lay": {"facing": "front", "over": 0.1}}"#;
    write_script(
        folder.path(),
        "w.json",
        &format!(r#"{lay}, {fold}, {{"unfold": {{"all": true, "over": 0.5}}}}"#),
    );
    folder
}

fn report(folder: &std::path::Path, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(name)).expect("is written");
    serde_json::from_str(&text).expect("is JSON")
}

#[test]
fn a_folded_sheet_gets_vertices_along_its_crease() {
    let folder = folder();
    let bake = |name: &str, threads: u8| {
        let line =
            format!("bake a.obj --wear w.json -o {name}.glb --quality draft --fine --threads {threads}");
        let (_, error, code) = crease_in(folder.path(), &line);
        assert_eq!(code, 0, "{error}");
        error
    };
    let error = bake("one", 1);
    let told = error.lines().find(|line| line.starts_with("one.fine.glb")).unwrap_or_default();
    assert!(told.ends_with("triangles; 0 crossings"), "{error}");
    let sizes = error.lines().find(|line| line.starts_with("written: ")).unwrap_or_default();
    assert!(sizes.contains("one.glb ") && sizes.contains("one.fine.glb "), "{error}");
    let report_of_one = report(folder.path(), "one.report.json");
    let fine = &report_of_one["fine"];
    assert_eq!((&fine["file"], &fine["crossings"]), (&"one.fine.glb".into(), &0.into()));
    let vertices = fine["vertices"].as_u64().expect("a number");
    assert!((300..6000).contains(&vertices), "81 vertices of the file, {vertices} of the finer mesh");
    let files = report_of_one["files"].as_array().expect("is a list");
    let size = |name: &str| std::fs::metadata(folder.path().join(name)).expect("is there").len();
    let known = files.iter().find(|file| file["file"] == "one.fine.glb").expect("is in the list");
    assert_eq!(known["bytes"], size("one.fine.glb"));
    // Equal inputs give equal bytes, whatever the number of threads.
    bake("two", 2);
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("is written");
    assert!(read("one.fine.glb") == read("two.fine.glb"));
    // It is a garment like any other, and names no sidecar.
    let (_, error, code) = crease_in(folder.path(), "render one.fine.glb -o fine.png --size 64");
    assert_eq!(code, 0, "{error}");
    let line = "transfer one.crease.json --to a.obj -o three.glb --fine";
    let (_, error, code) = crease_in(folder.path(), line);
    assert_eq!(code, 0, "{error}");
    assert!(size("three.fine.glb") > size("three.glb"));
    assert_eq!(report(folder.path(), "three.report.json")["fine"]["crossings"], 0);
}

#[test]
fn the_finer_mesh_needs_a_place_beside_the_garment() {
    let folder = folder();
    let (_, error, code) = crease_in(folder.path(), "bake a.obj --wear w.json -o - --fine");
    assert_eq!(code, 1, "{error}");
    assert!(error.contains("--fine needs a place of its own"), "{error}");
}
