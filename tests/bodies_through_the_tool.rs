//! A body as the tool reads it beside a garment: its up axis, the plan of a bend, and names that several joints or clips have.

#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use common::{crease_in, write, write_script};
use document::Document;
use serde_json::{Value, json};
use shapes::*;
use std::fmt::Write;

/// An OBJ file of a tube of this radius from `bottom` to `top` [m], along the axis `up`.
fn upright_tube(radius: f32, bottom: f32, top: f32, up: char) -> String {
    let mut text = String::new();
    for [along, x, y] in tube(radius, top - bottom) {
        let height = along + 0.5 * (top + bottom);
        let _ = match up {
            'z' => writeln!(text, "v {x} {y} {height}"),
            _ => writeln!(text, "v {x} {height} {}", -y),
        };
    }
    for [a, b, c] in tube_corners(true).as_chunks::<3>().0 {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

/// The body comes from a program with z up, its garment from one with y up.
#[test]
fn a_body_with_another_axis_up_stands_in_its_garment() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, "dress.obj", upright_tube(0.2, 0.9, 1.4, 'y'));
    write(folder, "body.obj", upright_tube(0.15, 0.0, 1.7, 'z'));
    write_script(folder, "w.json", r#"{"settle": {"for": 0.1}}"#);
    let bake = |options: &str| {
        let line =
            format!("bake dress.obj --wear w.json -o out.glb --quality draft --body body.obj{options}");
        let (_, error, code) = crease_in(folder, &line);
        let report = std::fs::read_to_string(folder.join("out.report.json")).expect("is written");
        let report: Value = serde_json::from_str(&report).expect("is JSON");
        (error, code, report["warnings"].to_string())
    };
    let (error, _, warnings) = bake("");
    assert!(error.contains("--body-up z") && warnings.contains("--body-up z"), "{error}\n{warnings}");
    let (error, code, warnings) = bake(" --body-up z");
    assert_eq!(code, 0, "{error}");
    assert!(!error.contains("--body-up") && !warnings.contains("body"), "{error}\n{warnings}");
    // What stands upright already would lie then.
    write(folder, "body.obj", upright_tube(0.15, 0.0, 1.7, 'y'));
    let (_, code, warnings) = bake("");
    assert!(code == 0 && !warnings.contains("body"), "{warnings}");
    let (error, ..) = bake(" --body-up z");
    assert!(error.contains("--body-up y"), "{error}");
}

/// A sleeve on an arm, both bound to one skeleton; all of the sleeve has the attribute `_PIN`.
fn sleeve_on_arm(add_clips: impl FnOnce(&mut Document)) -> Vec<u8> {
    let mut document = empty();
    let skin = add_arm(&mut document, [Some("upperarm"), Some("lowerarm")], "hips");
    for (part, radius) in [("sleeve", 0.06), ("arm", 0.05)] {
        let positions = tube(radius, 0.5);
        let mesh = add_tube(&mut document, &positions, true);
        bind(&mut document, mesh, &positions);
        let pin = document.floats("SCALAR", 1, &vec![1.0; positions.len()]);
        document.json["meshes"][mesh]["primitives"][0]["attributes"]["_PIN"] = json!(pin);
        add_node(&mut document, json!({"name": part, "mesh": mesh, "skin": skin}));
    }
    add_clips(&mut document);
    document.glb()
}

#[test]
fn the_plan_of_a_bend_names_garment_body_and_joints() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let bow = |document: &mut Document| {
        let values: Vec<f32> = [about_y(0.0), about_y(20.0)].concat();
        add_clip(document, "bow", 0, "rotation", &[0.0, 0.5], &values);
    };
    write(folder, "in.glb", sleeve_on_arm(bow));
    write_script(folder, "w.json", r#"{"bend": {"joint": "lowerarm", "axis": "y", "angle": 40}}"#);
    let explain = |options: &str| {
        let line = format!(
            "bake in.glb --garment sleeve --body in.glb --body-node arm --wear w.json --explain{options}"
        );
        let (out, error, code) = crease_in(folder, &line);
        assert_eq!(code, 0, "{error}");
        out
    };
    let plan = explain("");
    let line = |name: &str| plan.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    let count = usize::from(AROUND * RINGS);
    let triangles = tube_corners(true).len() / 3;
    let garment = format!("on   {count} points, {triangles} triangles of \"sleeve\"");
    assert!(line("garment").ends_with(&garment), "{plan}");
    assert!(line("body").ends_with(&format!("in.glb: {count} points, {triangles} triangles")), "{plan}");
    let joints = line("joints");
    assert!(joints.contains("\"upperarm\" (") && joints.contains("\"lowerarm\" ("), "{plan}");
    assert!(line("static region").contains("out of reach of moving parts of the body"), "{plan}");
    assert!(line("leash").contains("on upper borders"), "{plan}");
    assert!(!plan.contains("crease remember"), "{plan}");
    // All of it is held: a simulation adds nothing.
    assert!(!explain(" --hold _PIN").contains("crease remember"), "a bend is no clip of the file");
    write_script(folder, "w.json", r#"{"play": {"clip": "bow"}}"#);
    let plan = explain(" --hold _PIN");
    let advice = plan.lines().find(|line| line.starts_with("remember instead")).unwrap_or_default();
    assert!(advice.contains("100 % of the points") && advice.contains("`crease remember`"), "{plan}");
    // As JSON, the same decisions.
    let list: Value = serde_json::from_str(&explain(" --json")).expect("is JSON");
    let names: Vec<&str> =
        list.as_array().expect("a list").iter().filter_map(|entry| entry["name"].as_str()).collect();
    assert_eq!(names[..3], ["garment", "body", "joints"]);
}

/// Programs call every clip "mixamo.com", and a file of two characters has every joint twice.
#[test]
fn what_has_the_name_of_another_is_chosen_by_its_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let bent = |degrees: f32| -> Vec<f32> { [about_y(0.0), about_y(degrees)].concat() };
    let clips = |document: &mut Document| {
        add_clip(document, "bow", 0, "rotation", &[0.0, 0.5], &bent(20.0));
        add_clip(document, "mixamo.com", 0, "rotation", &[0.0, 1.0], &bent(40.0));
        add_clip(document, "mixamo.com", 0, "rotation", &[0.0, 2.0], &bent(60.0));
    };
    write(folder, "clips.glb", sleeve_on_arm(clips));
    let mut twins = empty();
    for (part, radius) in [("arm", 0.05), ("other arm", 0.04)] {
        let positions = tube(radius, 0.5);
        let mesh = add_tube(&mut twins, &positions, true);
        let skin = add_arm(&mut twins, [Some("upper"), Some("lower")], &format!("Armature of {part}"));
        bind(&mut twins, mesh, &positions);
        add_node(&mut twins, json!({"name": part, "mesh": mesh, "skin": skin}));
    }
    write(folder, "twins.glb", twins.glb());
    let explain = |body: &str, action: &str| {
        write_script(folder, "w.json", action);
        let line = format!(
            "bake clips.glb --garment sleeve --body {body} --wear w.json --explain --hold none --quiet"
        );
        crease_in(folder, &line)
    };
    let play = |clip: &str| {
        let action = format!(r#"{{"play": {{"clip": "{clip}"}}}}"#);
        explain("clips.glb --body-node arm", &action)
    };
    let (_, error, code) = play("mixamo.com");
    assert_eq!(code, 1, "{error}");
    for part in ["actions[0].play.clip", "2 clips", "clip#1", "1.00 s", "clip#2", "2.00 s", "by its number"] {
        assert!(error.contains(part), "{part}: {error}");
    }
    assert!(!error.contains("clip#0"), "only those of that name: {error}");
    assert_eq!(play("clip#2").2, 0, "{}", play("clip#2").1);
    let (_, error, code) = play("clip#3");
    assert!(code == 1 && error.contains("no clip called"), "{error}");

    let bend = |joint: &str| {
        let action = format!(r#"{{"bend": {{"joint": "{joint}", "axis": "y", "angle": 40}}}}"#);
        explain("twins.glb", &action)
    };
    let (_, error, code) = bend("lower");
    assert_eq!(code, 1, "{error}");
    for part in ["actions[0].bend.joint", "2 joints", "joint#0", "Armature of arm", "Armature of other arm"] {
        assert!(error.contains(part), "{part}: {error}");
    }
    let second = error.match_indices("joint#").nth(1).map(|(at, _)| &error[at..at + 7]).expect("two of them");
    assert_eq!(bend(second).2, 0, "{second}: {}", bend(second).1);
}
