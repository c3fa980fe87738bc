//! Sidecars compressed with gzip, told from JSON text by their first bytes.

use crate::sidecar::validate::REWRITE_HELP;
use crate::tuning::TUNING;
use crease_model::error::{Error, Result};
use flate2::read::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;

/// First bytes of a gzip file.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Returns `bytes` as they are, or decompressed if they are a gzip file; `file` names it in diagnostics.
///
/// # Errors
/// [`Error::Input`] for a damaged or cut file, and for content longer than `max_gzip_ratio` allows.
pub(super) fn decompress<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    let limit = bytes.len().saturating_mul(TUNING.max_gzip_ratio).max(TUNING.min_gzip_budget);
    let mut content = Vec::new();
    // One byte more than allowed tells content of exactly that length from a longer one.
    let mut decoder = MultiGzDecoder::new(bytes).take((limit as u64).saturating_add(1));
    if let Err(error) = decoder.read_to_end(&mut content) {
        return Err(Error::input(file, "gzip", format!("is damaged or cut off: {error}"), REWRITE_HELP));
    }
    if content.len() > limit {
        let ratio = TUNING.max_gzip_ratio;
        let message =
            format!("its content is more than {ratio} times as long as the file, which no sidecar is");
        return Err(Error::input(file, "gzip", message, REWRITE_HELP));
    }
    Ok(Cow::Owned(content))
}
