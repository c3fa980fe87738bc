//! Standard input and output in place of files: a garment or a script that another program writes, and reports that it reads.

#[path = "common/tool.rs"]
mod common;

use common::{Pose, crease_in, wavy_sheet};
use serde_json::Value;
use std::path::Path;

const SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front", "over": 0.2}},
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.4, "hold": 2}},
    {"press": {"pressure": 1000, "for": 2}}]}"#;

/// Runs `crease` in `folder` with `input` on its standard input.
fn fed(folder: &Path, line: &str, input: &[u8]) -> (String, String, i32) {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
    let output = command.current_dir(folder).args(line.split(' ')).write_stdin(input).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("is text");
    (text(output.stdout), text(output.stderr), output.status.code().expect("ends by itself"))
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
    let glb = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("garments/handkerchief.glb"));
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
    assert!(code == 1 && error.contains("stdin"), "{error}");
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
    assert!(code == 1 && error.contains("stdin") && error.contains("actions"), "{error}");
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
