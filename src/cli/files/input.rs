//! Reads files whole, with messages a user can act on.

use crease::fabric::Fabric;
use crease::{Diagnostic, Error, Result};
use std::io::ErrorKind;
use std::path::Path;

/// The path as the user wrote it, for messages.
pub fn name_of(path: &Path) -> String {
    path.display().to_string()
}

/// Every byte of a file.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    let file = name_of(path);
    if path.is_dir() {
        return Err(Error::input(file, "", "is a folder, not a file", "name the file in it"));
    }
    std::fs::read(path).map_err(|source| match source.kind() {
        ErrorKind::NotFound => {
            Error::input(file, "", "there is no such file", "check the name and the folder")
        }
        ErrorKind::PermissionDenied => {
            Error::input(file, "", "may not be read", "give yourself the right to read it")
        }
        _ => Error::File { file, source },
    })
}

/// A text file, which must be UTF-8.
pub fn text(path: &Path) -> Result<String> {
    String::from_utf8(bytes(path)?).map_err(|broken| {
        let at = broken.utf8_error().valid_up_to();
        let before = broken.as_bytes().get(..at).unwrap_or_default();
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        Error::input(name_of(path), format!("line {line}"), "is not UTF-8 text", "save it as UTF-8")
    })
}

/// A fabric by the name of a preset, else by its file. `./NAME` means the file where both exist.
pub fn fabric(name: &str) -> Result<Fabric> {
    if Fabric::preset_names().contains(&name) {
        return Fabric::preset(name);
    }
    let path = Path::new(name);
    if path.exists() {
        return Fabric::parse(name, &text(path)?);
    }
    match Fabric::preset(name) {
        Err(Error::Input(faults)) => Err(Error::Input(
            faults
                .into_iter()
                .map(|fault| Diagnostic { message: format!("{}, and no such file", fault.message), ..fault })
                .collect(),
        )),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_read_is_explained() {
        let folder = tempfile::tempdir().expect("a folder");
        let message = |path: &Path| text(path).expect_err("cannot be read").to_string();
        assert!(message(folder.path()).contains("is a folder"));
        assert!(message(&folder.path().join("none.json")).contains("there is no such file"));
        let broken = folder.path().join("broken.json");
        std::fs::write(&broken, b"{\n\xff}").expect("writes");
        assert!(message(&broken).contains("line 2: is not UTF-8"));
    }

    #[test]
    fn a_fabric_is_a_preset_or_a_file() {
        assert_eq!(fabric("denim").expect("a preset").name, "denim");
        let message = fabric("demin").expect_err("neither").to_string();
        assert!(message.contains("no such file") && message.contains("`denim`"), "{message}");
        let folder = tempfile::tempdir().expect("a folder");
        let own = folder.path().join("own.json");
        std::fs::write(&own, r#"{"format": "crease-fabric/1", "name": "own", "based_on": "linen"}"#)
            .expect("writes");
        assert_eq!(fabric(&own.display().to_string()).expect("a file").name, "own");
    }
}
