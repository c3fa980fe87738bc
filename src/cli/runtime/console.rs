//! Output of the process: messages for people on stderr, data for programs on stdout. A closed pipe is not an error.

use crate::runtime::wording::ToolWords;
use crease_model::error::{Error, Result};
use crease_model::printable::printable;
use std::io::{ErrorKind, Write};

/// Prints one line on stderr; what would break it, or be a command to the terminal, is escaped. Failures are ignored.
pub fn message(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(line));
}

/// Prints an error on stderr, one line per diagnostic, and the place in a text file below it.
pub fn error(error: &Error) {
    match error {
        Error::Input(diagnostics) => {
            for diagnostic in diagnostics {
                message(&format!("error: {}", diagnostic.to_message().worded(&ToolWords)));
                if !diagnostic.excerpt.is_empty() {
                    diagnostic.excerpt.lines().for_each(message);
                }
            }
        }
        other => message(&format!("error: {}", other.worded(&ToolWords))),
    }
}

/// Prints `bytes` unchanged on stdout. Fails if they cannot be written, except when the pipe has been closed.
pub fn data(bytes: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes.as_ref()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::File { file: "standard output".to_owned(), source })
        }
        _ => Ok(()),
    }
}
