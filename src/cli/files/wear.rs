//! Wear scripts by path, or by the name of one that is part of the program.

use crate::files::input::{self, STANDARD_STREAM};
use crease::internal::wear::WearScript;
use crease_model::error::Result;
use std::path::Path;

/// Reads the script `path`: a file, or else the script of that name.
pub fn read_script(path: &Path) -> Result<WearScript> {
    WearScript::parse(&input::name_of(path), &script_text(path)?)
}

/// Returns the text of the script `path`.
pub fn script_text(path: &Path) -> Result<String> {
    match path.to_str().filter(|name| *name != STANDARD_STREAM && !path.exists()) {
        Some(name) => match WearScript::preset_text(name) {
            Some(text) => Ok(text.to_owned()),
            // A name without folder and ending was meant as one of the program's.
            None if path.extension().is_none() && path.components().count() == 1 => {
                WearScript::preset(name).map(|_| String::new())
            }
            None => input::text(path),
        },
        None => input::text(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_program_are_scripts_and_misspelt_ones_are_said() {
        assert!(read_script(Path::new("crumple")).is_ok());
        let message = read_script(Path::new("crumpel")).expect_err("there is none").to_string();
        assert!(message.contains("did you mean `crumple`?"), "{message}");
        assert!(read_script(Path::new("no/such.json")).is_err());
    }
}
