//! Garments that are skinned in their file: what holds them while they are simulated on their body.

#[path = "field/character.rs"]
mod character;
#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use character::*;
use common::crease_in;
use crease::internal::bake::Bake;
use crease::{Quality, WearScript};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_io::{read_body, read_garment_skin};
use crease_model::body::{AnimatedBody, BodyPose, GarmentSkin};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourceAsset};
use shapes::*;
use std::sync::Arc;

/// A garment of a character, with its body.
struct Dressed {
    garment: Garment,
    asset: SourceAsset,
    body: Arc<AnimatedBody>,
}

impl Dressed {
    fn new(bytes: &[u8], garment: &str) -> Self {
        let (asset, _) = read_with("character.glb", bytes, &named(garment)).expect("is read");
        let (with_body, _) = read_with("character.glb", bytes, &named("body")).expect("is read");
        let pieces: Vec<_> = with_body.worn_pieces().collect();
        let body = Arc::new(read_body(&with_body, &pieces).expect("is a body"));
        Self { garment: garment_of(&asset).0, asset, body }
    }

    fn skin(&self) -> GarmentSkin {
        read_garment_skin(&self.asset, None, &self.body).expect("follows the body")
    }

    fn bake(&self, script: &str) -> crease::internal::bake::BakeResult {
        let script = WearScript::parse("w.json", script).expect("is valid");
        let fabric = Fabric::preset("kow-tshirt").expect("exists");
        let bake = Bake::new(&self.garment, &fabric, &script);
        bake.body(self.body.clone()).skin(Arc::new(self.skin())).run().expect("runs")
    }
}

fn script(actions: &str) -> String {
    format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#)
}

