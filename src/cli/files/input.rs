//! Whole input files, with error messages a user can act on.

use crease_io::{USD_EXTENSIONS, is_usd};
use crease_model::error::{Diagnostic, Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::SourceFormat;
use std::path::Path;

pub use crease::internal::files::{
    STANDARD_STREAM, file_name as name_of, read_bytes as bytes, read_text as text,
};

/// Reads a fabric: a preset if `name` is one, otherwise a file. `./NAME` names the file where both exist.
pub fn fabric(name: &str) -> Result<Fabric> {
    if Fabric::preset_names().contains(&name) {
        return Fabric::preset(name);
    }
    let path = Path::new(name);
    if path.exists() || name == STANDARD_STREAM {
        return Fabric::parse(&name_of(path), &text(path)?);
    }
    match Fabric::preset(name) {
        Err(Error::Input(faults)) => Err(Error::Input(
            faults
                .into_iter()
                .map(|fault| Diagnostic { message: fault.message + ", and no such file", ..fault })
                .collect(),
        )),
        other => other,
    }
}

/// Returns whether `path` is a glTF: by its name, or of the standard input by its content.
///
/// # Errors
/// A standard input that cannot be read.
pub fn is_gltf(path: &Path) -> Result<bool> {
    if path == Path::new(STANDARD_STREAM) {
        let bytes = bytes(path)?;
        let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
        let is_sidecar = || bytes.windows(15).any(|part| part == b"crease-sidecar/");
        return Ok(bytes.starts_with(b"glTF") || (first == Some(&b'{') && !is_sidecar()));
    }
    Ok(path.extension().is_some_and(|e| ["glb", "gltf"].iter().any(|own| e.eq_ignore_ascii_case(own))))
}

/// Returns the format of `path` if it has a unit and an up axis of its own: glTF or USD, by its name, or of the standard input by its
/// content.
///
/// # Errors
/// A standard input that cannot be read.
pub fn format_with_frame(path: &Path) -> Result<Option<SourceFormat>> {
    if is_gltf(path)? {
        return Ok(Some(SourceFormat::Gltf));
    }
    let is_usd = match path == Path::new(STANDARD_STREAM) {
        true => is_usd(&bytes(path)?),
        false => {
            path.extension().is_some_and(|e| USD_EXTENSIONS.iter().any(|own| e.eq_ignore_ascii_case(own)))
        }
    };
    Ok(is_usd.then_some(SourceFormat::Usd))
}

/// Checks that at most one of `options`, each with the path that it names, is the standard input.
///
/// # Errors
/// [`Error::Input`] that names the two.
pub fn check_streams(options: &[(&str, Option<&Path>)]) -> Result<()> {
    let is_stream = |(_, path): &&(&str, Option<&Path>)| *path == Some(Path::new(STANDARD_STREAM));
    let mut streams = options.iter().filter(is_stream).map(|(option, _)| option);
    match (streams.next(), streams.next()) {
        (Some(first), Some(second)) => Err(Error::input(
            "standard input",
            "",
            format!("is named by {first} and by {second}, and holds one of them"),
            format!("give {second} as a file"),
        )),
        _ => Ok(()),
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
