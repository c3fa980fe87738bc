//! Mistakes that users make, each with its message: the file, the place in it, the problem and the cure, and the exit code.
//!
//! The messages are in `tests/mistakes.txt`; `CREASE_UPDATE_DOCS=1 cargo test --test mistakes` writes them anew.

#[path = "common/tool.rs"]
mod tool;

use std::fmt::Write;
use std::path::Path;
use tool::{Pose, crease_in, wavy_sheet};

/// What the user wanted to do, and the command.
const MISTAKES: [(&str, &str); 71] = [
    ("a wrong path", "bake shrit.obj --wear wear.json -o out.glb"),
    ("a folder for a file", "inspect folder"),
    ("a format that is not read", "inspect shirt.fbx"),
    ("a mesh without triangles", "inspect points.obj"),
    ("a decimal comma", "inspect comma.obj"),
    ("a glTF without its buffer", "inspect bare.gltf"),
    ("a USD mesh with an index too many", "bake damaged.usda --wear wear.json -o out.glb"),
    ("a USD file that is cut off", "inspect cut.usdc"),
    ("a USD stage whose mesh is in a file that is missing", "inspect stage.usda"),
    ("a wrong unit", "bake centimetres.obj --wear wear.json -o out.glb"),
    ("an unknown unit", "inspect sheet.obj --unit feet"),
    ("an unknown garment", "bake sleeve.glb --garment shirt --wear wear.json -o out.glb"),
    ("an unknown body", "bake sheet.obj --body sleeve.glb --body-node leg --wear bend.json -o out.glb"),
    ("body and garment are one", "bake sleeve.glb --body sleeve.glb --wear bend.json -o out.glb"),
    ("no body to bend", "bake sheet.obj --wear bend.json -o out.glb"),
    ("an unknown joint", "bake sleeve.glb --garment sleeve --body sleeve.glb --wear knee.json -o out.glb"),
    ("an unknown clip", "bake sleeve.glb --garment sleeve --body sleeve.glb --wear clip.json -o out.glb"),
    ("an unknown action", "bake sheet.obj --wear typo.json -o out.glb"),
    ("a script that is no JSON", "bake sheet.obj --wear syntax.json -o out.glb"),
    ("a number out of range", "bake sheet.obj --wear range.json -o out.glb"),
    ("a key twice", "bake sheet.obj --wear twice.json -o out.glb"),
    ("a script of another version", "bake sheet.obj --wear version.json -o out.glb"),
    ("an unknown fabric", "bake sheet.obj --fabric demin --wear wear.json -o out.glb"),
    ("the output is the input", "bake sheet.glb --wear wear.json -o sheet.glb"),
    ("the output's folder is a file", "bake sheet.obj --wear wear.json -o sheet.obj/out.glb"),
    ("an output of another format", "bake sheet.obj --wear wear.json -o out.fbx"),
    ("a folder that cannot be written to", "bake sheet.obj --wear wear.json -o /proc/out.glb"),
    ("a resolution too fine", "bake sheet.obj --wear wear.json --resolution 0.1 -o out.glb"),
    ("a negative length", "bake sheet.obj --wear wear.json --resolution -5 -o out.glb"),
    ("another mesh's sidecar", "transfer memory.crease.json --to sheet.obj --match same -o out.glb"),
    ("no sidecar", "transfer wear.json --to sheet.obj -o out.glb"),
    ("a file that names no sidecar", "transfer sleeve.glb --to sheet.obj -o out.glb"),
    ("a memory that is not part of the program", "transfer fold-trice --to sheet.obj -o out.glb"),
    ("a compressed sidecar that is cut off", "transfer cut.crease.json.gz --to sheet.obj -o out.glb"),
    ("no texture to match by", "transfer memory.crease.json --to sheet.obj --match uv -o out.glb"),
    ("a motion of one file", "remember sheet.obj -o out.glb"),
    ("frames without a rate", "remember folder -o out.glb"),
    ("a mesh and a script the wrong way round", "bake wear.json --wear sheet.obj -o out.glb"),
    ("a mesh for a script", "bake sheet.obj --wear sheet.obj -o out.glb"),
    ("a binary mesh for a script", "bake sheet.obj --wear sleeve.glb -o out.glb"),
    ("a script for a mesh", "inspect wear.json"),
    ("a script for a body", "bake sheet.obj --body wear.json --wear wear.json -o out.glb"),
    ("a sidecar to look at", "view plain.crease.json -o out.html"),
    ("a sidecar for a script", "bake sheet.obj --wear plain.crease.json -o out.glb"),
    ("a report for a sidecar", "transfer worn.report.json --to sheet.obj -o out.glb"),
    ("a report for a mesh", "inspect worn.report.json"),
    ("a mesh for a sidecar", "transfer sheet.obj --to sheet.obj -o out.glb"),
    ("a fabric for a mesh", "inspect linen.json"),
    ("a mesh for a fabric", "bake sheet.obj --fabric sheet.obj --wear wear.json -o out.glb"),
    ("a job file for a script", "bake sheet.obj --wear jobs.json -o out.glb"),
    ("a script for a job file", "batch wear.json"),
    ("a compressed mesh", "inspect sheet.obj.gz"),
    ("a compressed script", "bake sheet.obj --wear wear.json.gz -o out.glb"),
    ("a mesh that was not fetched", "inspect pointer.glb"),
    ("a script that was not fetched", "bake sheet.obj --wear pointer.json -o out.glb"),
    ("a body that was not fetched", "bake sheet.obj --body pointer.glb --wear bend.json -o out.glb"),
    ("a bend in radians", "bake sheet.obj --wear radians.json -o out.glb"),
    ("a fold in radians", "bake sheet.obj --wear fold-radians.json -o out.glb"),
    ("a misspelt script of the program", "bake sheet.obj --wear crumpel -o out.glb"),
    ("no threads", "bake sheet.obj --wear wear.json --threads 0 -o out.glb"),
    ("no jobs at a time", "batch jobs.json --parallel 0"),
    ("a misspelt option in a batch", "batch typo-jobs.json"),
    ("a value in a batch that is no number", "batch value-jobs.json"),
    ("a misspelt script in a batch", "batch script-jobs.json"),
    ("a device for a mesh", "inspect /dev/null"),
    ("a buffer in another folder", "inspect outside.gltf"),
    ("a size of a map after a blank", "bake sheet.obj --wear wear.json --detail-map 1024 -o out.glb"),
    ("a fold of cloth that does not lie", "bake sheet.obj --wear early-fold.json -o out.glb"),
    ("a plan of such a fold", "bake sheet.obj --wear early-fold.json --explain"),
    ("a press of cloth that hangs", "bake sheet.obj --wear hung-press.json -o out.glb"),
    ("an output that cannot be worn", "bake sheet.obj --wear wear.json -o out.obj"),
];

