//! Search for places of the source surface on a simulation mesh.

use crate::garment::Garment;
use crate::remesh::surface_mesh::{SurfacePoint, clamped_weights};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::SurfaceWalk;
use crease_geometry::mesh::triangle::corners;

/// A simulation mesh, ready to be searched.
pub struct SurfaceFinder<'a> {
    mesh: &'a Garment,
    walk: SurfaceWalk,
}

impl<'a> SurfaceFinder<'a> {
    /// A search of `mesh`, a simulation mesh as a garment.
    pub fn new(mesh: &'a Garment) -> Self {
        Self { walk: SurfaceWalk::new(mesh.points.len(), &mesh.triangles), mesh }
    }

    /// The place of the mesh closest to the place `source` of the source surface [m], found along the surface from triangle `start`
    /// of the mesh.
    pub fn locate(&self, start: u32, source: &Vec3) -> SurfacePoint {
        let Garment { points, triangles, .. } = self.mesh;
        let face = self.walk.closest(points, triangles, start, source);
        SurfacePoint { face, weights: clamped_weights(source, &corners(points, &triangles[face as usize])) }
    }
}
