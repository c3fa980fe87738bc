//! `-` for an input and for an output: what goes through a pipe is what files would hold.

#[path = "common/tool.rs"]
mod common;
#[path = "common/glb.rs"]
mod glb;

use common::{Pose, crease_in, wavy_sheet};
use glb::{Part, glb};
use serde_json::Value;
use std::path::Path;

/// Result of a command: standard output, standard error, exit code.
struct Piped {
    bytes: Vec<u8>,
    messages: String,
    code: i32,
}

/// Runs the words of `line` in `folder` with `input` as standard input.
fn piped(folder: &Path, line: &str, input: &[u8]) -> Piped {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
    let command = command.current_dir(folder).args(line.split(' ')).write_stdin(input);
    let output = command.output().expect("runs");
    Piped {
        bytes: output.stdout,
        messages: String::from_utf8(output.stderr).expect("is text"),
        code: output.status.code().expect("ends by itself"),
    }
}

fn expect(piped: Piped) -> Vec<u8> {
    assert_eq!(piped.code, 0, "{}", piped.messages);
    piped.bytes
}

const FOLD: &str = r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 0.1}}]}"#;

fn folder_with_shirt() -> (tempfile::TempDir, Vec<u8>) {
    let folder = tempfile::tempdir().expect("a folder");
    let shirt = glb(
        &[
            ("shirt", vec![Part::sheet(6, 0.4, [0.0, 1.0, 0.12])]),
            ("body", vec![Part::can(16, 0.1, 0.8, [0.0, 1.0, 0.0])]),
        ],
        |_| (),
    );
    std::fs::write(folder.path().join("shirt.glb"), &shirt).expect("writes");
    std::fs::write(folder.path().join("wear.json"), FOLD).expect("writes");
    (folder, shirt)
}

/// Names in `folder` beside the inputs.
fn left_in(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).expect("lists").map(|entry| entry.expect("is one").file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.retain(|name| name != "shirt.glb" && name != "wear.json");
    names.sort();
    names
}

#[test]
fn a_garment_goes_to_the_standard_output_alone() {
    let (folder, shirt) = folder_with_shirt();
    let folder = folder.path();
    let bake = "bake shirt.glb --garment shirt --wear wear.json -o -";
    let run = piped(folder, bake, &[]);
    assert!(
        run.messages.contains("no sidecar, report or checkpoint is written beside it"),
        "{}",
        run.messages
    );
    let worn = expect(run);
    assert_eq!(left_in(folder), [""; 0], "nothing is left beside");
    expect(piped(folder, &bake.replace("-o -", "-o worn.glb"), &[]));
    let to_file = std::fs::read(folder.join("worn.glb")).expect("is there");
    // The file names its sidecar; otherwise they are one.
    let without_name = |bytes: &[u8]| {
        let mut json = glb::json_of(bytes);
        json["meshes"].as_array_mut().expect("has meshes").iter_mut().for_each(|mesh| {
            mesh["extras"]["crease"] = Value::Null;
        });
        json
    };
    assert_eq!(without_name(&worn), without_name(&to_file));
    // What was piped out can be piped in.
    let applied = expect(piped(folder, "apply - -o -", &worn));
    assert!(applied.starts_with(b"glTF"));
    assert!(expect(piped(folder, "render - -o -", &worn)).starts_with(b"\x89PNG"));
    assert!(expect(piped(folder, "example handkerchief -o -", &[])).starts_with(b"glTF"));
    let carried =
        expect(piped(folder, "transfer worn.crease.json --to - --garment shirt --strength 0 -o -", &shirt));
    assert!(carried.starts_with(b"glTF"));
}

#[test]
fn every_input_may_be_the_standard_input() {
    let (folder, shirt) = folder_with_shirt();
    let folder = folder.path();
    let files = expect(piped(
        folder,
        "bake shirt.glb --garment shirt --body shirt.glb --body-node body --wear wear.json -o -",
        &[],
    ));
    let fabric = expect(piped(folder, "fabric show cotton-jersey", &[]));
    for (line, input) in [
        ("bake - --garment shirt --body - --body-node body --wear wear.json -o -", &shirt[..]),
        ("bake - --garment shirt --body shirt.glb --body-node body --wear wear.json -o -", &shirt),
        ("bake shirt.glb --garment shirt --body - --body-node body --wear wear.json -o -", &shirt),
        ("bake shirt.glb --garment shirt --body shirt.glb --body-node body --wear - -o -", FOLD.as_bytes()),
        (
            "bake shirt.glb --garment shirt --body shirt.glb --body-node body --wear wear.json --fabric - -o -",
            &fabric,
        ),
    ] {
        assert!(expect(piped(folder, line, input)) == files, "{line}");
    }
    assert!(String::from_utf8_lossy(&expect(piped(folder, "inspect -", &shirt))).contains("standard input"));
    assert_eq!(left_in(folder), [""; 0]);
}

