//! Pictures of the docs: each stands in `docs/figures/manifest.json` with the command that made it, the commit whose build it was, and the
//! hash of its bytes, and is shown on a page.

use crate::{assert_none, files_below, read, root};
use serde_json::Value;
use std::path::Path;

/// Entry of a picture.
struct FigureEntry {
    file: String,
    command: String,
    commit: String,
    /// FNV-1a of 64 bits of its bytes.
    hash: String,
}

const MANIFEST: &str = "docs/figures/manifest.json";

fn entries() -> Vec<FigureEntry> {
    let all: Value = serde_json::from_str(&read(Path::new(MANIFEST))).expect("is JSON");
    let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    let entry = |entry: &Value| FigureEntry {
        file: text(entry, "file"),
        command: text(entry, "command"),
        commit: text(entry, "commit"),
        hash: text(entry, "fnv1a"),
    };
    all.as_array().expect("is a list").iter().map(entry).collect()
}

fn fnv1a(bytes: &[u8]) -> String {
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix))
}

#[test]
fn every_picture_has_its_command_and_the_commit_that_made_it() {
    let (entries, mut faults) = (entries(), Vec::new());
    let pages = files_below("", &[".md"]);
    let text: String = pages.iter().map(|page| read(page)).collect();
    for picture in files_below("docs/figures", &[".png"]) {
        let name = picture.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        let Some(entry) = entries.iter().find(|entry| entry.file == name) else {
            faults.push(format!("{name}: not in the manifest"));
            continue;
        };
        let bytes = std::fs::read(root().join(&picture)).expect("reads");
        if fnv1a(&bytes) != entry.hash {
            faults.push(format!(
                "{name}: another picture than the manifest's, whose hash would be {}",
                fnv1a(&bytes)
            ));
        }
        if !text.contains(&format!("figures/{name}")) {
            faults.push(format!("{name}: no page shows it"));
        }
    }
    for FigureEntry { file, command, commit, .. } in &entries {
        if !root().join("docs/figures").join(file).exists() {
            faults.push(format!("{file}: in the manifest, but there is no such picture"));
        }
        let is_hash = commit.len() >= 7 && commit.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_hash || !["crease ", "cargo "].iter().any(|start| command.starts_with(start)) {
            faults.push(format!("{file}: no command or no commit"));
        }
    }
    assert_none(&faults, &format!("make the picture anew and state command, commit and hash in {MANIFEST}"));
}

#[test]
fn charts_in_the_docs_are_charts_of_the_tool() {
    let charts: Vec<&str> = crease_chart::Chart::list().map(|(name, _)| name).collect();
    let unknown = |entry: &FigureEntry| {
        let name = entry.command.strip_prefix("crease chart ")?.split(' ').next()?;
        (!charts.contains(&name)).then(|| format!("{}: there is no chart {name}", entry.file))
    };
    let faults: Vec<String> = entries().iter().filter_map(unknown).collect();
    assert_none(&faults, "name a chart of `crease chart`");
}
