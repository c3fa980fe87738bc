//! The interface through which elements add their blocks to a matrix.

use crate::vector::Mat3;

/// Receiver of the 3 x 3 blocks of a symmetric matrix.
pub trait BlockSink {
    /// Adds `block` at block row `i`, block column `j`. Callers pass blocks of the lower triangle only: `i >= j`.
    fn add(&mut self, i: u32, j: u32, block: &Mat3);
    /// Whether the sink stores any block between `points`; an element without one may be skipped.
    fn is_relevant(&self, _points: &[u32]) -> bool {
        true
    }
}

/// Adds the block of the pair (`i`, `j`) of a symmetric element matrix in the lower triangle.
#[inline]
pub fn add_symmetric(out: &mut dyn BlockSink, i: u32, j: u32, block: &Mat3) {
    if i >= j { out.add(i, j, block) } else { out.add(j, i, &block.transpose()) }
}
