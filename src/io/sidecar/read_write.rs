//! Sidecars as JSON text, plain or compressed with gzip.

use crate::sidecar::format::{SIDECAR_FORMAT, Sidecar};
use crate::sidecar::gzip::decompress;
use crate::sidecar::validate::{REWRITE_HELP, sidecar_help, wrong_format};
use crease_model::error::{Error, Result};
use crease_model::json::kind_of_file;
use serde::Deserialize;
use std::io::Write;

/// Writes a sidecar as JSON text, one line, read back bit for bit by [`read_sidecar`].
pub fn write_sidecar(sidecar: &Sidecar) -> Vec<u8> {
    let mut text = Vec::new();
    // Plain lists and maps with text keys always serialise, and writing to memory cannot fail.
    match write_sidecar_to(sidecar, &mut text) {
        Ok(()) => text,
        Err(_) => Vec::new(),
    }
}

/// Writes a sidecar as [`write_sidecar`] does, piece by piece: the text of one with 60,000 points takes 30 MB.
///
/// # Errors
/// Those of `out`.
pub fn write_sidecar_to(sidecar: &Sidecar, out: &mut dyn Write) -> std::io::Result<()> {
    serde_json::to_writer(&mut *out, sidecar)?;
    out.write_all(b"\n")
}

/// Reads and validates a sidecar from JSON text or from a gzip file of it; `file` names it in diagnostics.
///
/// ```
/// let error = crease_io::read_sidecar("x.crease.json", b"{}").unwrap_err().to_string();
/// assert!(error.starts_with("x.crease.json"), "{error}");
/// ```
pub fn read_sidecar(file: &str, bytes: &[u8]) -> Result<Sidecar> {
    let text = decompress(file, bytes)?;
    let bytes = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&text);
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let sidecar: Sidecar = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        // Another version, or another kind of file, is the better explanation of a missing field.
        stated_format(bytes).filter(|format| format != SIDECAR_FORMAT).map_or_else(
            || match kind_of_file(bytes).filter(|_| stated_format(bytes).is_none()) {
                Some(kind) => Error::input(file, "", format!("is {kind}, not a sidecar"), sidecar_help()),
                None => unreadable(file, &error.path().to_string(), error.inner()),
            },
            |format| Error::Input(vec![wrong_format(file, &format)]),
        )
    })?;
    reader.end().map_err(|error| unreadable(file, "", &error))?;
    sidecar.validate(file)?;
    Ok(sidecar)
}

/// Returns the `format` that a JSON text states, if it is an object that states one.
fn stated_format(bytes: &[u8]) -> Option<String> {
    #[derive(Deserialize)]
    struct Stated {
        format: String,
    }
    serde_json::from_slice::<Stated>(bytes).ok().map(|stated| stated.format)
}

fn unreadable(file: &str, path: &str, error: &serde_json::Error) -> Error {
    // serde_json ends its message with line and column; they belong to the location.
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
    let position = format!("line {}, column {}", error.line(), error.column());
    let location = if path.is_empty() || path == "." { position } else { format!("{position}, {path}") };
    Error::input(file, location, message, REWRITE_HELP)
}
