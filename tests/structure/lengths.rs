//! Lengths of functions and files.

use crate::tokens::{Token, closing, tokens};
use crate::{assert_none, files_below, read};
use std::path::PathBuf;

/// Lines of a function, from `fn` to its closing brace.
const MAX_FUNCTION_LINES: usize = 100;
/// Lines of a file.
const MAX_FILE_LINES: usize = 600;

fn rust_files() -> Vec<PathBuf> {
    ["src", "tests", "garments", "docs"].iter().flat_map(|folder| files_below(folder, &[".rs"])).collect()
}

#[test]
fn functions_are_short() {
    let mut faults = Vec::new();
    for path in rust_files() {
        let all = tokens(&read(&path));
        for at in (0..all.len()).filter(|at| all[*at].text == "fn") {
            let Some(length) = function_lines(&all, at) else { continue };
            if length > MAX_FUNCTION_LINES {
                let (line, name) = (all[at].line, &all[at + 1].text);
                faults.push(format!("{}:{line}: {name}: {length} lines", path.display()));
            }
        }
    }
    assert_none(&faults, &format!("split each into functions of at most {MAX_FUNCTION_LINES} lines"));
}

/// Lines of the function whose `fn` is at `at`; `None` for a type, and for a function without a body.
fn function_lines(all: &[Token], at: usize) -> Option<usize> {
    if !all.get(at + 1)?.is_word() {
        return None;
    }
    let mut next = at + 2;
    while all.get(next)?.text != "{" {
        match all[next].text.as_str() {
            ";" => return None,
            "(" | "[" => next = closing(all, next) + 1,
            _ => next += 1,
        }
    }
    Some(all[closing(all, next)].line - all[at].line + 1)
}

#[test]
fn files_are_short() {
    let length = |path: &PathBuf| read(path).lines().count();
    let long =
        rust_files().into_iter().map(|path| (length(&path), path)).filter(|(n, _)| *n > MAX_FILE_LINES);
    let faults: Vec<String> = long.map(|(n, path)| format!("{}: {n} lines", path.display())).collect();
    assert_none(&faults, &format!("split each by subject into files of at most {MAX_FILE_LINES} lines"));
}

#[test]
fn lengths_are_counted() {
    let text =
        "fn a(b: fn(u8) -> u8) -> [u8; 2]\nwhere\n    C: D,\n{\n    {}\n}\ntrait E {\n    fn f();\n}\n";
    let all = tokens(text);
    let found: Vec<Option<usize>> =
        (0..all.len()).filter(|at| all[*at].text == "fn").map(|at| function_lines(&all, at)).collect();
    assert_eq!(found, [Some(6), None, None]);
}