fn walk() -> String {
    script(r#"{"play": {"clip": "walk"}}"#)
}

fn leash_decision(bytes: &[u8], garment: &str) -> String {
    let dressed = Dressed::new(bytes, garment);
    let script = WearScript::parse("w.json", &walk()).expect("is valid");
    let fabric = Fabric::preset("kow-tshirt").expect("exists");
    let bake = Bake::new(&dressed.garment, &fabric, &script);
    let plan = bake.body(dressed.body.clone()).skin(Arc::new(dressed.skin())).plan();
    plan.decisions.into_iter().find(|d| d.name == "leash").expect("is decided").why.to_string()
}

#[test]
fn a_skin_puts_the_cloth_where_its_file_does() {
    let bytes = character(&[("skirt", skirt(12, 5))], 1.0);
    let dressed = Dressed::new(&bytes, "skirt");
    let skin = dressed.skin();
    let locations = skin.locate(&dressed.garment.points);
    let at = |pose: &BodyPose| skin.positions(&locations, &dressed.body, pose);
    for (there, x) in at(&dressed.body.rest()).into_iter().zip(&dressed.garment.points) {
        assert!((there.expect("is moved") - x).norm() < 1e-6);
    }
    // The skirt follows the hips; the root motion is left in this pose.
    let clip = dressed.body.find_clip("walk").expect("is there");
    let pose = dressed.body.clip_pose(clip, 0.5, None);
    for (there, x) in at(&pose).into_iter().zip(&dressed.garment.points) {
        assert!((there.expect("is moved") - x - Vec3::new(0.0, 0.0, 0.6)).norm() < 1e-3);
    }
}

/// Points of a refined mesh lie on triangles of the file.
#[test]
fn points_between_the_vertices_of_the_file_are_carried_between_them() {
    let bytes = character(&[("shirt", shirt(12, 5))], 1.0);
    let dressed = Dressed::new(&bytes, "shirt");
    let fine = dressed.garment.refine(0.03, &[]).garment;
    assert!(fine.points.len() > 3 * dressed.garment.points.len());
    let skin = dressed.skin();
    let there = skin.positions(&skin.locate(&fine.points), &dressed.body, &dressed.body.rest());
    for (there, x) in there.into_iter().zip(&fine.points) {
        assert!((there.expect("is moved") - x).norm() < 1e-6);
    }
}

#[test]
fn what_is_held_is_told_with_the_reason() {
    let clothes = [("skirt", skirt(16, 6)), ("hat", hat(12)), ("cape", cape(6, 9)), ("shirt", shirt(12, 9))];
    let bytes = character(&clothes, 1.0);
    let held = |garment: &str| leash_decision(&bytes, garment);
    // The waistband; the legs are under the rest.
    assert!(held("skirt").contains("16 of 96 points held") && held("skirt").contains("16 on upper borders"));
    // The upper row, and not the sides, which are parts of the same border.
    assert!(held("cape").contains("7 of 70 points held"), "{}", held("cape"));
    assert!(held("hat").contains("on upper borders") && !held("hat").contains("without a body"));
    // The trunk was cut away.
    assert!(held("shirt").contains("without a body under them"), "{}", held("shirt"));
}

/// Three kinds of cloth that nothing but the leash holds, and a shirt around a trunk that is not there, in a walk.
#[test]
fn nothing_leaves_its_leash_in_a_walk() {
    let clothes = [("skirt", skirt(16, 7)), ("hat", hat(12)), ("cape", cape(6, 9)), ("shirt", shirt(12, 9))];
    let seconds = if std::env::var_os("CREASE_FULL_SIZE").is_some() { 3.0 } else { 0.5 };
    let bytes = character(&clothes, seconds);
    for (garment, longest) in [("skirt", 0.3), ("hat", 0.1), ("cape", 0.6), ("shirt", 0.05)] {
        let dressed = Dressed::new(&bytes, garment);
        let clock = std::time::Instant::now();
        let baked = dressed.bake(&walk());
        println!("{garment}: {} steps in {:.1} s", baked.report.steps, clock.elapsed().as_secs_f64());
        let skin = dressed.skin();
        let clip = dressed.body.find_clip("walk").expect("is there");
        let root = dressed.body.root_motion(clip);
        let pose = dressed.body.clip_pose(clip, f64::from(seconds), root.as_ref());
        let there = skin.positions(&skin.locate(&dressed.garment.points), &dressed.body, &pose);
        let farthest = there.iter().zip(&baked.end).map(|(a, b)| (a.expect("is moved") - b).norm());
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest < longest, "{garment}: {farthest} m from its skin, {:?}", baked.report.warnings);
        assert!(self_intersections(&baked.end, &dressed.garment.triangles).is_empty(), "{garment}");
        let torn = baked.report.warnings.iter().any(|w| w.contains("stretched by"));
        assert!(!torn, "{garment}: {:?}", baked.report.warnings);
    }
}

/// Without its leash nothing holds the cape; the run says so and ends.
#[test]
fn what_falls_off_ends_the_run() {
    let dressed = Dressed::new(&character(&[("cape", cape(6, 9))], 2.0), "cape");
    let walks = script(r#"{"play": {"clip": "walk", "repeat": 3}}"#);
    let script = WearScript::parse("w.json", &walks).expect("is valid");
    let fabric = Fabric::preset("kow-tshirt").expect("exists");
    let bake = Bake::new(&dressed.garment, &fabric, &script).quality(Quality::Draft);
    let error = bake.body(dressed.body.clone()).run().expect_err("falls off").to_string();
    assert!(
        error.contains("points has fallen off the body") && error.contains("BakeOptions::skin"),
        "{error}"
    );
}

/// Of shirt and jacket the outer one is no body to the inner one; the inner one is a body to the outer one.
#[test]
fn the_lower_layer_is_a_body_to_the_upper_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let widened = |by: f32| {
        let mut bound = shirt(14, 9);
        bound.positions.iter_mut().for_each(|p| (p[0], p[2]) = (by * p[0], by * p[2]));
        bound
    };
    let clothes = [("shirt", widened(1.0)), ("jacket", widened(1.15))];
    std::fs::write(folder.path().join("c.glb"), character(&clothes, 0.5)).expect("writes");
    std::fs::write(folder.path().join("w.json"), walk()).expect("writes");
    let body = |garment: &str, more: &str| {
        let line = format!("bake c.glb --garment {garment} --body c.glb --wear w.json --explain{more}");
        let (out, error, code) = crease_in(folder.path(), &line);
        assert_eq!(code, 0, "{error}");
        out.lines().find(|line| line.starts_with("body ")).expect("is listed").to_owned()
    };
    let count = |line: &str| -> usize {
        line.split_whitespace().nth(3).and_then(|n| n.parse().ok()).expect("a number of points")
    };
    let skin = count(&body("shirt", " --body-node body"));
    assert_eq!(count(&body("shirt", "")), skin, "the jacket lies over it");
    assert_eq!(count(&body("jacket", "")), skin + 14 * 9, "the shirt is under it");
    let triangles = |line: &str| -> usize {
        line.split_whitespace().nth(5).and_then(|n| n.parse().ok()).expect("a number of triangles")
    };
    let (all, without) = (body("shirt", ""), body("shirt", " --body-without arm.L,jacket"));
    assert!(triangles(&without) < triangles(&all), "{all} {without}");
    let line = "bake c.glb --garment shirt --body c.glb --wear w.json --explain --body-without tail";
    let (_, error, code) = crease_in(folder.path(), line);
    assert!(code == 1 && error.contains("\"tail\"") && error.contains("--body-without"), "{error}");
}

