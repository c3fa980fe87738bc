//! A JSON value with the file it came from and the location of each part in it.

use crate::error::{Diagnostic, Error, Result};
use crate::json::spans::{Path, Spans, error_location};
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Diagnostics reported of one file; the rest are counted.
pub(super) const MAX_DIAGNOSTICS: usize = 50;

/// JSON value with the file it came from and the location of each part in it.
#[derive(Debug, Clone)]
pub struct Document {
    file: String,
    value: Value,
    /// Absent for a value made by a program.
    spans: Option<Spans>,
}

impl Document {
    /// Parses `text` of `file` (a name for messages only). Fails on invalid syntax and on duplicate keys.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = serde_json::from_str(text).map_err(|e| {
            let location = error_location(text, e.line(), e.column());
            let message = e.to_string();
            let message = message.split(" at line ").next().unwrap_or(&message).to_owned();
            let help = "correct the syntax there or just before it";
            Error::input(file, location, format!("not valid JSON: {message}"), help)
        })?;
        let spans = Spans::scan(text);
        let duplicates: Vec<Diagnostic> = spans
            .duplicate_keys()
            .take(MAX_DIAGNOSTICS)
            .map(|(location, name)| {
                Diagnostic::new(file, location, format!("{name} is given twice"), "keep one of them")
            })
            .collect();
        if !duplicates.is_empty() {
            return Err(Error::Input(duplicates));
        }
        Ok(Self { file: file.to_owned(), value, spans: Some(spans) })
    }

    /// Wraps a value made by a program; diagnostics name only the path in it.
    pub fn from_value(file: &str, value: Value) -> Self {
        Self { file: file.to_owned(), value, spans: None }
    }

    /// Returns the value.
    pub fn value(&self) -> &Value {
        &self.value
    }

    /// Adds the members of `base` that the document lacks, object by object; its own members stay.
    pub fn merge_defaults(&mut self, base: &Value) {
        add_missing(&mut self.value, base);
    }

    /// Sets the member at `path`, for values that a program derives from others; makes the objects that lead to it.
    pub fn set(&mut self, path: &[&str], value: Value) {
        let mut at = &mut self.value;
        for name in path {
            let Value::Object(members) = at else { return };
            at = members.entry(*name).or_insert_with(|| Value::Object(Default::default()));
        }
        *at = value;
    }

    /// Converts the value into a `T`. Meant for a document that passed [`Document::validate`]; errors of serde are located,
    /// too.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T> {
        serde_path_to_error::deserialize(&self.value).map_err(|e| {
            let path = Path::from_serde(e.path());
            Error::Input(vec![self.diagnostic(&path, e.inner().to_string(), "")])
        })
    }

    /// Creates a diagnostic at the value that `path` leads to.
    pub fn diagnostic(&self, path: &Path, message: impl Into<String>, help: impl Into<String>) -> Diagnostic {
        Diagnostic::new(&self.file, self.location(path, false), message, help)
    }

    /// Creates a diagnostic of the name of the member that `path` leads to.
    pub(super) fn diagnostic_of_name(&self, path: &Path, message: String, help: String) -> Diagnostic {
        Diagnostic::new(&self.file, self.location(path, true), message, help)
    }

    fn location(&self, path: &Path, of_name: bool) -> String {
        let position = self.spans.as_ref().and_then(|spans| spans.find(path, of_name));
        match (position, path.is_empty()) {
            (Some(position), true) => position,
            (Some(position), false) => format!("{position}, at {path}"),
            (None, true) => String::new(),
            (None, false) => path.to_string(),
        }
    }
}

fn add_missing(value: &mut Value, base: &Value) {
    if let (Value::Object(own), Value::Object(base)) = (value, base) {
        for (name, other) in base {
            match own.get_mut(name) {
                Some(mine) => add_missing(mine, other),
                None => {
                    own.insert(name.clone(), other.clone());
                }
            }
        }
    }
}
