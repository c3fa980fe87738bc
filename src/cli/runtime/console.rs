//! Words to people on stderr, data to programs on stdout. A reader who hangs up is no error of ours.

use crease::{Error, Result};
use std::io::{ErrorKind, Write};

/// A line for people. Nobody listening is fine.
pub fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// An error for people: one line per fault.
pub fn error(error: &Error) {
    match error {
        Error::Input(faults) => faults.iter().for_each(|fault| say(&format!("error: {fault}"))),
        other => say(&format!("error: {other}")),
    }
}

/// Data for programs, as it is.
pub fn data(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::File { file: "standard output".to_owned(), source })
        }
        _ => Ok(()),
    }
}
