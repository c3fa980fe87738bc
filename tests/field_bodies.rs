//! Bodies as people bring them: faces of any orientation, names that are not unique, clips that walk.

#[path = "common/tool.rs"]
mod common;
#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use common::crease_in;
use crease::internal::wear::WearScript;
use crease::load_body;
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, read_body};
use crease_model::body::{AnimatedBody, BodyMotion, BodyPose, Sequence, interpolate_body_pose};
use document::Document;
use serde_json::json;
use shapes::*;

fn body_of(bytes: &[u8], part: &str) -> AnimatedBody {
    let (asset, _) = read_with("body.glb", bytes, &named(part)).expect("is read");
    read_body(&asset, &asset.worn_pieces().collect::<Vec<_>>()).expect("is a body")
}

/// Arms whose faces look outwards, inwards, or as those of a shell with an inner side; one with a single face turned.
#[test]
fn a_body_faces_outwards() {
    let vertices = |radius: f32| -> Vec<Vec3> {
        tube(radius, 0.5).into_iter().map(|p| Vec3::from(p.map(f64::from))).collect()
    };
    let faces = |outwards: bool, first: u32| -> Vec<[u32; 3]> {
        let corners: Vec<u32> = tube_corners(outwards).into_iter().map(|c| first + u32::from(c)).collect();
        corners.as_chunks::<3>().0.to_vec()
    };
    let body = |points: &[Vec3], triangles: &[[u32; 3]]| {
        AnimatedBody::new("arm.glb", "", BodyMotion::Still, points, triangles)
    };
    let outer = vertices(0.1);
    let mut one_turned = faces(true, 0);
    one_turned[7].swap(0, 1);
    let shell: Vec<Vec3> = outer.iter().copied().chain(vertices(0.095)).collect();
    let shell_faces: Vec<[u32; 3]> =
        faces(true, 0).into_iter().chain(faces(false, outer.len() as u32)).collect();
    for (name, body, told) in [
        ("outwards", body(&outer, &faces(true, 0)), false),
        ("inwards", body(&outer, &faces(false, 0)), true),
        ("one turned", body(&outer, &one_turned), true),
        ("shell", body(&shell, &shell_faces), true),
    ] {
        assert_eq!(outward_fraction(body.rest_points(), body.triangles()), 1.0, "{name}");
        assert_eq!(!body.notes().is_empty(), told, "{name}: {:?}", body.notes());
    }
    // A bowl has no outside: its normals are kept.
    let bowl: Vec<[u32; 3]> = faces(false, 0).into_iter().take(8).collect();
    assert!(body(&outer, &bowl).notes().is_empty());
}

/// A body and clothes with skeletons of their own and equal names; the clothes come first.
fn clothed(names: [Option<&str>; 2]) -> Vec<u8> {
    let mut document = empty();
    for (part, radius) in [("sleeve", 0.06), ("body", 0.05)] {
        let positions = tube(radius, 0.5);
        let mesh = add_tube(&mut document, &positions, true);
        let skin = add_arm(&mut document, names, &format!("Armature.{part}"));
        bind(&mut document, mesh, &positions);
        add_node(&mut document, json!({"name": part, "mesh": mesh, "skin": skin}));
    }
    document.glb()
}

#[test]
fn joints_are_those_that_move_the_body() {
    let bytes = clothed([Some("upperarm"), Some("lowerarm")]);
    let body = body_of(&bytes, "body");
    assert_eq!(body.find_joint("lowerarm"), Ok(4), "the second armature");
    let both = body_of(&bytes, "body,sleeve").find_joint("lowerarm").expect_err("two of them");
    assert!(both.message.contains("2 joints"), "{both:?}");
    for label in ["joint#0 (nodes[0]", "joint#4 (nodes[4]", "Armature.body"] {
        assert!(both.help.contains(label), "{label}: {both:?}");
    }
    assert_eq!(body_of(&bytes, "body,sleeve").find_joint("joint#4"), Ok(4));
    // A joint of the clothes alone, and a node that is no joint.
    for idle in ["joint#0", "sleeve"] {
        let error = body.find_joint(idle).expect_err("moves nothing");
        assert!(error.message.contains("moves no vertex") && error.help.contains("lowerarm"), "{error:?}");
    }
    let unnamed = body_of(&clothed([None, None]), "body");
    let error = unnamed.find_joint("lowerarm").expect_err("has no name");
    assert!(error.help.contains("joint#4 (nodes[4], without a name"), "{error:?}");
    assert_eq!(unnamed.find_joint("joint#4"), Ok(4));
}

