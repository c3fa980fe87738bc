//! Two kinds of index that must never be mixed: points of the simulation (welded) and vertices of the file
//! (split at seams, texture borders and normals).

use serde::{Deserialize, Serialize};

/// A welded point of the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PointIndex(pub u32);

/// A vertex of the source file, counted over all worn pieces in file order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct VertexIndex(pub u32);

impl PointIndex {
    /// As a position in a slice with one entry per point.
    #[inline]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

impl VertexIndex {
    /// As a position in a slice with one entry per vertex.
    #[inline]
    pub fn at(self) -> usize {
        self.0 as usize
    }
}
