//! Ctrl-C during a bake: what is said, and what is left to go on with.
#![cfg(unix)]

#[path = "common/tool.rs"]
mod common;

use common::{Pose, signal, wavy_sheet};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// More wear than anybody waits for.
const SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front", "over": 0.3}},
    {"repeat": {"times": 500, "actions": [{"crumple": {"to": 0.5, "over": 0.5}}, {"hang": {"for": 0.5}}]}}]}"#;

#[test]
fn an_interrupted_bake_says_how_it_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("sheet.obj"), wavy_sheet(9, 0.004, Pose::Hanging)).expect("writes");
    std::fs::write(path("w.json"), SCRIPT).expect("writes");
    let child = Command::new(env!("CARGO_BIN_EXE_crease"))
        .current_dir(folder.path())
        .args([
            "bake",
            "sheet.obj",
            "--wear",
            "w.json",
            "-o",
            "out.glb",
            "--quality",
            "draft",
            "--checkpoint-every",
            "0",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .expect("runs");
    // Its first checkpoint is written after the first action.
    let started = Instant::now();
    while !path("out.checkpoint").exists() {
        assert!(started.elapsed() < Duration::from_secs(120), "has written no checkpoint");
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(130), "it ends by itself");
    let error = String::from_utf8(output.stderr).expect("is text");
    let told = error.lines().find(|line| line.contains("out.checkpoint")).unwrap_or_default();
    assert!(told.contains("--resume"), "{error}");
    let left = std::fs::read(path("out.checkpoint")).expect("is left");
    assert!(crease::internal::bake::Checkpoint::parse("out.checkpoint", &left).is_ok(), "it can be read");
    for name in ["out.glb", "out.crease.json", "out.report.json"] {
        assert!(!path(name).exists(), "{name} of half a run");
    }
}
