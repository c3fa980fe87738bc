//! Whole input files, with error messages a user can act on.

use crease::fabric::Fabric;
use crease::{Diagnostic, Error, Result};
use std::io::ErrorKind;
use std::path::Path;

/// Returns `path` as the user wrote it, for messages.
pub fn name_of(path: &Path) -> String {
    path.display().to_string()
}

/// Reads all bytes of a file.
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
            Error::input(file, "", "permission denied", "make the file readable for this user")
        }
        _ => Error::File { file, source },
    })
}

/// Reads a UTF-8 text file.
pub fn text(path: &Path) -> Result<String> {
    String::from_utf8(bytes(path)?).map_err(|broken| {
        let at = broken.utf8_error().valid_up_to();
        let before = broken.as_bytes().get(..at).unwrap_or_default();
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        Error::input(name_of(path), format!("line {line}"), "is not UTF-8 text", "save it as UTF-8")
    })
}

/// Reads a fabric: a preset if `name` is one, otherwise a file. `./NAME` names the file where both exist.
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

/// Merges the diagnostics of several errors into one error. An error without diagnostics takes precedence.
pub fn merge_errors(errors: impl IntoIterator<Item = Error>) -> Error {
    let mut diagnostics = Vec::new();
    for error in errors {
        match error {
            Error::Input(more) => diagnostics.extend(more),
            other => return other,
        }
    }
    Error::Input(diagnostics)
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
