//! The tool from outside: its output and exit codes.

#[path = "common/tool.rs"]
mod tool;

use serde_json::Value;
use std::path::Path;
use tool::{crease as run, crease_in as run_in};

/// A folder with a wear script of this text, and the script's path.
fn with_script(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("wear.json");
    std::fs::write(&path, text).expect("writes");
    let path = path.display().to_string();
    (folder, path)
}

#[test]
fn schemas_are_valid_json_on_stdout_alone() {
    for (format, title) in [
        ("wear", "crease wear script"),
        ("fabric", "crease fabric"),
        ("report", "crease report"),
        ("sidecar", "Sidecar"),
        ("transfer-report", "crease transfer report"),
    ] {
        let (out, err, code) = run(&["schema", format]);
        assert_eq!((err.as_str(), code), ("", 0));
        let schema: Value = serde_json::from_str(&out).expect("is JSON");
        assert_eq!(schema["title"], title);
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
        assert!(schema["properties"].as_object().is_some_and(|p| !p.is_empty()));
    }
}

#[test]
fn fabrics_are_listed_and_shown() {
    let (out, _, code) = run(&["fabric", "list"]);
    assert_eq!(code, 0);
    assert!(out.lines().count() >= 15, "{out}");
    assert!(
        out.lines().any(|line| line.starts_with("cotton-jersey") && line.ends_with("(default)")),
        "{out}"
    );

    let (out, _, _) = run(&["fabric", "list", "--json"]);
    let all: Value = serde_json::from_str(&out).expect("is JSON");
    assert!(all.as_array().is_some_and(|all| all.len() >= 14));

    let (out, _, _) = run(&["fabric", "show", "denim"]);
    let denim: Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!((&denim["format"], &denim["name"]), (&Value::from("crease-fabric/1"), &Value::from("denim")));
}

#[test]
fn a_shown_fabric_is_a_file_to_start_from() {
    let (shown, _, _) = run(&["fabric", "show", "linen"]);
    let (_folder, path) = with_script(&shown);
    assert_eq!(run(&["fabric", "show", &path]), (shown, String::new(), 0));
}

#[test]
fn an_unknown_fabric_is_bad_input_with_the_nearest() {
    let (out, err, code) = run(&["fabric", "show", "demin"]);
    assert_eq!((out.as_str(), code), ("", 1));
    assert!(err.contains("did you mean `denim`?"), "{err}");
}

#[test]
fn an_unknown_action_is_placed_and_the_allowed_ones_named() {
    let (folder, path) = with_script(
        "{\"format\": \"crease-wear/1\", \"actions\": [\n  {\"lay\": {}},\n  {\"fodl\": {}},\n  {\"hold\": {\"for\": -1}}]}",
    );
    let mesh = folder.path().join("mesh.obj").display().to_string();
    let out_path = folder.path().join("out.glb").display().to_string();
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("writes");
    let (out, err, code) = run(&["bake", &mesh, "--wear", &path, "-o", &out_path, "--quiet"]);
    assert_eq!((out.as_str(), code), ("", 1), "{err}");
    assert!(
        err.contains("line 3, column 4, at actions[1].fodl: unknown name `fodl` (did you mean `fold`?"),
        "{err}"
    );
    for name in ["`lay`", "`crumple`", "`repeat`"] {
        assert!(err.contains(name), "{err}");
    }
    // All faults in one go.
    assert!(err.contains("line 4, column 20, at actions[2].hold.for: is -1"), "{err}");
    assert!(!Path::new(&out_path).exists());
}

#[test]
fn faults_of_several_files_come_in_one_go() {
    let (folder, path) = with_script("{}");
    let out_path = folder.path().join("out.glb").display().to_string();
    let (_, err, code) =
        run(&["bake", "no-such-mesh.obj", "--wear", &path, "--fabric", "felt", "-o", &out_path, "--quiet"]);
    assert_eq!(code, 1);
    for part in ["`actions` is missing", "no preset `felt`", "no-such-mesh.obj: there is no such file"] {
        assert!(err.contains(part), "{part} is not in\n{err}");
    }
}

