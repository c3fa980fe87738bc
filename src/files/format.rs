//! Formats of files by their names, or of the standard input by its content.

use crate::files::read::{STANDARD_STREAM, read_bytes};
use crease_io::{USD_EXTENSIONS, is_usd};
use crease_model::error::Result;
use crease_model::garment::SourceFormat;
use std::path::Path;

/// Returns whether `path` is a glTF: by its name, or of the standard input by its content.
///
/// # Errors
/// A standard input that cannot be read.
pub fn is_gltf(path: &Path) -> Result<bool> {
    if path == Path::new(STANDARD_STREAM) {
        let bytes = read_bytes(path)?;
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
        true => is_usd(&read_bytes(path)?),
        false => {
            path.extension().is_some_and(|e| USD_EXTENSIONS.iter().any(|own| e.eq_ignore_ascii_case(own)))
        }
    };
    Ok(is_usd.then_some(SourceFormat::Usd))
}
