//! Edges that a mesh of the same surface keeps: sharp ones and seams.

use crate::garment::Garment;
use crate::garment::tuning::TUNING;
use crease_geometry::mesh::{Hinge, PointIndex, hinge_angle};

/// Whether the source shape has a sharp edge at a hinge, or the warp turns there.
pub fn is_feature_hinge(source: &Garment, hinge: &Hinge) -> bool {
    let x = hinge.points.map(|p| source.points[p.at()]);
    let direction = |f: u32| {
        let at = |p: PointIndex| source.triangles[f as usize].iter().position(|&q| q == p).unwrap_or(0);
        let flat = source.material[f as usize];
        let edge = flat[at(hinge.points[1])] - flat[at(hinge.points[0])];
        edge.y.atan2(edge.x)
    };
    let between = direction(hinge.triangles[0]) - direction(hinge.triangles[1]);
    // Cloth is the same along +warp and -warp.
    let is_seam = between.sin().abs() > TUNING.min_seam_angle.sin();
    is_seam || hinge_angle(&x).abs() > TUNING.min_sharp_angle
}
