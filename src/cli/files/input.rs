//! Whole input files, with error messages a user can act on.

use crease_model::error::{Error, Result};
use std::path::Path;

pub use crease::internal::files::{
    STANDARD_STREAM, file_name as name_of, read_bytes as bytes, read_fabric as fabric, read_text as text,
};

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
