//! Lengths of files; those of functions are a lint (`clippy::too_many_lines`).

use crate::{assert_none, files_below, read};
use std::path::PathBuf;

/// Lines of a file.
const MAX_FILE_LINES: usize = 600;

#[test]
fn files_are_short() {
    let files = ["src", "tests", "garments", "docs"].iter().flat_map(|folder| files_below(folder, &[".rs"]));
    let length = |path: &PathBuf| read(path).lines().count();
    let long = files.map(|path| (length(&path), path)).filter(|(n, _)| *n > MAX_FILE_LINES);
    let faults: Vec<String> = long.map(|(n, path)| format!("{}: {n} lines", path.display())).collect();
    assert_none(&faults, &format!("split each by subject into files of at most {MAX_FILE_LINES} lines"));
}
