//! Output files, written whole or not at all.

use crate::runtime::console;
use crease_model::error::Result;

pub use crease::internal::files::{Outputs, is_stream};

/// Writes all `outputs` and prints what goes to the standard output.
pub fn commit(outputs: Outputs) -> Result<()> {
    let stream = outputs.commit()?;
    if stream.is_empty() { Ok(()) } else { console::data(&stream) }
}