#[test]
fn moving_a_body_that_is_not_there_is_refused_before_the_run() {
    let (folder, path) = with_script(
        r#"{"format": "crease-wear/1", "actions": [{"bend": {"joint": "elbow", "axis": "z", "angle": 90}}]}"#,
    );
    let out_path = folder.path().join("out.glb").display().to_string();
    let (_, err, code) = run(&["bake", &path, "--wear", &path, "-o", &out_path, "--quiet"]);
    assert_eq!(code, 1);
    assert!(err.contains("actions[0]: `bend` moves a body, and there is none"), "{err}");
}

#[test]
fn an_output_may_not_be_an_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = folder.path().join("shirt.glb");
    std::fs::write(&mesh, "mesh").expect("writes");
    let mesh = mesh.display().to_string();
    let (_, err, code) = run(&["bake", &mesh, "--wear", "none.json", "-o", &mesh, "--quiet"]);
    assert_eq!(code, 1);
    assert!(err.contains("would be overwritten"), "{err}");
}

#[test]
fn wrong_usage_is_exit_2_and_goes_to_stderr() {
    let cases: [&[&str]; 9] = [
        &[],
        &["wash"],
        &["schema", "weer"],
        &["bake"],
        &["bake", "a.obj", "--wear", "w.json", "-o", "out.obj"],
        &["bake", "a.obj", "--wear", "w.json", "-o", "o.glb", "--unit", "0"],
        &["bake", "a.obj", "--wear", "w.json", "-o", "o.glb", "--threads", "0"],
        &["bake", "a.obj", "--wear", "w.json", "-o", "o.glb", "--fps", "10"],
        &["inspect", "a.obj", "--up", "x"],
    ];
    for arguments in cases {
        let (out, err, code) = run(arguments);
        assert_eq!((out.as_str(), code), ("", 2), "{arguments:?}: {err}");
        assert!(!err.is_empty());
    }
}

#[test]
fn help_and_version_are_data() {
    for arguments in [["--help"], ["--version"]] {
        let (out, err, code) = run(&arguments);
        assert_eq!((err.as_str(), code), ("", 0));
        assert!(out.contains("crease"));
    }
}

/// Standard error and exit code when standard output is `stdout`.
#[cfg(unix)]
fn run_into(stdout: impl Into<std::process::Stdio>, arguments: &[&str]) -> (String, Option<i32>) {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_crease"));
    command.args(arguments).stdout(stdout).stderr(std::process::Stdio::piped());
    let output = command.spawn().and_then(|child| child.wait_with_output()).expect("runs");
    (String::from_utf8_lossy(&output.stderr).into_owned(), output.status.code())
}

/// `crease ... | true`: the reader is gone before anything is written.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    for arguments in [&["schema", "wear"][..], &["fabric", "list", "--json"], &["--help"]] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        assert_eq!(run_into(writer, arguments), (String::new(), Some(0)));
    }
}

/// A full disk, on the other hand, is one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let full = std::fs::File::options().write(true).open("/dev/full").expect("opens");
    let (err, code) = run_into(full, &["schema", "wear"]);
    assert_eq!(code, Some(1));
    assert!(err.contains("standard output"), "{err}");
}

/// A handkerchief of `side` x `side` points, 0.2 m wide, lying flat.
fn handkerchief(side: usize) -> String {
    let mut text = String::new();
    let fraction = |i: usize| i as f64 / (side - 1) as f64;
    for (row, column) in (0..side * side).map(|n| (n / side, n % side)) {
        text += &format!(
            "v {} 0 {}\nvt {} {}\n",
            0.2 * fraction(column),
            0.2 * fraction(row),
            fraction(column),
            fraction(row)
        );
    }
    for (row, column) in (0..side * side).map(|n| (n / side, n % side)) {
        if row + 1 < side && column + 1 < side {
            let a = row * side + column + 1;
            let (b, c, d) = (a + 1, a + side, a + side + 1);
            text += &format!("f {a}/{a} {c}/{c} {d}/{d}\nf {a}/{a} {d}/{d} {b}/{b}\n");
        }
    }
    text
}

const FOLD_ONCE: &str = r#"{"format": "crease-wear/1", "name": "fold once", "actions": [
    {"lay": {"facing": "up", "over": 0.2}},
    {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left", "angle": 180, "over": 0.5, "hold": 1.0}},
    {"unfold": {"all": true, "over": 0.5}},
    {"settle": {"for": 0.2}}]}"#;

