//! Helpers of the tests that run the tool: its process, and a small garment for it.

// Each test uses a part of them.
#![allow(dead_code)]

/// Runs `crease` with `arguments`: standard output, standard error and exit code.
pub fn crease(arguments: &[&str]) -> (String, String, i32) {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
    finish(command.args(arguments))
}

/// Runs `crease` in `folder` with the words of `line` as arguments.
pub fn crease_in(folder: &std::path::Path, line: &str) -> (String, String, i32) {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
    finish(command.current_dir(folder).args(line.split(' ')))
}

fn finish(command: &mut assert_cmd::Command) -> (String, String, i32) {
    let output = command.output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("is text");
    (text(output.stdout), text(output.stderr), output.status.code().expect("ends by itself"))
}

/// Sends a signal such as `-TERM` to a process.
#[cfg(unix)]
pub fn signal(child: &std::process::Child, name: &str) {
    let status = std::process::Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(status.expect("runs").success());
}

/// Orientation of a sheet.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pose {
    /// In the plane of x and z.
    Lying,
    /// In the plane of x and y.
    Hanging,
}

/// An OBJ file of a sheet of `cells` x `cells` squares, 0.2 m wide, with waves of `amplitude` [m].
pub fn wavy_sheet(cells: usize, amplitude: f64, pose: Pose) -> String {
    let row = cells + 1;
    let mut text = String::new();
    for k in 0..row * row {
        let (x, along) = (0.2 * (k % row) as f64 / cells as f64, 0.2 * (k / row) as f64 / cells as f64);
        let height = amplitude * (40.0 * x).sin();
        text += &match pose {
            Pose::Lying => format!("v {x} {height} {along}\n"),
            Pose::Hanging => format!("v {x} {along} {height}\n"),
        };
    }
    for k in (0..row * cells).filter(|k| k % row < cells) {
        let (a, b) = (k + 1, k + 1 + row);
        text += &match pose {
            Pose::Lying => format!("f {a} {b} {}\nf {} {b} {}\n", a + 1, a + 1, b + 1),
            Pose::Hanging => format!("f {a} {} {b}\nf {} {} {b}\n", a + 1, a + 1, b + 1),
        };
    }
    text
}

/// Writes the file `name` in `folder`.
pub fn write(folder: &std::path::Path, name: &str, bytes: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), bytes).expect("writes");
}

/// Writes a wear script of `actions`, JSON with commas between them.
pub fn write_script(folder: &std::path::Path, name: &str, actions: &str) {
    write(folder, name, format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#));
}
