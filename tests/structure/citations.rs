//! Links and images of Markdown files, and files that comments and docs cite: all of them exist.

use crate::{assert_none, files_below, read, root};
use std::path::{Path, PathBuf};

/// Histories, which may speak of what is gone.
const HISTORIES: [&str; 2] = ["CHANGELOG.md", "docs/lab"];
/// Folders that a cited path may start in, besides that of the citing file.
const BASES: [&str; 3] = ["", "src", "docs"];

/// A piece of text that names a file, and the line it stands in.
type Citation<'a> = (usize, &'a str);

/// Targets of links and images of a Markdown text, without those in code blocks.
fn links(text: &str) -> Vec<Citation<'_>> {
    let (mut found, mut is_code) = (Vec::new(), false);
    for (number, line) in text.lines().enumerate() {
        is_code ^= line.trim_start().starts_with("```");
        if is_code {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            let target = line[at + 2..].split([')', ' ']).next().unwrap_or_default();
            found.push((number + 1, target));
        }
        for attribute in ["src=\"", "href=\""] {
            for (at, _) in line.match_indices(attribute) {
                let target = line[at + attribute.len()..].split('"').next().unwrap_or_default();
                found.push((number + 1, target));
            }
        }
    }
    found
}

/// Anchors of the headings of a Markdown text, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| -> String {
        let title = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_of_markdown_lead_somewhere() {
    let mut faults = Vec::new();
    let pages = [files_below("", &[".md"]), github_pages()].concat();
    for page in &pages {
        let text = read(page);
        let folder = page.parent().unwrap_or(Path::new(""));
        for (line, target) in links(&text) {
            if target.is_empty() || target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if file.is_empty() { page.clone() } else { folder.join(file) };
            if !root().join(&file).exists() {
                faults.push(format!("{}:{line}: {target}: there is no such file", page.display()));
            } else if !anchor.is_empty()
                && file.extension().is_some_and(|e| e == "md")
                && !anchors(&read(&file)).iter().any(|own| own == anchor)
            {
                faults.push(format!("{}:{line}: {target}: there is no such heading", page.display()));
            }
        }
    }
    assert_none(&faults, "mend the target of each");
}

/// Markdown files of `.github`, which the walk leaves out.
fn github_pages() -> Vec<PathBuf> {
    if root().join(".github").is_dir() { files_below(".github", &[".md"]) } else { Vec::new() }
}

/// Words of `text` that name a source file or a page: `docs/theory/memory.md`, `mesh/ccd.rs`.
fn citations(text: &str) -> Vec<Citation<'_>> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let is_part = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
        for word in line.split(|c| !is_part(c)) {
            let word = word.trim_end_matches('.');
            // A table of Cargo.toml is named after the host of documentation.
            let is_file =
                (word.ends_with(".md") || word.ends_with(".rs")) && word != "package.metadata.docs.rs";
            let is_placeholder = word.contains("NAME") || word.contains("...") || word.starts_with('.');
            if is_file && !is_placeholder && !word.starts_with('/') {
                found.push((number + 1, word));
            }
        }
    }
    found
}

#[test]
fn cited_files_exist() {
    let mut faults = Vec::new();
    for path in &files_below("", &[".rs", ".md", ".toml", ".py"]) {
        if HISTORIES.iter().any(|history| path.starts_with(history)) || path.starts_with("tests/structure") {
            continue;
        }
        let text = read(path);
        let folder = path.parent().unwrap_or(Path::new(""));
        for (line, cited) in citations(&text) {
            let bases = BASES.iter().map(Path::new).chain(folder.ancestors());
            if !bases.map(|base| root().join(base).join(cited)).any(|file| file.exists()) {
                faults.push(format!("{}:{line}: {cited}", path.display()));
            }
        }
        if !path.starts_with("tests") {
            let outside = text.lines().enumerate().filter(|(_, line)| line.contains("../shared"));
            faults.extend(outside.map(|(n, _)| format!("{}:{}: ../shared", path.display(), n + 1)));
        }
    }
    assert_none(
        &faults,
        "cite a file of the repository, by its path from the root, from src, or from the citing file",
    );
}

/// Filters of `cargo test` commands in a Markdown text: `cargo test --test memory FILTER`.
fn test_filters(text: &str) -> Vec<Citation<'_>> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        for (at, command) in line.match_indices("cargo test ") {
            let rest = line[at + command.len()..].split('`').next().unwrap_or_default();
            let mut words = rest.split_whitespace();
            let filter = match words.next() {
                Some("--test") => words.nth(1),
                Some("--lib") => words.next(),
                _ => None,
            };
            let is_name = |word: &&str| word.chars().all(|c| c.is_ascii_lowercase() || "_:".contains(c));
            found.extend(filter.filter(is_name).map(|filter| (number + 1, filter)));
        }
    }
    found
}

#[test]
fn cited_tests_exist() {
    let files: Vec<PathBuf> =
        ["src", "tests"].iter().flat_map(|folder| files_below(folder, &[".rs"])).collect();
    let mut names: Vec<String> =
        files.iter().map(|path| path.display().to_string().replace('/', "::")).collect();
    for path in &files {
        let text = read(path);
        names.extend(text.match_indices("fn ").map(|(at, _)| {
            text[at + 3..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
        }));
    }
    let mut faults = Vec::new();
    for page in files_below("", &[".md"]) {
        if HISTORIES.iter().any(|history| page.starts_with(history)) {
            continue;
        }
        for (line, filter) in test_filters(&read(&page)) {
            if !names.iter().any(|name| name.contains(filter)) {
                faults.push(format!("{}:{line}: {filter}", page.display()));
            }
        }
    }
    assert_none(&faults, "name a test that exists");
}

#[test]
fn links_and_citations_are_read() {
    let text = "see [a](b#c) ![d](e.png)\n```\n[f](g)\n```\n`docs/x/y.md`, mesh/ccd.rs. and NAME.rs";
    assert_eq!(links(text), [(1, "b#c"), (1, "e.png")]);
    assert_eq!(citations(text), [(5, "docs/x/y.md"), (5, "mesh/ccd.rs")]);
    let commands =
        "`cargo test --test memory fifty -- --nocapture`, `cargo test --lib a::b`, `cargo test --test cli`";
    assert_eq!(test_filters(commands), [(1, "fifty"), (1, "a::b")]);
    assert_eq!(anchors("# One\n## Two words, and `x_y`"), ["one", "two-words-and-x_y"]);
}
