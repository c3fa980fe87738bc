//! A JSON value with the file it came from and the location of each part in it.

use crate::error::{Diagnostic, Error, Message, Result};
use crate::json::comments::blank_comments;
use crate::json::kind_of_mesh;
use crate::json::spans::{Path, Spans, error_position};
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
    /// The text with its comments.
    written: String,
}

/// Member of the whole value by which editors find the schema; allowed in every file.
const SCHEMA_KEY: &str = "$schema";

/// Cure of a mesh in the place of JSON.
const MESH_HELP: &str = "give the mesh as the garment, and a JSON file here";

impl Document {
    /// Parses `text` of `file` (a name for messages only). Fails on invalid syntax and on duplicate keys.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let written = text.strip_prefix('\u{feff}').unwrap_or(text);
        let text = &blank_comments(written);
        let mut value: Value = serde_json::from_str(text).map_err(|e| {
            if let Some(kind) = kind_of_mesh(written.as_bytes()) {
                return Error::input(file, "", format!("is {kind}, not JSON"), MESH_HELP);
            }
            let (line, column) = error_position(text, e.line(), e.column());
            let message = e.to_string();
            let message = message.split(" at line ").next().unwrap_or(&message).to_owned();
            let help = "correct the syntax there or just before it";
            let location = format!("line {line}, column {column}");
            let diagnostic = Diagnostic::new(file, location, format!("not valid JSON: {message}"), help);
            Error::Input(vec![diagnostic.with_excerpt(excerpt(written, line, column))])
        })?;
        if let Value::Object(members) = &mut value
            && members.get(SCHEMA_KEY).is_some_and(Value::is_string)
        {
            members.shift_remove(SCHEMA_KEY);
        }
        let spans = Spans::scan(text);
        let duplicates: Vec<Diagnostic> = spans
            .duplicate_keys()
            .take(MAX_DIAGNOSTICS)
            .map(|((line, column), name)| {
                let location = format!("line {line}, column {column}");
                Diagnostic::new(file, location, format!("{name} is given twice"), "keep one of them")
                    .with_excerpt(excerpt(written, line, column))
            })
            .collect();
        if !duplicates.is_empty() {
            return Err(Error::Input(duplicates));
        }
        Ok(Self { file: file.to_owned(), value, spans: Some(spans), written: written.to_owned() })
    }

    /// Wraps a value made by a program; diagnostics name only the path in it.
    pub fn from_value(file: &str, value: Value) -> Self {
        Self { file: file.to_owned(), value, spans: None, written: String::new() }
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
    pub fn diagnostic(
        &self,
        path: &Path,
        message: impl Into<String>,
        help: impl Into<Message>,
    ) -> Diagnostic {
        self.locate(path, false, message.into(), help.into())
    }

    /// Creates a diagnostic of the name of the member that `path` leads to.
    pub(super) fn diagnostic_of_name(&self, path: &Path, message: String, help: Message) -> Diagnostic {
        self.locate(path, true, message, help)
    }

    fn locate(&self, path: &Path, of_name: bool, message: String, help: Message) -> Diagnostic {
        let position = self.spans.as_ref().and_then(|spans| spans.find(path, of_name));
        let location = match (position, path.is_empty()) {
            (Some((line, column)), true) => format!("line {line}, column {column}"),
            (Some((line, column)), false) => format!("line {line}, column {column}, at {path}"),
            (None, true) => String::new(),
            (None, false) => path.to_string(),
        };
        let diagnostic = Diagnostic::new(&self.file, location, message, help);
        match position {
            Some((line, column)) => diagnostic.with_excerpt(excerpt(&self.written, line, column)),
            None => diagnostic,
        }
    }
}

/// Returns a line of `text` with a mark under a column, both counted from 1; of a long line the part around the column.
fn excerpt(text: &str, line: usize, column: usize) -> String {
    const BEFORE: usize = 50;
    const WIDTH: usize = 90;
    let whole = text.split('\n').nth(line.saturating_sub(1)).unwrap_or("").trim_end();
    let first = column.saturating_sub(1 + BEFORE);
    let shown: String =
        whole.chars().skip(first).take(WIDTH).map(|c| if c == '\t' { ' ' } else { c }).collect();
    format!("  {shown}\n  {}^", " ".repeat(column.saturating_sub(1 + first)))
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
