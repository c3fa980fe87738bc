//! Files of strangers: what they name outside their folder, devices, pipes, names that are commands to a terminal, shapes that cost
//! much. Each is refused, or harmless, and nothing outside the folder of a file reaches an output.

#![cfg(unix)]

#[path = "common/tool.rs"]
mod tool;

use base64::Engine;
use serde_json::{Value, json};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tool::{Pose, crease, crease_in, wavy_sheet, write, write_script};

/// Text of the files that must not be read.
const SECRET: &str = "root:x:0:0:a secret that no output may hold";

/// A folder with `in/`, in which the files of a stranger lie, and `private/` beside it.
struct Scene(tempfile::TempDir);

impl Scene {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["in", "private"] {
            std::fs::create_dir(folder.path().join(name)).expect("makes");
        }
        let scene = Self(folder);
        write(&scene.0.path().join("private"), "secret.bin", SECRET.repeat(20));
        let mut picture = b"\x89PNG\r\n\x1a\n".to_vec();
        picture.extend(SECRET.as_bytes());
        write(&scene.0.path().join("private"), "secret.png", picture);
        write_script(
            &scene.folder(),
            "fold.json",
            r#"{"lay": {"over": 0.3}}, {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 3}},
               {"unfold": {"all": true, "over": 0.5}}"#,
        );
        scene
    }

    fn folder(&self) -> PathBuf {
        self.0.path().join("in")
    }

    /// Absolute path of the secret `name`.
    fn private(&self, name: &str) -> String {
        self.0.path().join("private").join(name).display().to_string()
    }

    /// Runs the tool in the folder of the stranger, within 10 s: a hang or a stack that overflows fails.
    fn run(&self, line: &str) -> (String, String, i32) {
        let began = Instant::now();
        let run = crease_in(&self.folder(), line);
        assert!(began.elapsed() < Duration::from_secs(10), "{line}: {:?}", began.elapsed());
        run
    }

    /// Asserts that no file under the folder of the stranger that a run has written holds the secret.
    fn assert_nothing_leaked(&self, what: &str) {
        for entry in std::fs::read_dir(self.folder()).expect("lists") {
            let path = entry.expect("an entry").path();
            if path.symlink_metadata().is_ok_and(|data| data.is_file()) {
                let bytes = std::fs::read(&path).expect("reads");
                let found = bytes.windows(SECRET.len()).any(|part| part == SECRET.as_bytes());
                assert!(!found, "{what}: {}", path.display());
            }
        }
    }
}

/// A glTF of a square sheet of 2 x `CELLS`^2 triangles, changed by `change`.
fn sheet(change: impl FnOnce(&mut Value)) -> String {
    const CELLS: u16 = 6;
    let row = CELLS + 1;
    let mut bytes = Vec::new();
    for k in 0..row * row {
        let at = |n: u16| 0.3 * f32::from(n) / f32::from(CELLS);
        [at(k % row), 0.0, at(k / row)].iter().for_each(|x: &f32| bytes.extend(x.to_le_bytes()));
    }
    let positions = bytes.len();
    for k in (0..row * CELLS).filter(|k| k % row < CELLS) {
        let below = k + row;
        [k, below, below + 1, k, below + 1, k + 1].iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let corners = (bytes.len() - positions) / 2;
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "sheet"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "cloth"}],
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{data}")}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": positions},
            {"buffer": 0, "byteOffset": positions, "byteLength": bytes.len() - positions},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": row * row, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": corners, "type": "SCALAR"},
        ],
    });
    change(&mut document);
    document.to_string()
}

fn push(list: &mut Value, entry: Value) -> usize {
    let list = list.as_array_mut().expect("is a list");
    list.push(entry);
    list.len() - 1
}

/// The sheet with a file `uri` as a second buffer, of which an attribute takes its numbers.
fn with_used_buffer(uri: &str) -> String {
    sheet(|document| {
        let buffer = push(&mut document["buffers"], json!({"byteLength": 588, "uri": uri}));
        let view = push(&mut document["bufferViews"], json!({"buffer": buffer, "byteLength": 588}));
        let accessor = push(
            &mut document["accessors"],
            json!({"bufferView": view, "componentType": 5126, "count": 49, "type": "VEC3"}),
        );
        document["meshes"][0]["primitives"][0]["attributes"]["_SECRET"] = json!(accessor);
    })
}

