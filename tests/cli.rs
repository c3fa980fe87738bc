//! The tool from outside: what it prints where, and its exit codes.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;

fn crease() -> Command {
    Command::new(env!("CARGO_BIN_EXE_crease"))
}

/// Standard output, standard error and exit code.
fn run(arguments: &[&str]) -> (String, String, i32) {
    let output = crease().args(arguments).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("is text");
    (text(output.stdout), text(output.stderr), output.status.code().expect("ends by itself"))
}

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
    for (format, title) in
        [("wear", "crease wear script"), ("fabric", "crease fabric"), ("report", "crease report")]
    {
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
    assert!(out.lines().any(|line| line.starts_with("kow-tshirt") && line.ends_with("(default)")), "{out}");

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
