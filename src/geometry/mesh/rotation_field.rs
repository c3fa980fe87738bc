//! Rotation of a surface at its points between two of its shapes.

use crate::math::{Mat3, Vec3, nearest_rotation};
use crate::mesh::index::PointIndex;
use crate::mesh::triangle::corners;

/// Per point: the rotation of the triangles around it from the positions `from` to the positions `to`, weighted by area.
pub fn point_rotations(from: &[Vec3], triangles: &[[PointIndex; 3]], to: &[Vec3]) -> Vec<Mat3> {
    let mut sum = vec![Mat3::zeros(); from.len()];
    for t in triangles {
        let weighted = weighted_rotation(from, to, t);
        t.iter().for_each(|p| sum[p.at()] += weighted);
    }
    sum.into_iter().map(mean_rotation).collect()
}

/// Rotation of the triangle `t` from the positions `from` to the positions `to`, times its area before [m²].
pub fn weighted_rotation(from: &[Vec3], to: &[Vec3], t: &[PointIndex; 3]) -> Mat3 {
    let [(before, area), (after, _)] = [from, to].map(|x| frame(&corners(x, t)));
    after * before.transpose() * area
}

/// Rotation nearest to a weighted sum of rotations; none where they cancel.
pub fn mean_rotation(sum: Mat3) -> Mat3 {
    nearest_rotation(sum).map_or_else(Mat3::identity, |nearest| nearest.rotation)
}

/// The vector `offset` at a place of a triangle with these `corners` and `weights`, turned as the surface turns there.
pub fn turned(rotations: &[Mat3], corners: &[PointIndex; 3], weights: &[f64; 3], offset: &Vec3) -> Vec3 {
    let turned: Vec3 = (0..3).map(|k| rotations[corners[k].at()] * offset * weights[k]).sum();
    turned.try_normalize(0.0).map_or(turned, |direction| direction * offset.norm())
}

/// Orthonormal frame of a triangle in its columns (first side, in its plane across that, normal), and its area.
fn frame(x: &[Vec3; 3]) -> (Mat3, f64) {
    let along = x[1] - x[0];
    let normal = along.cross(&(x[2] - x[0]));
    match (along.try_normalize(0.0), normal.try_normalize(0.0)) {
        (Some(u), Some(n)) => (Mat3::from_columns(&[u, n.cross(&u), n]), 0.5 * normal.norm()),
        _ => (Mat3::identity(), 0.0),
    }
}
