//! Diagnostics of a stage, each kind once with the number of prims it is about.

use crease_model::garment::{ImportDiagnostic, Severity};

/// Notes in the order of their first prim.
#[derive(Debug, Default)]
pub(super) struct Notes {
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    severity: Severity,
    message: String,
    /// Path of the first prim.
    path: String,
    /// Number of prims; 0 for a message that counts none.
    count: usize,
}

impl Notes {
    /// Adds one prim to the note `message`, which continues the sentence "3 ...".
    pub(super) fn count(&mut self, severity: Severity, path: &str, message: impl Into<String>) {
        let message = message.into();
        match self.entries.iter_mut().find(|entry| entry.count > 0 && entry.message == message) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { severity, message, path: path.to_owned(), count: 1 }),
        }
    }

    /// Adds a note of its own, once.
    pub(super) fn add(&mut self, severity: Severity, path: &str, message: impl Into<String>) {
        let message = message.into();
        if !self
            .entries
            .iter()
            .any(|entry| entry.count == 0 && entry.message == message && entry.path == path)
        {
            self.entries.push(Entry { severity, message, path: path.to_owned(), count: 0 });
        }
    }

    /// Returns the first message that begins with `subject`.
    pub(super) fn message_about(&self, subject: &str) -> Option<&str> {
        let mut messages = self.entries.iter().map(|entry| entry.message.as_str());
        messages.find(|message| message.strip_prefix(subject).is_some_and(|rest| rest.starts_with(' ')))
    }

    pub(super) fn into_diagnostics(self) -> Vec<ImportDiagnostic> {
        let diagnostic = |entry: Entry| ImportDiagnostic {
            severity: entry.severity,
            message: match entry.count {
                0 => entry.message.into(),
                count => format!("{count} {}", entry.message).into(),
            },
            location: entry.path,
        };
        self.entries.into_iter().map(diagnostic).collect()
    }
}
