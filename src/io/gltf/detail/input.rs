//! Input of a detail map.

use crate::gltf::flat_shading::{FlatNormals, SmoothShape, flat_vertices};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::garment::Garment;
use crease_model::remesh::WornSurface;

/// Garment on the mesh of its file and what was worn.
#[derive(Debug, Clone, Copy)]
pub struct DetailInput<'a> {
    /// Garment on the mesh of the file.
    pub coarse: &'a Garment,
    /// Displacement of the points of `coarse` [m]; further entries are not read.
    pub displacement: &'a [Vec3],
    /// What was worn, on the surface of `coarse`.
    pub surface: &'a WornSurface,
    /// Treatment of flat-shaded vertices, that of the worn file.
    pub flat_normals: FlatNormals,
}

impl DetailInput<'_> {
    /// Unit normals before the wear that the wear turns into those shown after it, one per vertex of a piece with the normals `unworn`:
    /// those of the file, but smooth ones where the worn file has smooth ones in place of flat-shaded ones.
    pub(in crate::gltf) fn unworn_normals(
        &self,
        points: &[PointIndex],
        unworn: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Vec<Vec3> {
        if self.flat_normals != FlatNormals::Smoothed {
            return unworn.to_vec();
        }
        let Self { coarse, displacement, .. } = self;
        let smooth = SmoothShape::new(&coarse.points, &coarse.points, &coarse.triangles);
        let flat = flat_vertices(coarse, points, unworn, triangles);
        let normal = |(v, own): (usize, &Vec3)| {
            let p = points[v];
            let is_smoothed = flat[v] && displacement[p.at()] != Vec3::zeros();
            is_smoothed.then(|| smooth.normal(p, *own)).flatten().unwrap_or(*own)
        };
        unworn.iter().enumerate().map(normal).collect()
    }
}
