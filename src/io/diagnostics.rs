//! Collects the faults of one file, so that a user can mend it in one round.

use crate::{Diagnostic, Error, Result};

/// Faults told in full; the rest is counted. A file with a wrong header easily has one fault per line.
const TOLD: usize = 20;

/// The faults found so far in one file.
#[derive(Debug)]
pub(super) struct DiagnosticList {
    file: String,
    told: Vec<Diagnostic>,
    untold: usize,
}

impl DiagnosticList {
    /// No faults yet in `file`.
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), told: Vec::new(), untold: 0 }
    }

    /// One more fault.
    pub(super) fn push(
        &mut self,
        place: impl Into<String>,
        what: impl Into<String>,
        cure: impl Into<String>,
    ) {
        if self.told.len() < TOLD {
            self.told.push(Diagnostic::new(self.file.clone(), place, what, cure));
        } else {
            self.untold += 1;
        }
    }

    /// The value of `result`, or its faults noted under this file's name.
    pub(super) fn take<T>(&mut self, result: Result<T>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(Error::Input(faults)) => {
                for fault in faults {
                    self.push(fault.location, fault.message, fault.help);
                }
                None
            }
            Err(other) => {
                self.push("", other.to_string(), "");
                None
            }
        }
    }

    /// Whether nothing is wrong so far.
    pub(super) fn is_empty(&self) -> bool {
        self.told.is_empty()
    }

    /// All faults as one error, or nothing.
    pub(super) fn finish(mut self) -> Result<()> {
        if self.told.is_empty() {
            return Ok(());
        }
        if self.untold > 0 {
            self.told.push(Diagnostic::new(self.file, "", format!("and {} more faults", self.untold), ""));
        }
        Err(Error::Input(self.told))
    }
}
