//! Edges in the order in which a mesh is refined.

use std::cmp::Ordering;

/// Edge to be halved, ordered by length, then by its ends, lowest first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongEdge<P> {
    /// Length [m].
    pub length: f64,
    /// Ends in increasing order.
    pub ends: [P; 2],
}

impl<P: Ord> Eq for LongEdge<P> {}

impl<P: Ord> PartialOrd for LongEdge<P> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<P: Ord> Ord for LongEdge<P> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.length.total_cmp(&other.length).then(other.ends.cmp(&self.ends))
    }
}
