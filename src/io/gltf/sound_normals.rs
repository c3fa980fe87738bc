//! Normals of a file that are no unit vectors: readers and validators refuse them, and the worn target is added to them.
//!
//! Exporters write zeros for vertices of no triangle and of triangles without area, and lengths other than one. They get a
//! length of one, or the direction of the triangles around, or any.

use crate::gltf::worn_target::LinearParts;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle;
use crease_model::garment::SourcePiece;

/// Difference of the length of a normal from one up to which it is kept \[-\]: that of the validator of glTF.
const LENGTH_TOL: f64 = 0.006;
/// Length below which a normal has no direction \[-\].
const MIN_LENGTH: f64 = 1e-6;

/// Replaces the `normals` of `piece`, one per vertex in own coordinates, that are no unit vectors; `linear` are the linear
/// parts of its placement. Returns whether there were any.
pub(super) fn mend_normals(piece: &SourcePiece, linear: &LinearParts, normals: &mut [Vec3]) -> bool {
    let is_sound = |n: &Vec3| (n.norm() - 1.0).abs() <= LENGTH_TOL;
    if normals.iter().all(is_sound) {
        return false;
    }
    let mut around = vec![Vec3::zeros(); normals.len()];
    for t in &piece.triangles {
        let corners = t.map(|v| v as usize);
        let area = triangle::area_vector(&corners.map(|v| piece.positions[v]));
        for v in corners {
            // The triangles are counter-clockwise in the scene.
            around[v] += area * linear.at(v).forward.determinant().signum();
        }
    }
    for (normal, around) in normals.iter_mut().zip(&around).filter(|(n, _)| !is_sound(n)) {
        let by_triangles = || around.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::y);
        *normal = normal.try_normalize(MIN_LENGTH).unwrap_or_else(by_triangles);
    }
    true
}
