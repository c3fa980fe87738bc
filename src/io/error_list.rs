//! Collector of the errors of one file, so that a user can correct all of them in one pass.

use crate::tuning::TUNING;
use crease_model::error::{Diagnostic, Error, Message, Result};

/// Errors found so far in one file.
#[derive(Debug)]
pub(super) struct ErrorList {
    file: String,
    listed: Vec<Diagnostic>,
    omitted: usize,
}

impl ErrorList {
    /// Creates an empty list for `file`.
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), listed: Vec::new(), omitted: 0 }
    }

    /// Adds an error.
    pub(super) fn push(
        &mut self,
        location: impl Into<String>,
        message: impl Into<Message>,
        help: impl Into<Message>,
    ) {
        if self.listed.len() < TUNING.max_listed_errors {
            self.listed.push(Diagnostic::new(self.file.clone(), location, message, help));
        } else {
            self.omitted += 1;
        }
    }

    /// Returns the value of `result`, or adds its errors under this file's name.
    pub(super) fn take<T>(&mut self, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(Error::Input(errors)) => {
                for error in errors {
                    self.push(error.location, error.message, error.help);
                }
                None
            }
            Err(other) => {
                self.push("", other.to_string(), "");
                None
            }
        }
    }

    /// Returns whether there are no errors so far.
    pub(super) fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Fails with all errors, if there are any.
    pub(super) fn finish(mut self) -> Result<()> {
        if self.listed.is_empty() {
            return Ok(());
        }
        if self.omitted > 0 {
            self.listed.push(Diagnostic::new(self.file, "", format!("and {} more errors", self.omitted), ""));
        }
        Err(Error::Input(self.listed))
    }
}