/// A folder with handkerchief.obj and wear.json.
fn workshop(script: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("handkerchief.obj"), handkerchief(20)).expect("writes");
    std::fs::write(folder.path().join("wear.json"), script).expect("writes");
    folder
}

fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("is there")).expect("is JSON")
}

/// Names in a folder, sorted.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("is a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("lists").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A bake from the command line to the files and to pictures of them, with one thread and with two.
#[test]
fn a_bake_gives_three_files_that_do_not_depend_on_threads() {
    let workshop = workshop(FOLD_ONCE);
    let folder = workshop.path();
    let (out, err, code) = run_in(
        folder,
        "bake handkerchief.obj --wear wear.json -o one.glb --threads 1 --json --frames frames --fps 2 --fabric kow-tshirt",
    );
    assert_eq!(code, 0, "{err}");
    let report = json_of(&folder.join("one.report.json"));
    assert_eq!(serde_json::from_str::<Value>(&out).expect("stdout is JSON"), report);
    assert_eq!((report["crossings"].as_u64(), report["crossings_at_start"].as_u64()), (Some(0), Some(0)));
    assert_eq!((report["points"].as_u64(), report["triangles"].as_u64()), (Some(400), Some(722)));
    assert!(
        report["max_rest_angle_change_deg"].as_f64() > Some(10.0),
        "a sharp fold leaves a crease: {report}"
    );
    for line in err.lines() {
        assert!(serde_json::from_str::<Value>(line).is_ok_and(|news| news["stage"].is_string()), "{line}");
    }

    // The folder of an output is made.
    let (out, err, code) = run_in(
        folder,
        "bake handkerchief.obj --wear wear.json -o two/one.glb --threads 2 --quiet --frames again --fps 2 --fabric kow-tshirt",
    );
    assert_eq!((out.as_str(), err.as_str(), code), ("", "", 0));
    for name in ["one.glb", "one.crease.json"] {
        let bytes = |path: &Path| std::fs::read(path.join(name)).expect("is there");
        assert!(bytes(folder) == bytes(&folder.join("two")), "{name} depends on the number of threads");
    }

    let glb = std::fs::read(folder.join("one.glb")).expect("is there");
    check_worn_glb(&glb);
    check_views(&glb, &std::fs::read(folder.join("one.crease.json")).expect("is there"));
    let sidecar = json_of(&folder.join("one.crease.json"));
    assert_eq!(sidecar["run"]["memory"], "on");
    assert_eq!(sidecar["wear"]["name"], "fold once");

    let frames = names_in(&folder.join("frames"));
    assert!(frames.len() >= 4 && frames[0] == "frame_0000.obj", "{frames:?}");
    let first = std::fs::read_to_string(folder.join("frames/frame_0000.obj")).expect("is there");
    assert_eq!(first.lines().filter(|line| line.starts_with("v ")).count(), 400);

    check_pictures(folder);
}

