//! Messages of the library: none names an option or a command of the tool. They hold settings and operations as data
//! (`crease::Message`), which the tool words as options and Python as keywords.

use crate::{assert_none, files_below, read};

/// Source that is no library: the tool and the bindings, with their tables of words.
const FRONT_ENDS: [&str; 3] = ["src/cli", "src/python", "src/blender"];
/// Texts about options of other programs.
const OTHER_PROGRAMS: [&str; 1] = ["usdcat --flatten"];

/// Returns the first option, `--name`, or command, `` `crease name ``, in `text`.
fn named(text: &str) -> Option<&str> {
    let is_letter = |at: usize| text.as_bytes().get(at).is_some_and(u8::is_ascii_lowercase);
    let begins = |at: usize| !text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '-');
    let options = text.match_indices("--").filter(|(at, sign)| begins(*at) && is_letter(at + sign.len()));
    let commands = text.match_indices("`crease ").filter(|(at, name)| is_letter(at + name.len()));
    let (start, sign) = options.chain(commands).next()?;
    let rest = &text[start + sign.len()..];
    let length = rest.find(|c: char| !c.is_alphanumeric() && c != '-').unwrap_or(rest.len());
    Some(&text[start..start + sign.len() + length])
}

#[test]
fn messages_of_the_library_name_no_option_and_no_command() {
    let mut faults = Vec::new();
    let files = files_below("src", &[".rs"]).into_iter();
    for file in files.filter(|file| !FRONT_ENDS.iter().any(|folder| file.starts_with(folder))) {
        let text = read(&file);
        let code = text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
        for (number, line) in code {
            let text = OTHER_PROGRAMS.iter().fold(line.to_owned(), |text, other| text.replace(other, ""));
            if let Some(named) = named(&text) {
                faults.push(format!("{}:{}: {named}", file.display(), number + 1));
            }
        }
    }
    assert_none(&faults, "hold it as data: `Setting` or `Operation` in a `Message`");
}

#[test]
fn options_and_commands_are_found() {
    let found =
        ["use --up y", "(--weld)", "--hold", "`crease fabric list`", "see `crease inspect`"].map(named);
    assert_eq!(
        found.map(Option::unwrap_or_default),
        ["--up", "--weld", "--hold", "`crease fabric", "`crease inspect"]
    );
    assert_eq!(["a -- b", "crease report", "a--b", "`crease`", "---", "`Bake`"].map(named), [None; 6]);
}