/// The sheet with a file `uri` as a second buffer that nothing uses, or that only a view names.
fn with_unused_buffer(uri: &str, has_view: bool) -> String {
    sheet(|document| {
        let buffer = push(&mut document["buffers"], json!({"byteLength": 10, "uri": uri}));
        if has_view {
            push(&mut document["bufferViews"], json!({"buffer": buffer, "byteLength": 10}));
        }
    })
}

fn with_image(uri: &str) -> String {
    sheet(|document| {
        document["images"] = json!([{"uri": uri}]);
        document["textures"] = json!([{"source": 0}]);
        document["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    })
}

/// Every way out of the folder: above it, absolute, as an address, percent-encoded, with the backslashes of another system, through a
/// link to a file, and through a link to a folder. A used buffer is refused by name; a picture stays a name, with a warning.
#[test]
fn nothing_outside_the_folder_of_a_gltf_is_read() {
    let scene = Scene::new();
    symlink(scene.private("secret.bin"), scene.folder().join("link.bin")).expect("links");
    symlink(scene.private("secret.png"), scene.folder().join("link.png")).expect("links");
    symlink(scene.private(""), scene.folder().join("deep")).expect("links");
    let (file, address) = (scene.private("secret"), format!("file://{}", scene.private("secret")));
    let escapes = [
        "../private/secret",
        &file,
        &address,
        "%2e%2e/private/secret",
        "..\\private\\secret",
        "link",
        "deep/secret",
    ];
    for escape in escapes {
        let uri = |ending: &str| format!("{escape}.{ending}");
        write(&scene.folder(), "a.gltf", with_used_buffer(&uri("bin")));
        let (_, text, code) = scene.run("bake a.gltf --wear fold.json -o out.glb --quiet");
        assert_eq!(code, 1, "{escape}: {text}");
        assert!(text.starts_with("error: a.gltf: buffers[1]: the file "), "{text}");
        // Backslashes are part of a name where they do not part folders.
        let reasons = ["outside the folder of a.gltf", "network address", "there is no such file"];
        let is_explained = reasons.iter().any(|reason| text.contains(reason));
        assert!(is_explained && (escape.contains('\\') || !text.contains(reasons[2])), "{text}");
        assert!(!scene.folder().join("out.glb").exists());
        for document in [
            with_unused_buffer(&uri("bin"), false),
            with_unused_buffer(&uri("bin"), true),
            with_image(&uri("png")),
        ] {
            write(&scene.folder(), "a.gltf", document);
            let (_, text, code) = scene.run("bake a.gltf --wear fold.json -o out.glb");
            assert_eq!(code, 0, "{escape}: {text}");
            assert!(
                !text.contains("images[0]") || reasons.iter().any(|reason| text.contains(reason)),
                "{text}"
            );
            scene.assert_nothing_leaked(escape);
            std::fs::remove_file(scene.folder().join("out.glb")).expect("was written");
        }
    }
}

#[test]
fn a_folder_that_is_allowed_is_read() {
    let scene = Scene::new();
    write(&scene.folder(), "a.gltf", with_used_buffer("../private/secret.bin"));
    let (_, text, _) = scene.run("inspect a.gltf");
    let advice =
        text.split("--allow-folder ").nth(1).expect("advises the option").trim_end().trim_end_matches(')');
    assert_eq!(Path::new(advice), scene.0.path().join("private").canonicalize().expect("is there"));
    assert_eq!(scene.run("inspect a.gltf --allow-folder ../private").2, 0);
    assert_eq!(scene.run("inspect a.gltf --allow-folder .").2, 1);
}

/// A device without an end, and a pipe that nobody writes to: in their place in the folder, too, where they can be links or real.
#[test]
fn devices_and_pipes_are_not_read() {
    let scene = Scene::new();
    let status = std::process::Command::new("mkfifo").arg(scene.folder().join("pipe")).status();
    assert!(status.expect("runs").success());
    symlink("/dev/zero", scene.folder().join("zero")).expect("links");
    for (uri, reason) in
        [("pipe", "is no regular file"), ("zero", "outside the folder"), ("/dev/zero", "outside the folder")]
    {
        write(&scene.folder(), "a.gltf", with_used_buffer(uri));
        let (_, text, code) = scene.run("inspect a.gltf");
        assert!(code == 1 && text.contains(reason), "{uri}: {text}");
    }
    write(&scene.folder(), "a.gltf", with_used_buffer("zero"));
    let (_, text, code) = scene.run("inspect a.gltf --allow-folder /dev");
    assert!(code == 1 && text.contains("is no regular file"), "{text}");
    for line in ["inspect /dev/zero", "bake a.gltf --wear /dev/zero -o o.glb"] {
        let (_, text, code) = scene.run(line);
        assert!(code == 1 && text.contains("is no regular file"), "{line}: {text}");
    }
}

/// A file of 3 GiB of which 588 bytes are used costs 588 bytes; one that is longer than 4 GiB and needed whole is refused unread.
#[test]
fn no_more_of_a_file_is_read_than_is_needed() {
    let scene = Scene::new();
    for (name, length) in [("long.bin", 3u64 << 30), ("longer.png", 5 << 30)] {
        let file = std::fs::File::create(scene.folder().join(name)).expect("makes");
        file.set_len(length).expect("sets");
    }
    write(&scene.folder(), "a.gltf", with_used_buffer("long.bin"));
    let began = Instant::now();
    let (_, text, code) = scene.run("inspect a.gltf");
    assert_eq!(code, 0, "{text}");
    assert!(began.elapsed() < Duration::from_secs(1));
    write(&scene.folder(), "a.gltf", with_image("longer.png"));
    let (_, text, code) = scene.run("bake a.gltf --wear fold.json -o out.glb");
    assert!(code == 0 && text.contains("more than 4 GiB"), "{text}");
}

/// Sidecars, layers of a stage, frames and the files of a batch.
#[test]
fn other_files_name_nothing_outside_either() {
    let scene = Scene::new();
    write(
        &scene.folder(),
        "a.gltf",
        sheet(|d| d["meshes"][0]["extras"] = json!({"crease": {"sidecar": "../private/secret.bin"}})),
    );
    for line in ["view a.gltf -o a.html", "transfer a.gltf --to a.gltf -o b.glb"] {
        let (_, text, code) = scene.run(line);
        assert!(code == 1 && text.contains("outside the folder of a.gltf"), "{line}: {text}");
    }
    let layer = "#usda 1.0\ndef Mesh \"m\" {\n point3f[] points = [(0,0,0),(1,0,0),(1,0,1)]\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0,1,2]\n}\n";
    write(&scene.0.path().join("private"), "layer.usda", layer);
    write(
        &scene.folder(),
        "a.usda",
        format!(
            "#usda 1.0\n(subLayers = [@../private/layer.usda@])\n{}",
            layer.split_once('\n').expect("lines").1.replace("\"m\"", "\"n\"")
        ),
    );
    let (out, text, code) = scene.run("inspect a.usda --force-size");
    assert!(
        code == 0 && out.contains("lies outside the folder of a.usda") && out.contains("--allow-folder"),
        "{out}{text}"
    );
    let (out, ..) = scene.run("inspect a.usda --force-size --allow-folder ../private");
    assert!(!out.contains("outside"), "{out}");
    std::fs::create_dir(scene.folder().join("frames")).expect("makes");
    symlink(scene.private("secret.bin"), scene.folder().join("frames/f_0001.obj")).expect("links");
    let (_, text, code) = scene.run("remember frames --fps 10 -o b.glb");
    assert!(code == 1 && text.contains("outside the folder of frames"), "{text}");
    write(&scene.folder(), "sheet.obj", wavy_sheet(4, 0.0, Pose::Lying));
    let jobs = |change: Value| {
        let mut file = json!({"format": "crease-batch/1", "garments": ["sheet.obj"], "wear": ["fold.json"]});
        change.as_object().expect("members").iter().for_each(|(key, value)| file[key] = value.clone());
        write(&scene.folder(), "jobs.json", file.to_string());
        scene.run("batch jobs.json --list")
    };
    assert_eq!(jobs(json!({})).2, 0);
    for change in [
        json!({"garments": ["../private/secret.bin"]}),
        json!({"wear": [scene.private("secret.bin")]}),
        json!({"fabrics": ["../private/secret.bin"]}),
        json!({"output": "../private/out"}),
        json!({"bake": ["--body", "../private/secret.bin"]}),
        json!({"bake": [format!("--frames={}", scene.private("frames"))]}),
    ] {
        let (_, text, code) = jobs(change.clone());
        assert!(code == 1 && text.contains("outside the folder of jobs.json"), "{change}: {text}");
    }
    assert_eq!(jobs(json!({"bake": ["--allow-folder", "/"]})).2, 1);
}

/// Names with a colour, a title, a line that looks like an error, and a mark that turns the direction of writing.
#[test]
fn names_of_files_are_no_commands_to_a_terminal() {
    let scene = Scene::new();
    let name = "a\u{1b}[31mRED\u{1b}]0;owned\u{7}\r\nerror: fake\u{202e}\u{9b}1m\u{2028}";
    write(
        &scene.folder(),
        "a.gltf",
        sheet(|document| {
            document["nodes"][0]["name"] = json!(name);
            document["materials"][0]["name"] = json!(name);
            document["animations"] = json!([{"name": name, "channels": [], "samplers": []}]);
        }),
    );
    let is_hostile = |c: char| (c.is_control() && c != '\n') || matches!(c, '\u{202e}' | '\u{2028}');
    for line in [
        "inspect a.gltf",
        "inspect a.gltf --garment nobody",
        "bake a.gltf --wear fold.json --explain",
        "bake a.gltf --wear fold.json -o b.glb",
    ] {
        let (out, text, _) = scene.run(line);
        let shown = out + &text;
        assert!(!shown.contains(is_hostile), "{line}: {shown:?}");
        assert!(!shown.lines().any(|line| line.starts_with("error: fake")), "{line}: {shown}");
    }
    let (out, ..) = scene.run("inspect a.gltf --json");
    let read: Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!(read["pieces"][0]["name"], json!(name));
    write(&scene.folder(), "bad.json", "{\"format\": \"crease-wear/1\", \"\u{1b}[2J\\nerror: fake\": 1}");
    let (_, text, _) = scene.run("bake a.gltf --wear bad.json -o b.glb");
    assert!(
        !text.contains(is_hostile) && !text.lines().any(|line| line.starts_with("error: fake")),
        "{text:?}"
    );
}

/// A chain of 200,000 nodes, one that a skin needs whole, and one with a mesh on every tenth node.
#[test]
fn chains_of_nodes_take_linear_time() {
    let scene = Scene::new();
    let chain = |count: usize, mesh: &dyn Fn(usize) -> bool| {
        let node = |k: usize| {
            let mut node =
                if k + 1 < count { json!({"children": [k + 1], "name": format!("n{k}")}) } else { json!({}) };
            if mesh(k) {
                node["mesh"] = json!(0);
            }
            node
        };
        (0..count).map(node).collect::<Vec<_>>()
    };
    for (count, every) in [(200_000, 200_000), (20_000, 10)] {
        let nodes = chain(count, &|k| k % every == every - 1);
        write(&scene.folder(), "a.gltf", sheet(|document| document["nodes"] = json!(nodes)));
        let (_, text, code) = scene.run("inspect a.gltf");
        assert_eq!(code, 0, "{text}");
    }
}

/// 1,000 km away, and 300 km in a glTF whose node is there.
#[test]
fn a_garment_far_from_the_origin_is_baked() {
    let scene = Scene::new();
    let far: String = wavy_sheet(12, 0.002, Pose::Lying)
        .lines()
        .map(|line| match line.strip_prefix("v ") {
            Some(numbers) => {
                let at: Vec<f64> = numbers.split(' ').map(|x| x.parse().expect("a number")).collect();
                format!("v {} {} {}\n", at[0] + 1e6, at[1] + 1e6, at[2] - 1e6)
            }
            None => format!("{line}\n"),
        })
        .collect();
    write(&scene.folder(), "far.obj", far);
    write(&scene.folder(), "far.gltf", sheet(|d| d["nodes"][0]["translation"] = json!([3e5, 0, 3e5])));
    for name in ["far.obj", "far.gltf"] {
        let (_, text, code) = scene.run(&format!("bake {name} --wear fold.json -o out.glb --quiet"));
        assert!(matches!(code, 0 | 3), "{name}: {code} {text}");
    }
}

/// The name that checkpoints had, and the lock, as links to a file that must stay; then two runs with one OUT.
#[test]
fn outputs_follow_no_links_and_belong_to_one_run() {
    let scene = Scene::new();
    write(&scene.folder(), "sheet.obj", wavy_sheet(16, 0.002, Pose::Lying));
    symlink(scene.private("secret.bin"), scene.folder().join("out.checkpoint-part")).expect("links");
    let bake = "bake sheet.obj --wear fold.json -o out.glb --checkpoint-every 0 --quiet";
    assert_eq!(scene.run(bake).2, 0);
    assert!(std::fs::read_to_string(scene.private("secret.bin")).expect("reads").starts_with(SECRET));
    symlink(scene.private("secret.bin"), scene.folder().join("out.lock")).expect("links");
    let (_, text, code) = scene.run(bake);
    assert!(code == 1 && text.contains("its lock"), "{text}");
    std::fs::remove_file(scene.folder().join("out.lock")).expect("removes");
    let lock = std::fs::File::create(scene.folder().join("out.lock")).expect("makes");
    lock.lock().expect("locks");
    let (_, text, code) = scene.run(bake);
    assert!(code == 1 && text.contains("out.glb: another run writes it now"), "{text}");
    drop(lock);
    // What a run that was killed within a checkpoint has left goes with the next.
    write(&scene.folder(), ".out.checkpoint-Ab12.part", "half");
    assert_eq!(scene.run(bake).2, 0);
    for left in [".out.checkpoint-Ab12.part", "out.lock", "out.checkpoint"] {
        assert!(!scene.folder().join(left).exists(), "{left}");
    }
}

/// /dev/full stands for a full disk: the frames end with a warning, the garment is made.
#[test]
fn a_full_disk_loses_frames_and_not_the_bake() {
    let scene = Scene::new();
    write(&scene.folder(), "sheet.obj", wavy_sheet(8, 0.002, Pose::Lying));
    std::fs::create_dir(scene.folder().join("frames")).expect("makes");
    for frame in ["frame_0000.obj", "frame_0003.obj"] {
        symlink("/dev/full", scene.folder().join("frames").join(frame)).expect("links");
        let (_, text, code) = scene.run("bake sheet.obj --wear fold.json -o out.glb --frames frames --fps 5");
        assert!(code == 0 && text.contains("the run continues without frames"), "{code} {text}");
        let report = std::fs::read_to_string(scene.folder().join("out.report.json")).expect("reads");
        assert!(report.contains("the run continues without frames"));
        std::fs::remove_file(scene.folder().join("frames").join(frame)).expect("removes");
    }
}

/// A pair of socks: two nodes of one mesh, one mirrored. Both are worn, or the one that is named; the other keeps its shape.
#[test]
fn each_node_of_a_shared_mesh_is_worn_by_itself() {
    let scene = Scene::new();
    let pair = sheet(|document| {
        push(
            &mut document["nodes"],
            json!({"mesh": 0, "name": "other", "translation": [0, 0, 1], "scale": [-1, 1, 1]}),
        );
        document["scenes"][0]["nodes"] = json!([0, 1]);
    });
    write(&scene.folder(), "pair.gltf", pair);
    let (out, ..) = scene.run("inspect pair.gltf --json");
    let read: Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!((read["pieces"].as_array().map(Vec::len), &read["vertices"]), (Some(2), &json!(98)));
    for (name, worn) in [("other", 1), ("sheet", 0)] {
        let (_, text, code) =
            scene.run(&format!("bake pair.gltf --garment {name} --wear fold.json -o out.glb --quiet"));
        assert_eq!(code, 0, "{text}");
        let (json, _) =
            crease_io::gltf::split_glb(&std::fs::read(scene.folder().join("out.glb")).expect("reads"))
                .expect("is GLB");
        let meshes = [0, 1].map(|node| json["nodes"][node]["mesh"].as_u64().expect("a mesh") as usize);
        assert_ne!(meshes[0], meshes[1]);
        let has_target = |node: usize| json["meshes"][meshes[node]]["primitives"][0]["targets"].is_array();
        assert_eq!((has_target(worn), has_target(1 - worn)), (true, false), "{name}");
    }
}

/// The body, the buffer of a glTF, and a layer of a stage: whatever a job reads runs it again.
#[test]
fn a_batch_runs_again_when_any_file_it_reads_has_changed() {
    let scene = Scene::new();
    let sheet_of = |amplitude: f64| wavy_sheet(4, amplitude, Pose::Lying);
    write(&scene.folder(), "body.obj", "v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nf 1 2 3\n");
    write(&scene.folder(), "sheet.obj", sheet_of(0.002));
    write(&scene.folder(), "my buffer.bin", SECRET.repeat(20));
    write(&scene.folder(), "a.gltf", with_used_buffer("my%20buffer.bin"));
    let file = json!({"format": "crease-batch/1", "garments": ["sheet.obj", "a.gltf"], "wear": ["fold.json"], "bake": ["--body", "body.obj"]});
    write(&scene.folder(), "jobs.json", file.to_string());
    let run = || {
        let path = scene.folder().join("jobs.json").display().to_string();
        let (_, text, _) = crease(&["batch", &path, "--json", "--parallel", "1"]);
        text.lines().filter(|line| line.contains("\"skipped\":true")).count()
    };
    run();
    assert_eq!(run(), 2);
    write(&scene.folder(), "my buffer.bin", SECRET.to_uppercase().repeat(20));
    assert_eq!(run(), 1);
    write(&scene.folder(), "body.obj", "v 0 -2 0\nv 1 -2 0\nv 0 -2 1\nf 1 2 3\n");
    assert_eq!(run(), 0);
    assert_eq!(run(), 2);
}

/// Counts without data, nodes that are their own ancestors, trees that double with every level, a hundred thousand nodes of one mesh, lists
/// within lists. All end at once, with the place of the fault where there is one.
#[test]
fn shapes_that_cost_much_are_refused_or_harmless() {
    let scene = Scene::new();
    type Change = Box<dyn FnOnce(&mut Value)>;
    let cases: Vec<(&str, i32, Change)> = vec![
        ("accessors[0]", 1, Box::new(|d| d["accessors"][0]["count"] = json!(1u64 << 53))),
        (
            "accessors[0]",
            1,
            Box::new(|d| {
                d["accessors"][0] = json!({"componentType": 5126, "count": u32::MAX, "type": "VEC3"})
            }),
        ),
        (
            "accessors[0].sparse",
            1,
            Box::new(|d| {
                d["accessors"][0]["sparse"] = json!({"count": u32::MAX,
                    "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}});
            }),
        ),
        ("bufferViews[0]", 1, Box::new(|d| d["bufferViews"][0]["byteLength"] = json!(1u64 << 53))),
        (
            "own ancestor",
            1,
            Box::new(|d| d["nodes"] = json!([{"children": [1], "mesh": 0}, {"children": [0]}])),
        ),
        ("own ancestor", 1, Box::new(|d| d["nodes"] = json!([{"children": [0], "mesh": 0}]))),
        (
            "also a child",
            1,
            Box::new(|d| {
                let level =
                    |k: usize| if k < 28 { json!({"children": [k + 1, k + 1]}) } else { json!({"mesh": 0}) };
                d["nodes"] = (0..29).map(level).collect();
            }),
        ),
        (
            "",
            0,
            Box::new(|d| {
                d["nodes"] = vec![json!({"mesh": 0}); 100_000].into();
                d["scenes"][0]["nodes"] = (0..100_000).collect();
            }),
        ),
    ];
    for (number, (place, expected, change)) in cases.into_iter().enumerate() {
        write(&scene.folder(), "a.gltf", sheet(change));
        let (_, text, code) = scene.run("inspect a.gltf");
        assert!(code == expected && text.contains(place), "case {number}: {code} {text}");
    }
    let deep = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"extras\": {}{}}}",
        "[".repeat(200_000),
        "]".repeat(200_000)
    );
    write(&scene.folder(), "a.gltf", deep);
    let (_, text, code) = scene.run("inspect a.gltf");
    assert!(code == 1 && text.contains("recursion limit"), "{text}");
}

/// Markup in every name that a page could show.
#[test]
fn names_of_files_are_no_markup_of_a_page() {
    let scene = Scene::new();
    let name = "</script><script>alert(1)</script>";
    write(
        &scene.folder(),
        "a.gltf",
        sheet(|document| {
            document["asset"]["generator"] = json!(name);
            document["nodes"][0]["name"] = json!(name);
            document["materials"][0]["name"] = json!(name);
        }),
    );
    let (_, text, code) = scene.run("bake a.gltf --wear fold.json -o out.glb --quiet");
    assert_eq!(code, 0, "{text}");
    let (_, text, code) = scene.run("view out.glb -o out.html");
    assert_eq!(code, 0, "{text}");
    let page = std::fs::read_to_string(scene.folder().join("out.html")).expect("reads");
    assert!(!page.contains("<script>alert"), "the name is markup");
}
