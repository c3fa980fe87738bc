//! `-` for an input and for an output: what goes through a pipe is what files would hold.

#[path = "common/glb.rs"]
mod glb;

use glb::{Part, glb};
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
        run.messages.contains("its sidecar, its report and its checkpoints are not written"),
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
            mesh["extras"]["crease"] = serde_json::Value::Null;
        });
        json
    };
    assert_eq!(without_name(&worn), without_name(&to_file));
    // What was piped out can be piped in.
    let applied = expect(piped(folder, "apply - -o -", &worn));
    assert!(applied.starts_with(b"glTF"));
    assert!(expect(piped(folder, "render - -o -", &worn)).starts_with(b"\x89PNG"));
    let carried = expect(piped(folder, "transfer worn.crease.json --to - --garment shirt -o -", &shirt));
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
        ("--resolution 20 --detail-map --height-map", "--height-map needs a place of its own"),
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
    assert_eq!(left_in(folder), [""; 0]);
}
