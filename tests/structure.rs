//! The structure of the source, read from the source: order of the modules within a crate, lengths of files, links of the docs,
//! citations of files, and options in messages of the library.
//!
//! Every message names the file and line and says how to mend it.

#[path = "structure/citations.rs"]
mod citations;
#[path = "structure/figures.rs"]
mod figures;
#[path = "structure/floors.rs"]
mod floors;
#[path = "structure/lengths.rs"]
mod lengths;
#[path = "structure/messages.rs"]
mod messages;

use std::path::{Path, PathBuf};

/// Root of the repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below `folder` (relative to the root) whose names end in one of `endings`, sorted; paths relative to the
/// root. Leaves out build outputs and what begins with a dot.
fn files_below(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(root().join(&folder)).expect("a folder of the repository");
        for entry in entries.map(|entry| entry.expect("an entry")) {
            let name = entry.file_name().into_string().expect("a name in UTF-8");
            let path = folder.join(&name);
            let is_folder = entry.file_type().expect("a type").is_dir();
            if is_folder && !name.starts_with('.') && !name.starts_with("out") && name != "target" {
                folders.push(path);
            } else if !is_folder && endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Text of a file of the repository.
fn read(path: &Path) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Fails with all `faults`, one a line, and what to do about them.
fn assert_none(faults: &[String], cure: &str) {
    assert!(faults.is_empty(), "{} found; {cure}:\n{}", faults.len(), faults.join("\n"));
}
