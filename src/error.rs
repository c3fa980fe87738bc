//! What can go wrong, in words a user can act on: the file, the place in it, what is wrong, and the cure.

/// Result of every fallible call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// One fault of an input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The file (or other source) as the user named it.
    pub file: String,
    /// Where in it: "line 12, column 4", "meshes[0].primitives[1]", ...; empty when the whole file is meant.
    pub place: String,
    /// What is wrong there.
    pub what: String,
    /// What to do about it; empty when nothing can be done but to mend the file.
    pub cure: String,
}

impl Fault {
    /// A fault of `file` at `place`.
    pub fn new(
        file: impl Into<String>,
        place: impl Into<String>,
        what: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self { file: file.into(), place: place.into(), what: what.into(), cure: cure.into() }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}", self.file)?;
        if !self.place.is_empty() {
            write!(out, ": {}", self.place)?;
        }
        write!(out, ": {}", self.what)?;
        if !self.cure.is_empty() {
            write!(out, " ({})", self.cure)?;
        }
        Ok(())
    }
}

/// Everything a call of the library can fail with.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input is bad; every fault found in it. Exit code 1.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Input(Vec<Fault>),
    /// The solver gave up; what was reached is kept by the caller. Exit code 3.
    #[error("did not converge: {0}")]
    NotConverged(String),
    /// The run was asked to stop; a checkpoint may have been kept by the caller.
    #[error("interrupted")]
    Interrupted,
    /// A file could not be read or written. Exit code 1.
    #[error("{file}: {source}")]
    File {
        /// The file as the user named it.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Error {
    /// A single fault as an error.
    pub fn fault(
        file: impl Into<String>,
        place: impl Into<String>,
        what: impl Into<String>,
        cure: impl Into<String>,
    ) -> Self {
        Self::Input(vec![Fault::new(file, place, what, cure)])
    }
}
