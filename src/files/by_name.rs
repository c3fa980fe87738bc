//! Wear scripts and fabrics by path, or by the name of one that is part of the program.

use crate::files::read::{STANDARD_STREAM, file_name, read_text};
use crate::wear::WearScript;
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use std::path::Path;

/// Reads the script `path`: a file, or else the script of that name.
pub fn read_script(path: &Path) -> Result<WearScript> {
    WearScript::parse(&file_name(path), &script_text(path)?)
}

/// Returns the text of the script `path`.
fn script_text(path: &Path) -> Result<String> {
    match path.to_str().filter(|name| *name != STANDARD_STREAM && !path.exists()) {
        Some(name) => match WearScript::preset_text(name) {
            Some(text) => Ok(text.to_owned()),
            // A name without folder and ending was meant as one of the program's.
            None if path.extension().is_none() && path.components().count() == 1 => {
                WearScript::preset(name).map(|_| String::new())
            }
            None => read_text(path),
        },
        None => read_text(path),
    }
}

/// Reads a fabric: a preset if `name` is one, otherwise a file. `./NAME` names the file where both exist.
pub fn read_fabric(name: &str) -> Result<Fabric> {
    if Fabric::preset_names().contains(&name) {
        return Fabric::preset(name);
    }
    let path = Path::new(name);
    if path.exists() || name == STANDARD_STREAM {
        return Fabric::parse(&file_name(path), &read_text(path)?);
    }
    match Fabric::preset(name) {
        Err(Error::Input(faults)) => Err(Error::Input(
            faults
                .into_iter()
                .map(|mut fault| {
                    fault.message = fault.message + ", and no such file";
                    fault
                })
                .collect(),
        )),
        other => other,
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

    #[test]
    fn a_fabric_is_a_preset_or_a_file() {
        assert_eq!(read_fabric("denim").expect("a preset").name, "denim");
        let message = read_fabric("demin").expect_err("neither").to_string();
        assert!(message.contains("no such file") && message.contains("`denim`"), "{message}");
        let folder = tempfile::tempdir().expect("a folder");
        let own = folder.path().join("own.json");
        std::fs::write(&own, r#"{"format": "crease-fabric/1", "name": "own", "based_on": "linen"}"#)
            .expect("writes");
        assert_eq!(read_fabric(&own.display().to_string()).expect("a file").name, "own");
    }
}
