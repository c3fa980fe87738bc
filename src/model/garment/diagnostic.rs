//! Diagnostics of the importer, for `inspect` and for the report.

use serde::Serialize;

/// Severity of an import diagnostic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Doubtful, or left as it is: told in the report.
    Warning,
    /// Was, or would be, repaired on import.
    Repaired,
    /// Makes the garment unusable: it is refused.
    Refused,
}

/// Property of an imported mesh that the user should know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ImportDiagnostic {
    /// Severity.
    pub severity: Severity,
    /// Location in the file (line, element); empty for the whole file.
    pub location: String,
    /// Description, with advice where there is any.
    pub message: String,
}

/// Diagnostics in the order they come up.
#[derive(Debug, Default)]
pub(super) struct ImportDiagnostics {
    pub(super) list: Vec<ImportDiagnostic>,
}

impl ImportDiagnostics {
    /// Adds a note.
    pub(super) fn note(&mut self, message: impl Into<String>) {
        self.push(Severity::Note, message.into());
    }

    /// Adds a repair of `count` things; none if `count` is 0.
    pub(super) fn repaired(&mut self, count: usize, message: &str) {
        if count > 0 {
            self.push(Severity::Repaired, format!("{count} {message}"));
        }
    }

    fn push(&mut self, severity: Severity, message: String) {
        self.list.push(ImportDiagnostic { severity, location: String::new(), message });
    }
}
