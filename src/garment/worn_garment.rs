//! The result of a bake: the garment in its source pose, with its memory.

use crate::garment::RestState;
use crate::math::Vec3;

/// Garment after wear.
#[derive(Debug, Clone)]
pub struct WornGarment {
    /// One per point: displacement from the source pose \[m\], y up.
    pub displacement: Vec<Vec3>,
    /// Rest state that the wear left.
    pub memory: RestState,
}
