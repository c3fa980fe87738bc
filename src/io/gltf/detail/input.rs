//! Input of a detail map.

use crate::gltf::flat_shading::FlatNormals;
use crease_geometry::math::Vec3;
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