fn arm_with(clips: impl FnOnce(&mut Document)) -> AnimatedBody {
    let mut document = empty();
    let positions = tube(0.05, 0.5);
    let mesh = add_tube(&mut document, &positions, true);
    let skin = add_arm(&mut document, [Some("upperarm"), Some("lowerarm")], "hips");
    bind(&mut document, mesh, &positions);
    add_node(&mut document, json!({"name": "body", "mesh": mesh, "skin": skin}));
    let prop = add_tube(&mut document, &tube(0.2, 0.4), true);
    add_node(&mut document, json!({"name": "prop", "mesh": prop}));
    clips(&mut document);
    body_of(&document.glb(), "body")
}

/// Nodes of [`arm_with`].
const LOWER: usize = 0;
const HIPS: usize = 2;
const PROP: usize = 4;

#[test]
fn clips_are_those_that_move_the_body() {
    let still = [[0.0f32; 3]; 2];
    let away = [[0.2f32, 0.0, 0.0], [0.3, 0.0, 0.0]];
    let body = arm_with(|document| {
        add_clip(document, "mixamo.com", HIPS, "translation", &[0.0, 1.0], still.as_flattened());
        add_clip(document, "mixamo.com", PROP, "translation", &[0.0, 1.0], away.as_flattened());
        add_clip(document, "mixamo.com", LOWER, "translation", &[0.0, 1.0], away.as_flattened());
        add_clip(document, "twice", LOWER, "translation", &[0.0, 1.0], away.as_flattened());
        add_clip(document, "twice", LOWER, "translation", &[0.0, 2.0], away.as_flattened());
        add_clip(document, "damaged", LOWER, "translation", &[1.0, 0.0], away.as_flattened());
        add_clip(document, "cut", LOWER, "translation", &[1.0, 1.0], away.as_flattened());
    });
    assert_eq!(body.find_clip("mixamo.com"), Ok(2));
    assert_eq!(body.find_clip("clip#0"), Ok(0));
    let twice = body.find_clip("twice").expect_err("two of them");
    assert!(
        twice.help.contains("clip#3") && twice.help.contains("clip#4") && twice.help.contains("2.00 s"),
        "{twice:?}"
    );
    let damaged = body.find_clip("damaged").expect_err("is damaged");
    assert!(damaged.message.contains("animations[5]"), "{damaged:?}");
    assert_eq!(body.find_clip("cut"), Ok(6), "two keys at one time are a jump");
    let script = r#"{"format": "crease-wear/1", "actions": [{"play": {"clip": "mixamo.com"}}, {"play": {"clip": "twice"}}]}"#;
    let script = WearScript::parse("w.json", script).expect("is valid");
    let errors = script.body_errors("w.json", &body);
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0].location, "actions[1].play.clip");
}