/// A second skeleton for the clothes, with equal names: its joints are those of the body.
#[test]
fn clothes_with_a_skeleton_of_their_own_follow_that_of_the_body() {
    let mut document = empty();
    let (own, _) = add_skeleton(&mut document, "Armature.clothes");
    add_bound(&mut document, "skirt", &skirt(12, 5), own);
    let (skin, first) = add_skeleton(&mut document, "Armature");
    add_bound(&mut document, "body", &body(), skin);
    add_walk(&mut document, first, 1.0);
    let dressed = Dressed::new(&document.glb(), "skirt");
    let skin = dressed.skin();
    let clip = dressed.body.find_clip("walk").expect("is there");
    let pose = dressed.body.clip_pose(clip, 0.5, None);
    let there = skin.positions(&skin.locate(&dressed.garment.points), &dressed.body, &pose);
    let moved = (there[0].expect("is moved") - dressed.garment.points[0]).z;
    assert!((moved - 0.6).abs() < 1e-3, "{moved}");
}

/// A garment that hangs on no joint has no skin, and neither has one whose skeleton the body does not have.
#[test]
fn without_a_common_skeleton_there_is_no_leash() {
    let mut document = empty();
    let (skin, first) = add_skeleton(&mut document, "Armature");
    add_bound(&mut document, "body", &body(), skin);
    let loose = add_bound(&mut document, "skirt", &skirt(12, 5), skin);
    if let Some(node) = document.json["nodes"][loose].as_object_mut() {
        node.remove("skin");
    }
    add_walk(&mut document, first, 1.0);
    let dressed = Dressed::new(&document.glb(), "skirt");
    let reason = read_garment_skin(&dressed.asset, None, &dressed.body).expect_err("no skin");
    assert!(reason.contains("no joint of the body moves the garment"), "{reason}");
}

#[test]
fn the_tool_says_what_is_held_and_can_be_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("writes");
    write("character.glb", &character(&[("skirt", skirt(12, 5))], 0.5));
    write("w.json", walk().as_bytes());
    let explain = |more: &str| {
        let line =
            format!("bake character.glb --garment skirt --body character.glb --wear w.json --explain{more}");
        crease_in(folder.path(), &line)
    };
    let leash = |text: &str| text.lines().find(|line| line.starts_with("leash")).unwrap_or("").to_owned();
    let (out, _, code) = explain("");
    assert!(code == 0 && leash(&out).contains("12 on upper borders"), "{out}");
    let (out, _, code) = explain(" --hold none");
    assert!(code == 0 && leash(&out).contains("off  switched off by --hold none"), "{out}");
    let (_, error, code) = explain(" --hold _PIN");
    assert!(code == 1 && error.contains("_PIN"), "{error}");
}
