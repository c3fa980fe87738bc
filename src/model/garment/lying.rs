//! Decides whether a garment lies on the ground or stands upright.
//!
//! Files do not say how a garment is posed, so its proportions or its normals decide. Callers keep their own thresholds.

use crease_geometry::math::Vec3;

/// Horizontal side of a bounding box that its height is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Footprint {
    /// The shorter of the x and z sides.
    Shorter,
    /// The longer of the x and z sides.
    Longer,
}

/// Returns whether a garment lies: its height (y) is below `max_height_fraction` of a horizontal side of its bounding
/// box, whose sides are `size` \[m\].
pub fn is_lying(size: &Vec3, footprint: Footprint, max_height_fraction: f64) -> bool {
    let side = match footprint {
        Footprint::Shorter => size.x.min(size.z),
        Footprint::Longer => size.x.max(size.z),
    };
    size.y < max_height_fraction * side
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
    fn height_is_compared_with_the_chosen_side() {
        let size = Vec3::new(1.0, 0.2, 0.4);
        assert!(is_lying(&size, Footprint::Longer, 0.25));
        assert!(!is_lying(&size, Footprint::Shorter, 0.25));
        assert!(is_lying_by_normals([Vec3::y() * -2.0, Vec3::x()], 0.6));
        assert!(!is_lying_by_normals([Vec3::y(), Vec3::x()], 0.6));
    }
}
