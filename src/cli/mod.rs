//! One file per command: arguments -> options -> library call -> files.

use std::process::ExitCode;

/// Reads the command line, runs the command, and maps its outcome to an exit code.
pub fn run() -> ExitCode {
    ExitCode::SUCCESS
}
