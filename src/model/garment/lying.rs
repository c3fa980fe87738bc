//! Decides whether a garment lies on the ground or stands upright.
//!
//! Files do not say how a garment is posed, so its proportions or its normals decide.

use crate::garment::tuning::TUNING;
use crease_geometry::math::Vec3;

/// Largest extent along `axis` of a garment that is flat across it \[m\], where its bounding box has the sides `size` \[m\].
pub fn max_flat_extent(size: &Vec3, axis: usize) -> f64 {
    TUNING.max_flat_ratio * size[(axis + 1) % 3].min(size[(axis + 2) % 3])
}

/// Whether a garment is flat across `axis`, where its bounding box has the sides `size` \[m\]: across y it lies.
pub fn is_flat_across(size: &Vec3, axis: usize) -> bool {
    size[axis] < max_flat_extent(size, axis)
}

/// Returns whether a garment lies by its triangles: the area-weighted mean of |unit normal . y| is above `min_mean`.
/// `normals` have the length of the area (or any multiple of it, the same for all).
pub fn is_lying_by_normals(normals: impl IntoIterator<Item = Vec3>, min_mean: f64) -> bool {
    let (mut vertical, mut area) = (0.0, 0.0);
    for normal in normals {
        vertical += normal.y.abs();
        area += normal.norm();
    }
    vertical > min_mean * area
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_is_compared_with_the_shorter_other_side() {
        assert!(is_flat_across(&Vec3::new(1.0, 0.09, 0.4), 1));
        assert!(!is_flat_across(&Vec3::new(1.0, 0.2, 0.4), 1));
        assert!(is_flat_across(&Vec3::new(0.5, 1.0, 0.12), 2));
        assert!(is_lying_by_normals([Vec3::y() * -2.0, Vec3::x()], 0.6));
        assert!(!is_lying_by_normals([Vec3::y(), Vec3::x()], 0.6));
    }
}