/// A fine sheet is simulated on a mesh of fewer points; what comes out is of all of its own, and remembers what it does when those
/// are simulated. Frames show its own vertices, or the simulated mesh.
#[test]
fn a_fine_mesh_is_simulated_on_fewer_points() {
    let workshop = workshop(FOLD_ONCE);
    let folder = workshop.path();
    std::fs::write(folder.join("fine.obj"), handkerchief(37)).expect("writes");
    for (name, option) in
        [("fewer", " --frames-of simulated"), ("every", " --no-grading"), ("own", " --sidecar-mesh garment")]
    {
        let frames = format!(" --frames {name} --fps 2");
        // A fabric whose memory comes in small events, without hems, which are as wide as a triangle of either mesh: two meshes can agree.
        let fabric = " --fabric cotton-jersey --no-hems";
        let line = format!("bake fine.obj --wear wear.json -o {name}.glb --quiet{fabric}{frames}{option}");
        assert_eq!(run_in(folder, &line), (String::new(), String::new(), 0));
    }
    let count = |name: &str| {
        let first = std::fs::read_to_string(folder.join(name).join("frame_0000.obj")).expect("is there");
        first.lines().filter(|line| line.starts_with("v ")).count()
    };
    assert!(count("fewer") < 3 * count("every") / 4, "{} of {}", count("fewer"), count("every"));
    assert_eq!((count("every"), count("own")), (37 * 37, 37 * 37));
    let sidecar = |name: &str| json_of(&folder.join(format!("{name}.crease.json")));
    assert_eq!(sidecar("fewer")["run"]["simulated_points"], count("fewer"));
    assert!(sidecar("every")["run"]["simulated_points"].is_null());
    assert!(["every", "own"].iter().all(|name| sidecar(name)["simulated"].is_null()));
    let own_mesh = sidecar("fewer")["simulated"].clone();
    assert_eq!(own_mesh["mesh"]["points_m"].as_array().map(Vec::len), Some(count("fewer")));
    let across = |name: &str| angle_across(folder, name, 37 * 37);
    let (fewer, every) = (across("fewer"), across("every"));
    assert!((fewer / every - 1.0).abs() < 0.1, "{fewer} and {every} rad across the fold");
    assert_eq!(fewer, across("own"));
    let (_, err, code) = run_in(folder, "view fewer.glb --frames fewer -o fewer.html");
    assert_eq!(code, 0, "{err}");
    assert!(std::fs::read_to_string(folder.join("fewer.html")).expect("is there").contains("simulated"));
    let (_, err, code) = run_in(folder, "remember fewer --fps 2 --mesh fine.obj -o again.glb");
    assert!(code == 1 && err.contains("--frames-of"), "{err}");
    let (_, err, code) = run_in(folder, "remember own --fps 2 --mesh fine.obj -o again.glb");
    assert_eq!(code, 0, "{err}");
    // A transfer by position takes the memory from the mesh that earned it.
    let line = "transfer fewer.crease.json --to fine.obj --match surface -o there.glb --quiet";
    assert_eq!(run_in(folder, line), (String::new(), String::new(), 0));
    let there = across("there");
    assert!((there / fewer - 1.0).abs() < 0.1, "{there} and {fewer} rad across the fold");
}

/// Angle across the fold [rad] in NAME.crease.json of a sheet of `points` points: change times length over the width, of hinges that
/// run along it. The report says no crossing.
fn angle_across(folder: &Path, name: &str, points: usize) -> f64 {
    let report = json_of(&folder.join(format!("{name}.report.json")));
    assert_eq!((&report["points"], &report["crossings"]), (&points.into(), &0.into()));
    let sidecar = json_of(&folder.join(format!("{name}.crease.json")));
    let positions: Vec<[f64; 3]> =
        serde_json::from_value(sidecar["mesh"]["points_m"].clone()).expect("points");
    let hinges = &sidecar["hinges"];
    let ends: Vec<[usize; 4]> = serde_json::from_value(hinges["points"].clone()).expect("hinges");
    let angles = |key: &str| -> Vec<f64> { serde_json::from_value(hinges[key].clone()).expect("angles") };
    let change = angles("rest_angle_rad").into_iter().zip(angles("source_angle_rad")).map(|(r, s)| r - s);
    let sum: f64 = ends
        .iter()
        .zip(change)
        .map(|(h, change)| {
            let edge = [0, 1, 2].map(|k| positions[h[1]][k] - positions[h[0]][k]);
            let length = edge.iter().map(|c| c * c).sum::<f64>().sqrt();
            change * edge[2] * edge[2] / length
        })
        .sum();
    sum / 0.2
}

/// Three meshes of one sheet come out with the same crease.
#[test]
fn a_crease_is_the_same_whatever_the_triangles_are() {
    let workshop = workshop(FOLD_ONCE);
    let folder = workshop.path();
    let mut angles = Vec::new();
    for side in [13, 20, 37] {
        std::fs::write(folder.join("sheet.obj"), handkerchief(side)).expect("writes");
        let line = format!("bake sheet.obj --wear wear.json -o {side}.glb --quiet --fabric kow-tshirt");
        assert_eq!(run_in(folder, &line), (String::new(), String::new(), 0));
        let report = json_of(&folder.join(format!("{side}.report.json")));
        let mut models = report["models"].as_array().into_iter().flatten();
        assert_eq!(models.find(|m| m["name"] == "simulation mesh").expect("is decided")["on"], true);
        angles.push(angle_across(folder, &side.to_string(), side * side));
    }
    let mean = angles.iter().sum::<f64>() / angles.len() as f64;
    println!("across the fold: {angles:?} rad");
    assert!(mean < -1.0 && angles.iter().all(|angle| (angle / mean - 1.0).abs() < 0.06), "{angles:?}");
}

