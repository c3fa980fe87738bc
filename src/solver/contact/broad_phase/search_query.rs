//! A query for primitive pairs that may come near during a motion.

use crate::contact::broad_phase::primitive_pair::PrimitivePair;
use crease_geometry::math::Vec3;

/// Relative widening of a search distance, so that rounding in boxes and distances never loses a pair.
pub(super) const ROUNDING: f64 = 1e-9;

/// A motion of the mesh and the distance within which pairs are found.
#[derive(Clone, Copy)]
pub struct SearchQuery<'a> {
    /// Positions at the start \[m\], one per point.
    pub start: &'a [Vec3],
    /// Positions at the end \[m\], one per point; the start for a mesh at rest. Every point moves in a straight line.
    pub end: &'a [Vec3],
    /// Distance within which a pair is found \[m\].
    pub distance: f64,
    /// Whether all points move by the same fraction of their displacement; otherwise each may move by any fraction of its own.
    pub uniform_step: bool,
    /// Pairs to leave out. Only near pairs are asked about, in no order, from several threads.
    pub skip: &'a (dyn Fn(PrimitivePair) -> bool + Sync),
}

impl SearchQuery<'_> {
    /// Whether nothing moves.
    pub fn is_at_rest(&self) -> bool {
        self.start == self.end
    }

    /// Returns the query with its distance widened by rounding.
    pub(super) fn widened(self) -> Self {
        Self { distance: self.distance * (1.0 + ROUNDING), ..self }
    }
}