/// Walking, turning on the spot, and beginning somewhere else: in place, the hand moves as without it.
#[test]
fn a_clip_that_walks_is_played_in_place() {
    let bend: Vec<f32> = [about_y(0.0), about_y(80.0)].concat();
    let walk = [[0.0f32, 0.0, 0.0], [0.0, 0.0, 3.5]];
    let turn = [about_y(0.0), about_y(90.0), about_y(180.0), about_y(270.0), about_y(360.0)];
    let channel = |document: &mut Document, node: usize, path: &str, times: &[f32], values: &[f32]| {
        let width = values.len() / times.len();
        let kind = if width == 3 { "VEC3" } else { "VEC4" };
        let (input, output) = (document.floats("SCALAR", 1, times), document.floats(kind, width, values));
        let clip = &mut document.json["animations"]
            .as_array_mut()
            .expect("has clips")
            .last_mut()
            .expect("one")["samplers"];
        let samplers = clip.as_array_mut().expect("a list");
        samplers.push(json!({"input": input, "output": output}));
        let number = samplers.len() - 1;
        let clip = document.json["animations"].as_array_mut().expect("has clips").last_mut().expect("one");
        let channels = clip["channels"].as_array_mut().expect("a list");
        channels.push(json!({"sampler": number, "target": {"node": node, "path": path}}));
    };
    let body = arm_with(|document| {
        let quarter = [0.0f32, 0.25, 0.5, 0.75, 1.0];
        for name in ["still", "walk", "turn", "away"] {
            add_clip(document, name, LOWER, "rotation", &[0.0, 1.0], &bend);
            match name {
                "walk" => channel(document, HIPS, "translation", &[0.0, 1.0], walk.as_flattened()),
                "turn" => channel(document, HIPS, "rotation", &quarter, turn.as_flattened()),
                "away" => {
                    channel(document, HIPS, "translation", &[0.0, 1.0], &[3.0, 0.0, 0.0, 3.0, 0.0, 0.0])
                }
                _ => {}
            }
        }
    });
    assert_eq!(body.root_motion(0), None);
    let points = |clip: usize, t: f64, in_place: bool| {
        let root = body.root_motion(clip).filter(|_| in_place);
        body.points(&body.clip_pose(clip, t, root.as_ref()))
    };
    let farthest = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    for (clip, travel) in [(1, 3.5), (2, 0.0), (3, 3.0)] {
        let root = body.root_motion(clip).expect("moves the root");
        assert!((root.travel_m - travel).abs() < 0.5, "{root:?}");
        for t in [0.0, 0.3, 0.8, 1.0] {
            let difference = farthest(&points(clip, t, true), &points(0, t, false));
            assert!(difference < 1e-6, "clip {clip} at {t} s: {difference} m");
        }
        assert!(farthest(&points(clip, 0.7, false), &points(0, 0.7, false)) > 0.3, "as it is, it moves away");
    }
    let notes = |options: &str| {
        let text =
            format!(r#"{{"format": "crease-wear/1", "actions": [{{"play": {{"clip": "walk"{options}}}}}]}}"#);
        WearScript::parse("w.json", &text).expect("is valid").body_notes(&body)
    };
    assert!(notes("")[0].contains("3.50 m") && notes("")[0].contains("upperarm"), "{:?}", notes(""));
    assert!(notes(r#", "keep_root_motion": true"#).is_empty());
    assert!(matches!(body.clip_pose(1, 0.5, None), BodyPose::Joints(_)));
}

/// Keys without interpolation, two keys at one time, a teleport within a millisecond, and frames that lie far apart: the body is moved
/// there as between two clips. What is only fast is played as it is.
#[test]
fn a_body_that_jumps_is_moved_there() {
    let bent: Vec<f32> = [about_y(0.0), about_y(80.0)].concat();
    let back: Vec<f32> = [about_y(0.0), about_y(0.0), about_y(80.0), about_y(80.0)].concat();
    let away = [[0.2f32, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 1.0], [0.2, 0.0, 1.0]];
    let body = arm_with(|document| {
        add_clip(document, "held", LOWER, "rotation", &[0.0, 1.0], &bent);
        document.json["animations"][0]["samplers"][0]["interpolation"] = json!("STEP");
        add_clip(document, "cut", LOWER, "rotation", &[0.0, 0.5, 0.5, 1.0], &back);
        add_clip(document, "teleport", LOWER, "translation", &[0.0, 0.5, 0.501, 1.0], away.as_flattened());
        add_clip(document, "fast", LOWER, "rotation", &[0.0, 0.05], &bent);
        add_clip(document, "smooth", LOWER, "rotation", &[0.0, 1.0], &bent);
    });
    let script = |clip: &str| {
        let text = format!(
            r#"{{"format": "crease-wear/1", "actions": [{{"play": {{"clip": "{clip}", "repeat": 2}}}}]}}"#
        );
        WearScript::parse("w.json", &text).expect("is valid")
    };
    for (clip, name, time) in [(0, "held", "1.000"), (1, "cut", "0.500"), (2, "teleport", "0.501")] {
        let jumps = body.clip_jumps(clip, None);
        assert_eq!(jumps.len(), 1, "{name}: {jumps:?}");
        assert_eq!(jumps[0].joint.map(|(joint, _)| joint), Some(LOWER), "{name}");
        let notes = script(name).body_notes(&body);
        assert!(notes[0].contains(&format!("at {time} s the joint \"lowerarm\"")), "{notes:?}");
        let length = script(name).duration_with_body(Some(&body)) - 2.0 * body.clip_length(clip);
        assert!(length > 2.0 * jumps[0].distance / 0.4, "{name}: {length} s more");
    }
    for (clip, name) in [(3, "fast"), (4, "smooth")] {
        assert!(
            body.clip_jumps(clip, None).is_empty() && script(name).body_notes(&body).is_empty(),
            "{name}"
        );
        assert_eq!(script(name).duration_with_body(Some(&body)), 2.0 * body.clip_length(clip));
    }
    let frames = [0.0, 0.01, 1.01, 1.02].map(|z| vec![Vec3::new(0.0, 0.0, z), Vec3::x(), Vec3::y()]);
    let motion = |rate: f64| BodyMotion::Sequence(Sequence { rate, frames: frames.to_vec() });
    let body = |rate: f64| AnimatedBody::new("frames", "", motion(rate), &frames[0], &[[0, 1, 2]]);
    let jumps = body(24.0).clip_jumps(0, None);
    assert_eq!(jumps.iter().map(|j| (24.0 * j.start).round()).collect::<Vec<_>>(), [1.0]);
    assert!(body(12.0).clip_jumps(0, None).is_empty());
}

/// Body shape by a morph target that is on in the file.
#[test]
fn a_body_has_the_shape_of_its_morph_targets() {
    let mut document = empty();
    let positions = tube(0.1, 0.5);
    let mesh = add_tube(&mut document, &positions, true);
    let wider: Vec<[f32; 3]> = positions.iter().map(|[_, y, z]| [0.0, 0.5 * y, 0.5 * z]).collect();
    let target = json!({"POSITION": document.positions(&wider)});
    document.json["meshes"][mesh]["primitives"][0]["targets"] = json!([target]);
    document.json["meshes"][mesh]["weights"] = json!([1.0]);
    add_node(&mut document, json!({"name": "body", "mesh": mesh}));
    let body = body_of(&document.glb(), "body");
    let radius = |points: &[Vec3]| points.iter().map(|p| p.y.hypot(p.z)).fold(0.0, f64::max);
    assert!((radius(body.rest_points()) - 0.15).abs() < 1e-6);
    assert!((radius(&body.points(&body.rest())) - 0.15).abs() < 1e-6);
}

/// A chest that breathes: the clip changes a morph target, and an arm bends as well.
#[test]
fn clips_play_morph_targets() {
    let mut document = empty();
    let positions = tube(0.1, 0.5);
    let mesh = add_tube(&mut document, &positions, true);
    let wider: Vec<[f32; 3]> = positions.iter().map(|[_, y, z]| [0.0, 0.5 * y, 0.5 * z]).collect();
    let target = json!({"POSITION": document.positions(&wider)});
    document.json["meshes"][mesh]["primitives"][0]["targets"] = json!([target]);
    let skin = add_arm(&mut document, [Some("upper"), Some("lower")], "arm");
    bind(&mut document, mesh, &positions);
    let node = add_node(&mut document, json!({"name": "body", "mesh": mesh, "skin": skin}));
    let input = document.floats("SCALAR", 1, &[0.0, 2.0]);
    let output = document.floats("SCALAR", 1, &[0.0, 1.0]);
    document.push(
        "animations",
        json!({"name": "breathe", "samplers": [{"input": input, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": node, "path": "weights"}}]}),
    );
    let body = body_of(&document.glb(), "body");
    let radius = |pose: &BodyPose| body.points(pose).iter().map(|p| p.y.hypot(p.z)).fold(0.0, f64::max);
    assert_eq!(body.clip_doubts(0), Vec::<String>::new());
    assert!((radius(&body.rest()) - 0.1).abs() < 1e-6);
    let [half, full] = [1.0, 2.0].map(|t| body.clip_pose(0, t, None));
    assert!((radius(&half) - 0.125).abs() < 1e-6 && (radius(&full) - 0.15).abs() < 1e-6);
    assert!((radius(&interpolate_body_pose(&half, &full, 0.5)) - 0.1375).abs() < 1e-6);
    // A checkpoint keeps the weights.
    let text = serde_json::to_string(&half).expect("is text");
    assert_eq!(serde_json::from_str::<BodyPose>(&text).expect("reads back"), half);

    // The whole script: breathed in, the arm bends, and the chest stays wide.
    let script = r#"{"format": "crease-wear/1", "actions": [{"play": {"clip": "breathe"}},
        {"bend": {"joint": "lower", "angle": 60, "axis": "y", "over": 0.5, "hold": 0.1}}]}"#;
    let script = WearScript::parse("w.json", script).expect("is valid");
    assert!(script.body_notes(&body).is_empty(), "{:?}", script.body_notes(&body));
    let poses = script.body_poses(&body);
    let widest = poses.iter().map(&radius).fold(0.0, f64::max);
    assert!((widest - 0.15).abs() < 0.01 || widest > 0.15, "{widest}");
    let upper = |pose: &BodyPose| {
        let points = body.points(pose);
        let near = points.iter().filter(|p| (p.x + 0.25).abs() < 1e-6);
        near.map(|p| p.y.hypot(p.z)).fold(0.0, f64::max)
    };
    assert!(
        poses.iter().any(|pose| (upper(pose) - 0.15).abs() < 1e-6),
        "the end of the arm is as wide as the clip makes it"
    );
}

/// Garment and body from one program with z up, and frames in another unit than the garment.
#[test]
fn every_file_has_its_own_unit_and_axis() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("writes");
    // A cloth at height 0.112 over a bar of radius 0.1, z up.
    let cloth: String = (0..25)
        .map(|k| format!("v {} {} 0.112\n", f64::from(k % 5 - 2) * 0.03, f64::from(k / 5 - 2) * 0.03))
        .chain((0..20).filter(|k| k % 5 < 4).map(|k| format!("f {} {} {} {}\n", k + 1, k + 2, k + 7, k + 6)))
        .collect();
    write("cloth.obj", cloth.as_bytes());
    let bar: String = tube(0.1, 0.5)
        .iter()
        .map(|[x, y, z]| format!("v {} {} {}\n", 100.0 * x, -100.0 * z, 100.0 * y))
        .chain(
            tube_corners(true)
                .as_chunks::<3>()
                .0
                .iter()
                .map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)),
        )
        .collect();
    write("bar.obj", bar.as_bytes());
    write("w.json", br#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 0.1}}]}"#);
    let bake = |options: &str| {
        let line = format!(
            "bake cloth.obj --wear w.json -o out.glb --quiet --up z --body bar.obj --quality draft {options}"
        );
        let (_, error, code) = crease_in(folder.path(), line.trim());
        assert!(code == 0 || code == 3, "{options}: {error}");
        let report = std::fs::read_to_string(folder.path().join("out.report.json")).expect("is written");
        let report: serde_json::Value = serde_json::from_str(&report).expect("is JSON");
        report["warnings"].to_string()
    };
    assert!(!bake("--body-unit cm").contains("--body"), "{}", bake("--body-unit cm"));
    assert!(bake("").contains("--body-unit cm"), "{}", bake(""));
    assert!(bake("--body-unit mm").contains("--body-unit"), "{}", bake("--body-unit mm"));

    std::fs::create_dir(folder.path().join("frames")).expect("makes");
    for k in 0..3 {
        let moved = cloth.replace("0.112", "0.5");
        let frame = moved.lines().map(|line| match line.strip_prefix("v ") {
            Some(numbers) => {
                let x: Vec<f64> =
                    numbers.split(' ').map(|x| 100.0 * x.parse::<f64>().expect("a number")).collect();
                format!("v {} {} {}\n", x[0], x[1], x[2] + f64::from(k))
            }
            None => format!("{line}\n"),
        });
        write(&format!("frames/f{k}.obj"), frame.collect::<String>().as_bytes());
    }
    let remember = |options: &str| {
        let line = format!("from-motion frames --mesh cloth.obj --fps 10 -o out.glb --quiet {options}");
        let (_, error, code) = crease_in(folder.path(), line.trim());
        (error, code)
    };
    let (error, code) = remember("");
    assert_eq!(code, 1);
    assert!(error.contains("100.0000 times") && error.contains("--frames-unit cm"), "{error}");
    // In their unit the frames are read; they move as a whole, and nothing is remembered.
    let (error, code) = remember("--frames-unit cm");
    assert!(code == 3 && error.contains("nothing is remembered"), "{error}");
    let options = ReadOptions::default();
    assert!(load_body(folder.path().join("bar.obj"), &options).is_ok(), "a body of any size");
}

/// A stand of two bars and a pair of mirrored arms: two nodes show one mesh. Both are the body, each where its node is, the mirrored one
/// with its faces outwards; by its name one alone.
#[test]
fn each_node_of_a_shared_mesh_is_a_part_of_the_body() {
    let mut stand = empty();
    let mesh = add_tube(&mut stand, &tube(0.05, 0.5), true);
    add_node(&mut stand, json!({"name": "bar.L", "mesh": mesh, "translation": [0, 1, 0.13]}));
    add_node(
        &mut stand,
        json!({"name": "bar.R", "mesh": mesh, "translation": [0, 1, -0.13], "scale": [1, 1, -1]}),
    );
    let bytes = stand.glb();
    let sides = |part: &str| {
        let body = body_of(&bytes, part);
        let moved = |side: f64| -> Vec<Vec3> {
            body.rest_points().iter().map(|x| x - Vec3::new(0.0, 1.0, side * 0.13)).collect()
        };
        [1.0, -1.0].map(|side| {
            let points = moved(side);
            let own: Vec<_> = body
                .triangles()
                .iter()
                .filter(|t| t.iter().all(|p| points[p.at()].yz().norm() < 0.06))
                .copied()
                .collect();
            (own.len(), outward_fraction(&points, &own))
        })
    };
    let count = tube_corners(true).len() / 3;
    assert_eq!(sides("bar.L,bar.R"), [(count, 1.0), (count, 1.0)]);
    let [left, right] = sides("bar.R");
    assert_eq!((left.0, right), (0, (count, 1.0)));
}
