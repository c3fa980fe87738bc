//! Attributes that mark a test as ignored, with a reason: where data or a program is missing, and where it is long.
//!
//! The test harness decides what is ignored when it is compiled, so the attributes look then. Each stands above
//! `#[test]`. A change of the environment variables that they read compiles the test again; data or programs that come
//! later under the same variable are seen after `touch tests/attributes/lib.rs`, or used at once by `cargo test -- --ignored`.
//!
//! ```text
//! #[needs_data("garments/diffavatar-tshirt")]
//! #[long(35)]
//! #[test]
//! fn folds_keep_their_position() { .. }
//! ```

use proc_macro::{Delimiter, TokenStream, TokenTree};
use std::path::PathBuf;

/// Folder of test data that is not part of the repository.
const DATA: &str = "CREASE_TEST_DATA";

/// Switch of the long tests: they run where it is set.
const LONG: &str = "CREASE_LONG_TESTS";

/// Ignores a test where a file or folder of the given names is missing in the folder that `CREASE_TEST_DATA` names.
#[proc_macro_attribute]
pub fn needs_data(names: TokenStream, test: TokenStream) -> TokenStream {
    let folder = std::env::var_os(DATA).filter(|path| !path.is_empty()).map(PathBuf::from);
    let is_there = |name: &String| folder.as_ref().is_some_and(|folder| folder.join(name).exists());
    let missing = literals(names).into_iter().find(|name| !is_there(name));
    let reason = missing.map(|name| format!("needs {name} in the folder that {DATA} names"));
    ignored(test, reason, &[DATA])
}

/// Ignores a test where one of the given programs is not installed. Alternatives are separated by `|`.
#[proc_macro_attribute]
pub fn needs_programs(names: TokenStream, test: TokenStream) -> TokenStream {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let in_path = |name: &str| std::env::split_paths(&path).any(|folder| folder.join(name).is_file());
    let missing = literals(names).into_iter().find(|names| !names.split('|').any(in_path));
    ignored(test, missing.map(|names| format!("needs the program {}", names.replace('|', " or "))), &[])
}

/// Ignores a test of the given duration [s] unless `CREASE_LONG_TESTS` is set.
#[proc_macro_attribute]
pub fn long(seconds: TokenStream, test: TokenStream) -> TokenStream {
    let is_short = std::env::var_os(LONG).is_none_or(|value| value.is_empty());
    ignored(test, is_short.then(|| format!("takes {seconds} s; {LONG}=1 runs it")), &[LONG])
}

/// String literals of a list, without their quotes.
fn literals(list: TokenStream) -> Vec<String> {
    let text = |token| match token {
        TokenTree::Literal(literal) => Some(literal.to_string().trim_matches('"').to_owned()),
        _ => None,
    };
    list.into_iter().filter_map(text).collect()
}

/// `test`, ignored with `reason` where there is one, and compiled again when one of the environment `variables` changes.
fn ignored(test: TokenStream, reason: Option<String>, variables: &[&str]) -> TokenStream {
    if !has_attribute(&test, "test") {
        return "compile_error!(\"this attribute stands above #[test]\");".parse().unwrap_or_default();
    }
    let mut marked = String::new();
    // The first reason is given; a test has one mark.
    if let Some(reason) = reason.filter(|_| !has_attribute(&test, "ignore")) {
        marked = format!("#[ignore = {reason:?}]");
    }
    let tracked: String =
        variables.iter().map(|name| format!("const _: Option<&str> = option_env!({name:?});")).collect();
    let parts = [marked.parse(), Ok(test), tracked.parse()];
    parts.into_iter().filter_map(Result::ok).collect()
}

/// Whether an attribute of the item is, or begins with, `name`.
fn has_attribute(item: &TokenStream, name: &str) -> bool {
    let begins =
        |stream: TokenStream| stream.into_iter().next().is_some_and(|token| token.to_string() == name);
    item.clone().into_iter().any(|token| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Bracket && begins(group.stream()),
        _ => false,
    })
}
