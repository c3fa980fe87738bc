//! Reports of the finer mesh, and of the files of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The garment with vertices added along creases and in wrinkles.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FineReport {
    /// File.
    pub file: String,
    /// Vertices of the garment in it; the first ones are those of the input.
    pub vertices: usize,
    /// Triangles of the garment in it.
    pub triangles: usize,
    /// Pairs of triangles that intersect and whose triangles of the input do not.
    pub crossings: usize,
}

/// A file of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct WrittenFile {
    /// Name.
    pub file: String,
    /// Size [bytes].
    pub bytes: u64,
}
