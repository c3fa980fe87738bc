//! The result: the garment back in its own pose, with its memory.

use crate::garment::RestState;
use crate::math::Vec3;

/// A garment after wear.
#[derive(Debug, Clone)]
pub struct WornGarment {
    /// One per point: displacement from the source pose [m], y up.
    pub displacement: Vec<Vec3>,
    /// Its memory.
    pub memory: RestState,
}
