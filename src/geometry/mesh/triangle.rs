//! A single triangle: corners, area and normal.

use crate::math::Vec3;
use crate::mesh::PointIndex;

/// Returns the corners of a triangle [m]; `points` [m] has one entry per point.
#[inline]
pub fn corners(points: &[Vec3], triangle: &[PointIndex; 3]) -> [Vec3; 3] {
    triangle.map(|p| points[p.at()])
}

/// Returns the vector along the normal whose length is twice the area [m²].
#[inline]
pub fn area_vector([a, b, c]: &[Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// Returns the area [m²].
#[inline]
pub fn area(corners: &[Vec3; 3]) -> f64 {
    0.5 * area_vector(corners).norm()
}

/// Returns the length of the longest side [m].
pub fn longest_side([a, b, c]: &[Vec3; 3]) -> f64 {
    (a - b).norm().max((b - c).norm()).max((c - a).norm())
}

/// Returns the mean length of the sides [m].
pub fn mean_side([a, b, c]: &[Vec3; 3]) -> f64 {
    ((a - b).norm() + (b - c).norm() + (c - a).norm()) / 3.0
}

/// Returns the unit normal, on the side from which the corners run counter-clockwise; `None` for a triangle without area.
#[inline]
pub fn normal(corners: &[Vec3; 3]) -> Option<Vec3> {
    area_vector(corners).try_normalize(0.0)
}

/// Returns the quality of a triangle: 1 for equal sides, 0 for no area.
pub fn quality(x: &[Vec3; 3]) -> f64 {
    let [a, b, c] = [x[1] - x[0], x[2] - x[1], x[0] - x[2]];
    let sides = a.norm_squared() + b.norm_squared() + c.norm_squared();
    if sides > 0.0 { 2.0 * 3f64.sqrt() * a.cross(&b).norm() / sides } else { 0.0 }
}

/// Corner with the largest of the barycentric `weights`; of equal ones the first.
pub fn nearest_corner(weights: &[f64; 3]) -> usize {
    (0..3).fold(0, |best, k| if weights[k] > weights[best] { k } else { best })
}

/// Barycentric coordinates of the centroids of the n² equal triangles that a triangle is cut into.
pub fn sample_weights(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let at = move |i: u32, j: u32, shift: f64| {
        let (a, b) = ((f64::from(i) + shift) / f64::from(n), (f64::from(j) + shift) / f64::from(n));
        [1.0 - a - b, a, b]
    };
    let upright = move |i: u32| (0..n - i).map(move |j| at(i, j, 1.0 / 3.0));
    let inverted = move |i: u32| (0..n - i - 1).map(move |j| at(i, j, 2.0 / 3.0));
    (0..n).flat_map(move |i| upright(i).chain(inverted(i)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_triangle_has_its_area_and_normal() {
        let points = [Vec3::zeros(), Vec3::x() * 2.0, Vec3::y() * 3.0];
        let corners = corners(&points, &[0, 1, 2].map(PointIndex));
        assert_eq!(area(&corners), 3.0);
        assert_eq!(normal(&corners), Some(Vec3::z()));
        assert_eq!(normal(&[Vec3::x(); 3]), None);
    }
}