/// The worn target is there, switched on, and moves something.
fn check_worn_glb(bytes: &[u8]) {
    let options = crease_io::ReadOptions { unit_m: Some(1.0), any_size: true, ..Default::default() };
    let mut nothing = |name: &str| Err(crease::Error::input(name, "", "is not asked for", ""));
    let (mut asset, _) = crease_io::read_asset("one.glb", bytes, &options, &mut nothing).expect("reads back");
    let document = asset.document.clone().expect("is glTF");
    let mesh = &document.json["meshes"][0];
    assert_eq!(mesh["extras"]["targetNames"][0], "worn");
    assert_eq!(mesh["weights"][0].as_f64(), Some(1.0));
    assert_eq!(crease_io::gltf::sidecar_name(&document), Some("one.crease.json"));
    assert!(crease_io::gltf::keep_worn_pieces(&mut asset));
    let worn = crease_io::gltf::read_worn(&asset).expect("reads");
    assert_eq!(worn.positions.len(), 400);
    let raised = worn.positions.iter().map(|x| x.y.abs()).fold(0.0, f64::max);
    assert!(raised > 1e-4, "the crease stands {raised} m out of the plane");
    assert!(worn.rest_angle_deg.iter().any(|angle| angle.abs() > 10.0));
}

/// The drawn data is the same with the sidecar and from the file alone, up to single precision.
fn check_views(glb: &[u8], sidecar: &[u8]) {
    let options = crease_io::ReadOptions { unit_m: Some(1.0), any_size: true, ..Default::default() };
    let mut nothing = |name: &str| Err(crease::Error::input(name, "", "is not asked for", ""));
    let (mut asset, _) = crease_io::read_asset("one.glb", glb, &options, &mut nothing).expect("reads back");
    let sidecar = crease_io::read_sidecar("one.crease.json", sidecar).expect("reads back");
    let in_full = crease::internal::report::GarmentView::of_sidecar("one.glb", &sidecar);
    let alone = crease::internal::report::GarmentView::of_asset(&mut asset).expect("is a garment");
    let largest = |view: &crease::internal::report::GarmentView| {
        let memory = view.memory.as_ref().expect("is worn");
        let moved = view.before.iter().zip(&view.after).map(|(a, b)| 1e3 * (a - b).norm());
        let turned = memory.rest_angle_change_deg.iter().map(|angle| angle.abs());
        let stiffened = memory.stiffness_ratio.iter().copied();
        [moved.fold(0.0, f64::max), turned.fold(0.0, f64::max), stiffened.fold(0.0, f64::max)]
    };
    for (full, alone) in largest(&in_full).into_iter().zip(largest(&alone)) {
        assert!(full > 1.0 && (full - alone).abs() < 1e-5 * full, "{full} and {alone}");
    }
}

/// Pictures of the bake, with the sidecar and without.
fn check_pictures(folder: &Path) {
    std::fs::create_dir(folder.join("alone")).expect("makes");
    std::fs::copy(folder.join("one.glb"), folder.join("alone/one.glb")).expect("copies");
    for show in ["shape", "rest-angle-change", "curvature", "stiffness", "displacement"] {
        for glb in ["one.glb", "alone/one.glb"] {
            let (out, err, code) =
                run_in(folder, &format!("render {glb} --show {show} -o {show}.png --size 64"));
            assert_eq!((out.as_str(), err.as_str(), code), ("", "", 0), "{show} of {glb}");
        }
        let png = std::fs::read(folder.join(format!("{show}.png"))).expect("is there");
        assert_eq!(png[..4], *b"\x89PNG");
        // Width and height stand at bytes 16 to 24.
        assert_eq!(png[16..24], [0, 0, 0, 64, 0, 0, 0, 48]);
    }
    let (_, err, code) = run_in(
        folder,
        "render one.glb --show rest-angle-change --before-after --azimuth -20 -o both.png --size 64",
    );
    assert_eq!(code, 0, "{err}");
    let (_, err, code) =
        run_in(folder, "render frames/frame_0000.obj --show curvature -o frame.png --size 64");
    assert_eq!(code, 0, "{err}");
    let (_, err, code) = run_in(folder, "render handkerchief.obj --show stiffness -o none.png");
    assert!(code == 1 && err.contains("holds no wear"), "{err}");
    assert!(!folder.join("none.png").exists());
}