/// Writes the files that the commands read.
fn write_files(folder: &Path) {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("writes");
    let script = |name: &str, actions: &str| {
        write(name, &format!("{{\"format\": \"crease-wear/1\", \"actions\": [\n  {actions}\n]}}\n"));
    };
    let sheet = wavy_sheet(4, 0.0, Pose::Lying);
    write("sheet.obj", &sheet);
    write("sheet.glb", "no mesh yet");
    write("shirt.fbx", "Kaydara FBX Binary");
    write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    write("comma.obj", "v 0 0 0\nv 0,5 0 0\nv 0 1 0\nf 1 2 3\n");
    write("centimetres.obj", "v 0 0 0\nv 60 0 0\nv 0 70 0\nf 1 2 3\n");
    write(
        "bare.gltf",
        r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "cloth.bin", "byteLength": 36}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}]}"#,
    );
    let square = "#usda 1.0\n(\n    metersPerUnit = 1\n)\ndef Xform \"shirt\"\n{\n    def Mesh \"front\"\n    {\n        \
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n        int[] faceVertexCounts = [3]\n        \
        int[] faceVertexIndices = [0, 1, 3]\n    }\n}\n";
    write("damaged.usda", square);
    let seeds = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/fuzz/seeds/usd");
    let whole = std::fs::read(seeds.join("square.usdc")).expect("reads");
    std::fs::write(folder.join("cut.usdc"), &whole[..whole.len() / 2]).expect("writes");
    let memories = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/memories");
    let whole = std::fs::read(memories.join("elbow.crease.json.gz")).expect("reads");
    std::fs::write(folder.join("cut.crease.json.gz"), &whole[..whole.len() / 2]).expect("writes");
    write("stage.usda", "#usda 1.0\ndef \"shirt\" (\n    references = @front.usda@</front>\n)\n{\n}\n");
    script("wear.json", r#"{"lay": {"facing": "front", "over": 0.2}}"#);
    script("bend.json", r#"{"bend": {"joint": "elbow", "axis": "z", "angle": 90}}"#);
    script("knee.json", r#"{"bend": {"joint": "knee", "axis": "z", "angle": 90}}"#);
    script("clip.json", r#"{"play": {"clip": "walk"}}"#);
    script("typo.json", r#"{"fodl": {}}"#);
    script("syntax.json", r#"{"hold": {"for": 1}},"#);
    script("range.json", r#"{"hold": {"for": -1}}"#);
    script("twice.json", r#"{"hold": {"for": 1, "for": 2}}"#);
    write("version.json", r#"{"format": "crease-wear/2", "actions": [{"hold": {"for": 1}}]}"#);
    write_misplaced(folder);
    std::fs::create_dir(folder.join("folder")).expect("makes");
    let own = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments");
    for (from, to) in [("sleeve.glb", "sleeve.glb"), ("memories/elbow.crease.json.gz", "memory.crease.json")]
    {
        std::fs::copy(own.join(from), folder.join(to)).expect("copies");
    }
}

/// Writes files that stand in the place of others.
fn write_misplaced(folder: &Path) {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("writes");
    let script = |name: &str, action: &str| {
        write(name, &format!("{{\"format\": \"crease-wear/1\", \"actions\": [\n  {action}\n]}}\n"));
    };
    let jobs = |name: &str, wear: &str, bake: &str| {
        let text = format!(
            "{{\"format\": \"crease-batch/1\", \"garments\": [\"sheet.obj\"],\n \"wear\": [\"{wear}\"], \"bake\": [{bake}]}}\n"
        );
        write(name, &text);
    };
    write("plain.crease.json", r#"{"format": "crease-sidecar/1", "source": {}}"#);
    write("worn.report.json", r#"{"wall_s": 2.3, "simulated_s": 1.5, "points": 81, "crossings": 0}"#);
    write("linen.json", r#"{"format": "crease-fabric/1", "name": "own", "based_on": "linen"}"#);
    script("radians.json", r#"{"bend": {"joint": "elbow", "axis": "z", "angle": 1.5708}}"#);
    script(
        "fold-radians.json",
        r#"{"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "angle": 3.14159}}"#,
    );
    script("early-fold.json", r#"{"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left"}}"#);
    script("hung-press.json", r#"{"lay": {}}, {"hang": {"for": 1}}, {"press": {"pressure": 100, "for": 1}}"#);
    jobs("jobs.json", "wear.json", "");
    jobs("typo-jobs.json", "wear.json", "\"--stength\", \"0.5\"");
    jobs("value-jobs.json", "wear.json", "\"--strength=much\"");
    jobs("script-jobs.json", "crumpel", "");
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 12\n";
    write("pointer.glb", pointer);
    write("pointer.json", pointer);
    for name in ["sheet.obj.gz", "wear.json.gz"] {
        std::fs::write(folder.join(name), [0x1F, 0x8B, 8, 0, 0, 0, 0, 0, 0, 3]).expect("writes");
    }
    write(
        "outside.gltf",
        r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "/dev/zero", "byteLength": 36}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}]}"#,
    );
}

#[test]
#[cfg(target_os = "linux")]
fn every_mistake_has_its_message_place_cure_and_exit_code() {
    let folder = tempfile::tempdir().expect("a folder");
    write_files(folder.path());
    let before = std::fs::read_dir(folder.path()).expect("lists").count();
    let mut text = String::new();
    for (what, line) in MISTAKES {
        let (out, err, code) = crease_in(folder.path(), line);
        assert_eq!(out, "", "{what}: nothing on standard output");
        assert!(code == 1 || code == 2, "{what}: exit code {code}: {err}");
        let errors: Vec<&str> = err.lines().filter(|line| line.starts_with("error: ")).collect();
        assert!(!errors.is_empty(), "{what}: {err}");
        // Bad input names a file and, in brackets, a cure; wrong usage refers to the help.
        let has_cure = |error: &&str| error.contains(": ") && error.ends_with(')');
        assert!(code == 2 || errors.iter().all(has_cure), "{what}: {err}");
        let _ = writeln!(text, "# {what}\n$ crease {line}\n{}\nexit code {code}\n", err.trim_end());
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("lists").count(), before, "nothing is left behind");
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/mistakes.txt");
    if std::env::var_os("CREASE_UPDATE_DOCS").is_some() {
        std::fs::write(&path, &text).expect("writes");
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(text == golden, "messages differ from tests/mistakes.txt:\n{text}");
}

/// A garment in centimetres that nobody said is in centimetres.
#[test]
fn inspect_shows_what_does_not_depend_on_the_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    let obj = "v 0 0 0\nv 70 0 0\nv 70 0 70\nv 0 0 70\nf 1 4 3\nf 1 3 2\n";
    std::fs::write(folder.path().join("a.obj"), obj).expect("writes");
    for (options, shown) in [("", "2 triangles"), (" --json", "\"points\": 4")] {
        let (out, error, code) = crease_in(folder.path(), &format!("inspect a.obj{options}"));
        assert_eq!(code, 1, "{error}");
        assert!(error.contains("--unit cm makes it 0.70 m"), "{error}");
        assert!(out.contains(shown), "{out}");
    }
    let (out, _, code) = crease_in(folder.path(), "inspect a.obj --unit cm");
    assert_eq!(code, 0, "{out}");
}
