//! Errors in words a user can act on: the file, the location in it, the problem, and how to fix it.

use serde::{Deserialize, Serialize};

/// Result of every fallible call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// One problem of an input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Diagnostic {
    /// File (or other source) as the user named it.
    pub file: String,
    /// Location in the file: "line 12, column 4", "meshes[0].primitives[1]", ...; empty for the whole file.
    pub location: String,
    /// Description of the problem.
    pub message: String,
    /// Advice on how to fix it; empty when there is none.
    pub help: String,
    /// The line of a text file with a mark under the place, two lines; empty for other files. Not part of the text of the
    /// diagnostic: a tool may print it below.
    pub excerpt: String,
}

impl Diagnostic {
    /// Creates a diagnostic of `file` at `location`.
    pub fn new(
        file: impl Into<String>,
        location: impl Into<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            file: file.into(),
            location: location.into(),
            message: message.into(),
            help: help.into(),
            excerpt: String::new(),
        }
    }

    /// Adds the excerpt of the text that it is about.
    pub fn with_excerpt(self, excerpt: String) -> Self {
        Self { excerpt, ..self }
    }
}

impl std::fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}", self.file)?;
        if !self.location.is_empty() {
            write!(out, ": {}", self.location)?;
        }
        write!(out, ": {}", self.message)?;
        if !self.help.is_empty() {
            write!(out, " ({})", self.help)?;
        }
        Ok(())
    }
}

/// Failures of the library's calls.
///
/// ```
/// use crease_model::error::Error;
/// use crease_model::fabric::Fabric;
/// match Fabric::preset("demin") {
///     Err(Error::Input(problems)) => assert!(problems[0].help.contains("denim")),
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Invalid input, with every problem found in it. Exit code 1.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Input(Vec<Diagnostic>),
    /// Divergence of the solver; the caller keeps the last accepted state. Exit code 3.
    #[error("did not converge: {0}")]
    NotConverged(String),
    /// An action of the script that was carried out and did not do what it should: a flap that did not turn over, a garment that
    /// does not lie. Exit code 3.
    #[error("did not take place: {0}")]
    NotPerformed(Diagnostic),
    /// Result without any effect: nothing changed. Exit code 3.
    #[error("empty result: {0}")]
    Empty(String),
    /// Stop on request; the caller may have kept a checkpoint.
    #[error("interrupted")]
    Interrupted,
    /// Failure to read or write a file. Exit code 1.
    #[error("{file}: {source}")]
    File {
        /// File as the user named it.
        file: String,
        /// Error reported by the operating system.
        source: std::io::Error,
    },
}

impl Error {
    /// Creates [`Error::Input`] with a single diagnostic.
    pub fn input(
        file: impl Into<String>,
        location: impl Into<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self::Input(vec![Diagnostic::new(file, location, message, help)])
    }
}
