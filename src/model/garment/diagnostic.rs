//! Diagnostics of the importer, for `inspect` and for the report.

use crate::error::{Message, Vocabulary};
use serde::{Serialize, Serializer};

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
    #[serde(serialize_with = "as_text")]
    pub message: Message,
}

fn as_text<S: Serializer>(message: &Message, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(message)
}

impl ImportDiagnostic {
    /// Returns it with its message in the words of `words`, for a front end that prints it.
    pub fn worded(self, words: &dyn Vocabulary) -> Self {
        Self { message: self.message.worded(words).into(), ..self }
    }
}

/// Diagnostics in the order they come up.
#[derive(Debug, Default)]
pub(super) struct ImportDiagnostics {
    pub(super) list: Vec<ImportDiagnostic>,
}

impl ImportDiagnostics {
    /// Adds a note.
    pub(super) fn note(&mut self, message: impl Into<Message>) {
        self.push(Severity::Note, message.into());
    }

    /// Adds a repair of `count` things; none if `count` is 0.
    pub(super) fn repaired(&mut self, count: usize, message: impl Into<Message>) {
        if count > 0 {
            self.push(Severity::Repaired, Message::from(format!("{count} ")) + message);
        }
    }

    fn push(&mut self, severity: Severity, message: Message) {
        self.list.push(ImportDiagnostic { severity, location: String::new(), message });
    }
}
