//! Runs that do nothing, or nearly nothing: each says so on standard error and in its report, with what helps, and ends with
//! exit code 3 where the result is empty.

#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use common::{Pose, crease_in, wavy_sheet, write, write_script};
use crease::internal::bake::Bake;
use crease::internal::wear::{Action, Hold, WearScript};
use crease::{Fabric, GarmentFile};
use crease_model::error::Message;
use document::Document;
use serde_json::{Value, json};
use shapes::*;
use std::path::Path;

fn report_in(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("out.report.json")).expect("has a report");
    serde_json::from_slice(&bytes).expect("is JSON")
}

/// Runs a line that ends with `code` and warns in the words `parts`, on standard error and in the report alike. The reason why a
/// result is empty is the error of the run.
fn warns(folder: &Path, line: &str, code: i32, parts: &[&str]) {
    for name in ["out.glb", "out.report.json"] {
        let _ = std::fs::remove_file(folder.join(name));
    }
    let (_, error, ended) = crease_in(folder, line);
    assert_eq!(ended, code, "{error}");
    let report = report_in(folder);
    let warnings = report["warnings"].as_array().expect("a list");
    let has_all = |text: &str| parts.iter().all(|part| text.contains(part));
    assert!(warnings.iter().any(|w| w.as_str().is_some_and(has_all)), "{parts:?}: {warnings:#?}");
    let told = error.lines().filter(|line| line.contains("warning: ") || line.starts_with("error: "));
    assert!(told.into_iter().any(has_all), "{parts:?}: {error}");
    assert!(folder.join("out.glb").exists(), "the result is written all the same");
}

/// A sleeve on an arm, and a prop beside them, which no joint moves.
fn sleeve_and_prop() -> Vec<u8> {
    let mut document = empty();
    let skin = add_arm(&mut document, [Some("upperarm"), Some("lowerarm")], "hips");
    for (part, radius) in [("sleeve", 0.06), ("arm", 0.05)] {
        let positions = tube(radius, 0.5);
        let mesh = add_tube(&mut document, &positions, true);
        bind(&mut document, mesh, &positions);
        add_node(&mut document, json!({"name": part, "mesh": mesh, "skin": skin}));
    }
    let mesh = add_tube(&mut document, &tube(0.02, 0.1), true);
    let prop = add_node(&mut document, json!({"name": "prop", "mesh": mesh}));
    let bent: Vec<f32> = [about_y(0.0), about_y(60.0)].concat();
    let clip = |document: &mut Document, name: &str, node: usize, times: &[f32], values: &[f32]| {
        add_clip(document, name, node, "rotation", times, values);
    };
    clip(&mut document, "elsewhere", prop, &[0.0, 0.3], &bent);
    clip(&mut document, "pose", 0, &[0.0], &about_y(0.0));
    clip(&mut document, "bent", 0, &[0.0], &about_y(60.0));
    clip(&mut document, "wave", 0, &[0.0, 0.3], &bent);
    document.glb()
}

const DRESSED: &str = "bake in.glb --garment sleeve --body in.glb --body-node arm --hold none --wear w.json -o out.glb --quality draft";

#[test]
fn a_clip_that_moves_something_else_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, "in.glb", sleeve_and_prop());
    write_script(folder, "w.json", r#"{"play": {"clip": "elsewhere"}}"#);
    warns(folder, DRESSED, 3, &["action 1 of the script, `play`, moves no vertex of the body", "--explain"]);
    let warnings = report_in(folder)["warnings"].to_string();
    assert!(warnings.contains("it moves nothing of the body"), "{warnings}");
    let (_, error, _) = crease_in(folder, DRESSED);
    assert!(error.contains("nothing is remembered"), "{error}");
    // A clip that moves the arm says neither.
    write_script(folder, "w.json", r#"{"play": {"clip": "wave"}}"#);
    let (_, error, _) = crease_in(folder, DRESSED);
    let warnings = report_in(folder)["warnings"].to_string();
    assert!(!error.contains("of the body:") && !warnings.contains("moves no"), "{error}\n{warnings}");
}

/// A pose in place of a clip: that of the file, and another one, into which the body is moved.
#[test]
fn a_clip_of_one_key_is_told_where_it_moves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, "in.glb", sleeve_and_prop());
    write_script(folder, "w.json", r#"{"play": {"clip": "pose"}}"#);
    warns(folder, DRESSED, 3, &["`play`, moves no vertex of the body", "--explain"]);
    write_script(folder, "w.json", r#"{"play": {"clip": "bent"}}"#);
    let (_, error, _) = crease_in(folder, DRESSED);
    let report = report_in(folder);
    assert!(report["simulated_s"].as_f64().is_some_and(|t| t > 0.1), "{report}");
    assert!(!error.contains("moves no") && !report["warnings"].to_string().contains("moves no"), "{error}");
}

/// A joint that moves nothing of the body is an error, before the run.
#[test]
fn a_joint_of_other_parts_is_refused_with_those_that_move_the_body() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, "in.glb", sleeve_and_prop());
    write_script(folder, "w.json", r#"{"bend": {"joint": "prop", "axis": "y", "angle": 40}}"#);
    for line in [DRESSED, &DRESSED.replace(" -o out.glb", " --explain")] {
        let (_, error, code) = crease_in(folder, line);
        assert_eq!(code, 1, "{error}");
        for part in ["actions[0].bend.joint", "moves no vertex of the body", "upperarm", "lowerarm"] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
    assert!(!folder.join("out.glb").exists());
}

#[test]
fn a_garment_beside_its_body_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, "in.glb", sleeve_and_prop());
    write(folder, "sheet.obj", wavy_sheet(6, 0.003, Pose::Lying).replace("v ", "v 3"));
    write_script(folder, "w.json", r#"{"play": {"clip": "wave"}}"#);
    let line =
        "bake sheet.obj --body in.glb --body-node arm --wear w.json -o out.glb --quality draft --force-size";
    warns(folder, line, 3, &["never comes nearer to the body than", "--unit", "--body-unit"]);
    let (_, error, _) = crease_in(folder, line);
    assert!(error.contains("nothing is remembered") && error.contains("not on the body"), "{error}");
}

