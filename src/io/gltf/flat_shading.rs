//! Smooth normals for flat-shaded vertices.
//!
//! A flat-shaded file gives every vertex the normal of its triangle. Rotated with the wear, such normals keep every facet,
//! and wrinkles look like folded paper. A flat-shaded vertex therefore gets the area-weighted normal of the worn triangles
//! around its point, of those that lay within [`MAX_SMOOTH_DEG`] of its own before the wear: edges that were hard stay hard.
//! A vertex whose normal differs from that of a triangle of its own is smooth-shaded and not treated here.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, triangle};
use crease_model::garment::Garment;

/// Angle between two triangles before the wear up to which their normals are common \[degrees\].
const MAX_SMOOTH_DEG: f64 = 45.0;
/// Angle between the normals of a vertex and of its triangles up to which it is flat-shaded \[degrees\].
const FLAT_TOL_DEG: f64 = 0.5;

/// Treatment of flat-shaded vertices in the worn shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FlatNormals {
    /// They get smooth normals where the garment moved.
    #[default]
    Smoothed,
    /// They keep the normals of the file, rotated with the wear.
    Kept,
}

/// Triangles around every point, before and after the wear.
pub(super) struct SmoothShape {
    /// Per triangle: unit normal before the wear, zero without area.
    before: Vec<Vec3>,
    /// Per triangle: area vector after the wear.
    after: Vec<Vec3>,
    /// Per point: start of its entries in `around`.
    first: Vec<usize>,
    /// Triangles of all points.
    around: Vec<u32>,
}

impl SmoothShape {
    /// Collects the triangles of `garment`, whose points move to `after`.
    pub(super) fn new(points: &[Vec3], after: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        let area = |x: &[Vec3], t: &[PointIndex; 3]| triangle::area_vector(&t.map(|p| x[p.at()]));
        let mut first = vec![0; points.len() + 1];
        triangles.iter().flatten().for_each(|p| first[p.at() + 1] += 1);
        for p in 0..points.len() {
            first[p + 1] += first[p];
        }
        let mut next = first.clone();
        let mut around = vec![0; 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for p in corners {
                around[next[p.at()]] = t as u32;
                next[p.at()] += 1;
            }
        }
        Self {
            before: triangles.iter().map(|t| unit_or_zero(area(points, t))).collect(),
            after: triangles.iter().map(|t| area(after, t)).collect(),
            first,
            around,
        }
    }

    /// Returns the smooth normal after the wear at point `p` for a surface whose unit normal there was `before`.
    pub(super) fn normal(&self, p: PointIndex, before: Vec3) -> Option<Vec3> {
        let limit = MAX_SMOOTH_DEG.to_radians().cos();
        let around = self.around[self.first[p.at()]..self.first[p.at() + 1]].iter().map(|&t| t as usize);
        let sum: Vec3 = around.filter(|&t| self.before[t].dot(&before) > limit).map(|t| self.after[t]).sum();
        sum.try_normalize(f64::MIN_POSITIVE)
    }
}

/// Returns per vertex whether it is flat-shaded: every triangle of the piece at it has its normal. `normals` are unit normals
/// in the scene, `points` the points of the vertices.
pub(super) fn flat_vertices(
    garment: &Garment,
    points: &[PointIndex],
    normals: &[Vec3],
    triangles: &[[u32; 3]],
) -> Vec<bool> {
    let limit = FLAT_TOL_DEG.to_radians().cos();
    let mut flat = vec![true; normals.len()];
    for t in triangles.iter().map(|t| t.map(|v| v as usize)) {
        let corners = t.map(|v| garment.points[points[v].at()]);
        let Some(own) = triangle::area_vector(&corners).try_normalize(f64::MIN_POSITIVE) else { continue };
        t.iter().for_each(|&v| flat[v] &= normals[v].dot(&own) > limit);
    }
    flat
}

fn unit_or_zero(v: Vec3) -> Vec3 {
    v.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::zeros)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares of two triangles each with a common edge (points 1 and 2), the second at `degrees` to the first.
    fn hinge(degrees: f64) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let (s, c) = degrees.to_radians().sin_cos();
        let points = vec![
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(1.0 + c, 0.0, s),
            Vec3::new(1.0 + c, 1.0, s),
        ];
        let triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]].map(|t: [u32; 3]| t.map(PointIndex));
        (points, triangles.to_vec())
    }

    #[test]
    fn normals_are_smooth_across_flat_edges_and_hard_across_sharp_ones() {
        let (flat, triangles) = hinge(0.0);
        let (bent, _) = hinge(60.0);
        let smooth = SmoothShape::new(&flat, &bent, &triangles).normal(PointIndex(1), Vec3::z()).unwrap();
        // Half way between the two squares, weighted by one triangle of the first and two of the second.
        let first = Vec3::z();
        let second = Vec3::new(-60f64.to_radians().sin(), 0.0, 60f64.to_radians().cos());
        assert!((smooth - (first + 2.0 * second).normalize()).norm() < 1e-12, "{smooth}");

        let hard = SmoothShape::new(&bent, &bent, &triangles).normal(PointIndex(1), Vec3::z()).unwrap();
        assert!((hard - first).norm() < 1e-12, "{hard}");
    }
}
