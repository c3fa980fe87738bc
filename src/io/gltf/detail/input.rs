//! Input of a detail map.

use crate::gltf::flat_shading::FlatNormals;
use crease_model::garment::{Garment, WornGarment};

/// Garment on the mesh of its file and on the simulated mesh.
#[derive(Debug, Clone, Copy)]
pub struct DetailInput<'a> {
    /// Garment on the mesh of the file.
    pub coarse: &'a Garment,
    /// Garment on the simulated mesh; its first points are those of `coarse`.
    pub fine: &'a Garment,
    /// Per triangle of `fine`: the triangle of `coarse` it lies on.
    pub parent: &'a [u32],
    /// Wear of `fine`.
    pub worn: &'a WornGarment,
    /// Treatment of flat-shaded vertices, that of the worn file.
    pub flat_normals: FlatNormals,
}