/// A wear script made in code, without the checks of its file.
#[test]
fn an_action_that_takes_no_time_is_told() {
    let sheet = GarmentFile::sheet([0.2, 0.2], [4, 4]).expect("is a sheet").garment;
    let fabric = Fabric::preset("kow-tshirt").expect("exists");
    let told = |for_s: f64| {
        let hang = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front", "over": 0.1}}]}"#;
        let mut script = WearScript::parse("w.json", hang).expect("is valid");
        script.actions.push(Action::Hold(Hold { for_s }));
        let baked = Bake::new(&sheet, &fabric, &script).run().expect("runs");
        assert!(baked.report.empty_reason.is_some(), "nothing is remembered");
        Message::join(baked.report.warnings, "\n")
    };
    let warnings = told(0.0);
    let expected =
        "action 2 of the script, `hold`, takes no time, so that nothing happens in it: give it a duration";
    assert!(warnings.contains(expected), "{warnings}");
    assert!(!told(0.1).contains("takes no time"));
}

/// Memory of a folded sheet for a mesh whose mask is 0, or that is somewhere else.
#[test]
fn a_transfer_of_nothing_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let sheet = wavy_sheet(8, 0.002, Pose::Hanging);
    write(folder, "sheet.obj", &sheet);
    write_script(
        folder,
        "w.json",
        r#"{"lay": {"facing": "front", "over": 0.2}}, {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.4,
            "hold": 2}}"#,
    );
    let (_, error, code) = crease_in(folder, "bake sheet.obj --wear w.json -o worn.glb --quality draft");
    assert_eq!(code, 0, "{error}");
    // Vertex colours: black, and white.
    let coloured = |grey: &str| -> String {
        let line = |line: &str| match line.starts_with('v') {
            true => format!("{line} {grey} {grey} {grey}\n"),
            false => format!("{line}\n"),
        };
        sheet.lines().map(line).collect()
    };
    write(folder, "black.obj", coloured("0"));
    write(folder, "white.obj", coloured("1"));
    let transfer =
        |to: &str, options: &str| format!("transfer worn.crease.json --to {to} -o out.glb{options}");
    warns(folder, &transfer("black.obj", " --mask COLOR_0.r"), 3, &["nothing was transferred", "mask is 0"]);
    let (_, error, code) = crease_in(folder, &transfer("white.obj", " --mask COLOR_0.r"));
    assert!(code == 0 && !error.contains("warning"), "{error}");

    // The fold has changed no length, and without memory nothing.
    let only = transfer("white.obj", " --only bagging");
    warns(folder, &only, 3, &["nothing was transferred", "leave out --only bagging"]);
    let (_, error, code) = crease_in(folder, &transfer("white.obj", " --strength 0"));
    assert_eq!(code, 0, "asked for: {error}");
    let elastic = "bake sheet.obj --wear w.json -o unworn.glb --quality draft --memory off";
    let (_, error, code) = crease_in(folder, elastic);
    assert_eq!(code, 0, "{error}");
    let unworn = "transfer unworn.crease.json --to white.obj -o out.glb";
    warns(folder, unworn, 3, &["nothing was transferred", "the source remembers nothing"]);

    // The other one lies three metres away, and nobody lays it on the source.
    write(folder, "far.obj", sheet.replace("v ", "v 3"));
    let far = transfer("far.obj", " --align none --match surface --force-size");
    warns(folder, &far, 3, &["nothing was transferred", "--align", "--match", "--landmarks"]);
    // One that reaches far beyond the source takes its fold, and the rest is doubtful.
    let wide: String = sheet
        .lines()
        .map(|line| match line.strip_prefix("v ").and_then(|numbers| numbers.split_once(' ')) {
            Some((x, rest)) => format!("v {} {rest}\n", 3.0 * x.parse::<f64>().expect("a number") - 0.2),
            None => format!("{line}\n"),
        })
        .collect();
    write(folder, "wide.obj", wide);
    let wide = transfer("wide.obj", " --align none --match surface");
    warns(folder, &wide, 0, &["low confidence", "--landmarks", "--align", "--match"]);
}