#[test]
fn inspect_tells_what_is_in_a_file() {
    let workshop = workshop(FOLD_ONCE);
    let (out, err, code) = run_in(workshop.path(), "inspect handkerchief.obj --json");
    assert_eq!((err.as_str(), code), ("", 0));
    let found: Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!((found["points"].as_u64(), found["triangles"].as_u64()), (Some(400), Some(722)));
    assert_eq!(found["crossings_at_start"].as_u64(), Some(0));
    let (out, _, code) = run_in(workshop.path(), "inspect handkerchief.obj");
    assert!(code == 0 && out.contains("crossings  0 pairs"), "{out}");
    let (out, err, code) = run_in(workshop.path(), "inspect handkerchief.obj --garment sock");
    assert_eq!((out.as_str(), code), ("", 1));
    assert!(err.contains("no garment called \"sock\""), "{err}");
    // A handkerchief of 0.2 mm is refused whatever the unit, and accepted on request.
    let (_, err, code) = run_in(workshop.path(), "inspect handkerchief.obj --unit mm");
    assert!(code == 1 && err.contains("--force-size"), "{err}");
    assert_eq!(run_in(workshop.path(), "inspect handkerchief.obj --unit mm --force-size").2, 0);
}

#[test]
fn explain_without_an_output_only_tells_the_plan() {
    let workshop = workshop(FOLD_ONCE);
    let (out, _, code) =
        run_in(workshop.path(), "bake handkerchief.obj --wear wear.json --explain --memory off --quiet");
    assert_eq!(code, 0);
    assert!(out.lines().any(|line| line.starts_with("memory") && line.contains(" off ")), "{out}");
    let (out, _, _) =
        run_in(workshop.path(), "bake handkerchief.obj --wear wear.json --explain --json --quiet");
    let plan: Value = serde_json::from_str(&out).expect("is JSON");
    assert!(plan.as_array().is_some_and(|all| all.iter().all(|choice| choice["why"].is_string())));
    assert_eq!((&plan[0]["name"], &plan[1]["name"]), (&Value::from("garment"), &Value::from("body")));
    assert!(plan[0]["why"].as_str().is_some_and(|why| why.starts_with("400 points")), "{plan}");
    assert_eq!(names_in(workshop.path()), ["handkerchief.obj", "wear.json"]);
}

#[test]
fn a_fold_before_the_garment_lies_is_placed_in_the_script() {
    let script = r#"{"format": "crease-wear/1", "actions": [
        {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left"}}]}"#;
    let workshop = workshop(script);
    let (_, err, code) = run_in(workshop.path(), "bake handkerchief.obj --wear wear.json -o out.glb --quiet");
    assert_eq!(code, 1);
    assert!(err.contains("wear.json: actions[0]"), "{err}");
    assert_eq!(names_in(workshop.path()), ["handkerchief.obj", "wear.json"]);
}

/// Nothing of a bake is left when one of its files cannot be written.
#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_run() {
    let workshop = workshop(FOLD_ONCE);
    std::fs::create_dir(workshop.path().join("out.report.json")).expect("makes");
    let (_, err, code) =
        run_in(workshop.path(), "bake handkerchief.obj --wear wear.json -o out.glb --frames f --quiet");
    assert_eq!(code, 1);
    assert!(err.contains("out.report.json: is a folder"), "{err}");
    assert_eq!(names_in(workshop.path()), ["handkerchief.obj", "out.report.json", "wear.json"]);
}

/// Textures that the input names by a path come along inside the one output file.
#[test]
fn images_named_by_a_path_are_embedded() {
    let workshop =
        workshop(r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "up", "over": 0.1}}]}"#);
    let folder = workshop.path();
    assert_eq!(
        run_in(folder, "bake handkerchief.obj --wear wear.json -o plain.glb --memory off --quiet").2,
        0
    );
    let (mut json, binary) =
        crease_io::gltf::split_glb(&std::fs::read(folder.join("plain.glb")).expect("is there"))
            .expect("is a GLB");
    json["images"] = serde_json::json!([{"uri": "my%20weave.png"}, {"uri": "gone.png"}]);
    let glb = crease_io::gltf::join_glb(&json, &binary.expect("has bytes"));
    std::fs::create_dir(folder.join("in")).expect("makes");
    std::fs::write(folder.join("in/pictured.glb"), glb).expect("writes");
    let png = b"\x89PNG\r\n\x1a\nnot looked into";
    std::fs::write(folder.join("in/my weave.png"), png).expect("writes");
    let (_, err, code) = run_in(folder, "bake in/pictured.glb --wear wear.json -o out.glb --memory off");
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("warning: images[1] still names \"gone.png\""), "{err}");
    let out = std::fs::read(folder.join("out.glb")).expect("is there");
    let (json, _) = crease_io::gltf::split_glb(&out).expect("is a GLB");
    assert_eq!(json["images"][0]["mimeType"], "image/png");
    assert!(out.windows(png.len()).any(|window| window == png));
}

