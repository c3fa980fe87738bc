//! Indices. Two kinds must never be mixed: points of the simulation (welded) and vertices of the file (split at seams, texture
//! borders and normals).

use serde::{Deserialize, Serialize};

/// Index of nothing: marks absent triangles, edges and points in tables of indices.
pub const INVALID: u32 = u32::MAX;

/// Index of a welded point of the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PointIndex(pub u32);

/// Index of a vertex of the source file, counted over all worn pieces in file order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct VertexIndex(pub u32);

impl PointIndex {
    /// Returns the position in a slice with one entry per point.
    #[inline]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

impl VertexIndex {
    /// Returns the position in a slice with one entry per vertex.
    #[inline]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}