#[test]
fn what_one_stream_cannot_hold_is_refused() {
    let (folder, shirt) = folder_with_shirt();
    let folder = folder.path();
    for (option, told) in [
        ("--json", "--json needs a place of its own"),
        ("--preview", "--preview needs a place of its own"),
        ("--export obj", "--export needs a place of its own"),
        ("--resume", "--resume needs a place of its own"),
        ("--explain", "--explain needs a place of its own"),
        ("--resolution 20 --detail-map --map-files", "--map-files needs a place of its own"),
    ] {
        let run =
            piped(folder, &format!("bake shirt.glb --garment shirt --wear wear.json -o - {option}"), &[]);
        assert!(run.code == 1 && run.bytes.is_empty(), "{option}: {}", run.code);
        assert!(
            run.messages.contains(told) && run.messages.contains("name a file with -o"),
            "{}",
            run.messages
        );
    }
    let run = piped(folder, "bake - --garment shirt --wear - -o worn.glb", &shirt);
    assert!(run.code == 1 && run.messages.contains("is named by MESH and by --wear"), "{}", run.messages);
    let run = piped(folder, "transfer - --to - -o worn.glb", &shirt);
    assert!(run.code == 1 && run.messages.contains("is named by SIDECAR and by --to"), "{}", run.messages);
    assert_eq!(left_in(folder), [""; 0]);
}

const SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front", "over": 0.2}},
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.4, "hold": 2}},
    {"press": {"pressure": 1000, "for": 2}}]}"#;

/// [`piped`] with the standard output as text.
fn fed(folder: &Path, line: &str, input: &[u8]) -> (String, String, i32) {
    let Piped { bytes, messages, code } = piped(folder, line, input);
    (String::from_utf8(bytes).expect("is text"), messages, code)
}

/// A folder with `sheet.obj` and `w.json`.
fn workshop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("sheet.obj"), wavy_sheet(6, 0.003, Pose::Hanging)).expect("writes");
    std::fs::write(folder.path().join("w.json"), SCRIPT).expect("writes");
    folder
}

fn json_in(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).expect("is written")).expect("is JSON")
}

#[test]
fn a_garment_is_read_from_the_standard_input() {
    let folder = workshop();
    let folder = folder.path();
    let glb = std::fs::read(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/handkerchief.glb"),
    );
    std::fs::write(folder.join("cloth.glb"), glb.expect("is there")).expect("writes");
    for file in ["cloth.glb", "sheet.obj"] {
        let bytes = std::fs::read(folder.join(file)).expect("is there");
        let (of_file, ..) = crease_in(folder, &format!("inspect {file} --json"));
        let (of_stream, error, code) = fed(folder, "inspect - --json", &bytes);
        assert_eq!(code, 0, "{file}: {error}");
        let [mut of_file, mut of_stream]: [Value; 2] =
            [of_file, of_stream].map(|text| serde_json::from_str(&text).expect("is JSON"));
        // They differ in the name alone.
        for one in [&mut of_file, &mut of_stream] {
            one["file"] = Value::Null;
        }
        assert_eq!(of_file, of_stream, "{file}");
        let (text, _, code) = fed(folder, "inspect -", &bytes);
        assert!(code == 0 && text.contains("crossings"), "{text}");
    }
    let (_, error, code) = fed(folder, "inspect -", b"neither of them");
    assert!(code == 1 && error.contains("standard input"), "{error}");
}

/// A bake of a stream is that of the file, whichever of both the stream is.
#[test]
fn garment_and_script_come_from_the_standard_input() {
    let folder = workshop();
    let folder = folder.path();
    let common = "--quality draft --quiet --preview";
    let sheet = std::fs::read(folder.join("sheet.obj")).expect("is there");
    for (name, line, input) in [
        ("files", "bake sheet.obj --wear w.json", &b""[..]),
        ("garment", "bake - --wear w.json", &sheet),
        ("script", "bake sheet.obj --wear -", SCRIPT.as_bytes()),
    ] {
        let (_, error, code) = fed(folder, &format!("{line} -o {name}.glb {common}"), input);
        assert_eq!(code, 0, "{name}: {error}");
    }
    let of_file = json_in(folder, "files.crease.json");
    assert!(of_file["points"]["displacement_m"].as_array().is_some_and(|list| list.len() == 49), "is worn");
    for name in ["garment", "script"] {
        let own = json_in(folder, &format!("{name}.crease.json"));
        for part in ["points", "hinges", "triangles"] {
            assert_eq!(own[part], of_file[part], "{name}: {part}");
        }
    }
    let (_, error, code) =
        fed(folder, "bake sheet.obj --wear - -o no.glb", br#"{"format": "crease-wear/1"}"#);
    assert!(code == 1 && error.contains("standard input") && error.contains("actions"), "{error}");
    assert!(!folder.join("no.glb").exists());
}

/// `--json`: the report alone on standard output, and a JSON value in every line of standard error.
#[test]
fn reports_are_json_on_the_standard_output() {
    let folder = workshop();
    let folder = folder.path();
    let (out, error, code) =
        crease_in(folder, "bake sheet.obj --wear w.json -o a.glb --quality draft --json");
    assert_eq!(code, 0, "{error}");
    let report: Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!(report, json_in(folder, "a.report.json"));
    let stages: Vec<Value> = error
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|why| panic!("{why}: {line}")))
        .collect();
    assert!(stages.iter().any(|line| line["stage"] == "fold"), "{error}");

    std::fs::create_dir(folder.join("frames")).expect("makes");
    for k in 0..3 {
        let frame = wavy_sheet(6, 0.003 + 0.004 * f64::from(k), Pose::Hanging);
        std::fs::write(folder.join(format!("frames/f{k}.obj")), frame).expect("writes");
    }
    for line in [
        "transfer a.crease.json --to sheet.obj -o b.glb --json --quiet",
        "remember frames --fps 10 -o b.glb --json --quiet",
    ] {
        let (out, error, code) = crease_in(folder, line);
        assert!(code == 0 || code == 3, "{line}: {error}");
        let report: Value = serde_json::from_str(&out).expect("is JSON");
        assert_eq!(report, json_in(folder, "b.report.json"), "{line}");
    }
}