#[test]
fn a_chart_is_four_files_or_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let into = |name: &str| folder.path().join(name).display().to_string();
    let (out, err, code) = run(&["chart", "hinge", "-o", &into("charts")]);
    assert_eq!((out.as_str(), code), ("", 0), "{err}");
    let mut files: Vec<String> = std::fs::read_dir(folder.path().join("charts"))
        .expect("was made")
        .map(|file| file.expect("is there").file_name().to_string_lossy().into_owned())
        .collect();
    files.sort();
    assert_eq!(files, ["hinge.csv", "hinge.json", "hinge.png", "hinge.svg"]);
    let text = std::fs::read_to_string(folder.path().join("charts/hinge.json")).expect("is text");
    let json: Value = serde_json::from_str(&text).expect("is JSON");
    assert_eq!(json["chart"], "hinge");
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(5));
    assert!(json["rows"][0]["tau_gradual_s"].is_null() && json["rows"][1]["paper_max_torque"] == 18.67);

    let (_, err, code) = run(&["chart", "hinge", "-o", &into("none/charts")]);
    assert!(code == 1 && err.contains("cannot be made"), "{err}");
    let (_, err, code) = run(&["chart", "hinges", "-o", &into("other")]);
    assert!(code == 2 && err.contains("hinge"), "{err}");
    assert!(!folder.path().join("other").exists());
    let (_, err, code) = run(&["chart", "loop", "--fabric", "demin", "-o", &into("other")]);
    assert!(code == 1 && err.contains("did you mean `denim`"), "{err}");
    assert!(!folder.path().join("other").exists());
}

/// The names of options and values before version 0.1 still work, but no help shows them.
#[cfg(all(feature = "charts", feature = "viewer"))]
#[test]
fn old_names_of_options_are_hidden_aliases() {
    let workshop = workshop(FOLD_ONCE);
    let bake =
        "bake handkerchief.obj --wear wear.json --explain --memory paper --everything --no-sleep --also obj";
    let (_, err, code) = run_in(workshop.path(), bake);
    assert_eq!(code, 0, "{err}");
    // Read as far as the missing files: the options themselves are accepted.
    for line in [
        "transfer none.crease.json --to none.obj --by uv --align place -o out.glb",
        "view none.glb --show rest-angle --most-frames 3 -o out.html",
        "render none.glb --show rest-angle -o out.png",
        "batch none.json --share 0/2",
    ] {
        let (_, err, code) = run_in(workshop.path(), line);
        assert!(code == 1 && err.contains("there is no such file"), "{line}: {err}");
    }
    let (help, _, _) = run_in(workshop.path(), "man --markdown");
    for old in
        ["--everything", "--no-sleep", "--also", "--by", "--share", "--most-frames", "`paper`", "`place`"]
    {
        assert!(!help.contains(old), "{old} is documented");
    }
    assert!(help.contains("`from-motion`") && help.contains("--export"));
}

/// The reference is generated from the definition of the command line.
#[cfg(all(feature = "charts", feature = "viewer"))]
#[test]
fn the_command_line_reference_is_current() {
    let path =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("docs/reference/command-line.md");
    let (text, _, code) = run(&["man", "--markdown"]);
    assert_eq!(code, 0);
    if std::env::var_os("CREASE_UPDATE_DOCS").is_some() {
        std::fs::write(&path, &text).expect("writes");
    }
    let current = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        current == text,
        "docs/reference/command-line.md is out of date; run\n  \
         CREASE_UPDATE_DOCS=1 cargo test --test cli the_command_line_reference_is_current"
    );
}
