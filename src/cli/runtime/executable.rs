//! Path of this program, to start it again for a job of a batch.

use crease_model::error::{Error, Result};
use std::path::PathBuf;

/// Names the program where it does not run as its own executable, such as within Python.
const VARIABLE: &str = "CREASE_EXECUTABLE";

/// Returns the path of the program.
pub fn path() -> Result<PathBuf> {
    match std::env::var_os(VARIABLE) {
        Some(path) => Ok(path.into()),
        None => std::env::current_exe().map_err(|source| Error::File { file: "crease".to_owned(), source }),
    }
}
