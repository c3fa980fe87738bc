//! Order of the modules within a crate; between crates the compiler keeps it.

use crate::{assert_none, files_below, read, root};
use std::path::PathBuf;

/// Crates whose modules build on each other: the folder, and its modules from the lowest up. A module uses itself and lower ones.
const CRATES: [(&str, &[&str]); 4] = [
    ("src/geometry", &["math", "mesh"]),
    ("src/model", &["error", "json", "fabric", "garment", "body", "remesh"]),
    ("src/solver", &["energy", "contact", "memory", "sim"]),
    ("src", &["wear", "bake", "transfer", "report", "files", "job"]),
];

#[test]
fn modules_use_lower_ones_only() {
    let mut faults = Vec::new();
    for (folder, modules) in CRATES {
        for (floor, module) in modules.iter().enumerate() {
            for path in files_of(folder, module) {
                let text = read(&path);
                // Unit tests may use any module.
                let product = text.split("#[cfg(test)]").next().unwrap_or_default();
                for (number, line) in product.lines().enumerate().filter(|(_, line)| !is_comment(line)) {
                    let higher = |upper: &&&str| line.contains(&format!("crate::{upper}"));
                    if let Some(upper) = modules[floor + 1..].iter().find(higher) {
                        faults.push(format!("{}:{}: {module} uses {upper}", path.display(), number + 1));
                    }
                }
            }
        }
    }
    assert_none(&faults, "move what both need down, or the user up");
}

/// Files of a module, which is a file or a folder.
fn files_of(folder: &str, module: &str) -> Vec<PathBuf> {
    let file = PathBuf::from(format!("{folder}/{module}.rs"));
    if root().join(&file).exists() {
        vec![file]
    } else {
        files_below(&format!("{folder}/{module}"), &[".rs"])
    }
}

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with("//")
}
