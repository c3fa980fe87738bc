//! Search for places of the source surface on a simulation mesh.

use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::remesh::simulation_mesh::{SimulationMesh, walk};
use crate::remesh::surface_mesh::interpolate;

/// A simulation mesh, ready to be searched.
pub struct SurfaceFinder<'a> {
    mesh: &'a SimulationMesh,
    /// Triangles at every point of the mesh.
    around: Vec<Vec<u32>>,
}

impl<'a> SurfaceFinder<'a> {
    /// A search of `mesh`.
    pub fn new(mesh: &'a SimulationMesh) -> Self {
        let mut around = vec![Vec::new(); mesh.garment.points.len()];
        for (f, t) in mesh.garment.triangles.iter().enumerate() {
            t.iter().for_each(|p| around[p.at()].push(f as u32));
        }
        Self { mesh, around }
    }

    /// Position [m] of the place `source` of the source surface [m], when the points of the mesh are at `x` [m]; it is found along the
    /// surface from `start`, a point of the source near it.
    pub fn position(&self, start: PointIndex, source: &Vec3, x: &[Vec3]) -> Vec3 {
        let from = self.mesh.source_location[start.at()].face;
        let at = walk(&self.mesh.garment, &self.around, from, source);
        interpolate(x, &self.mesh.garment.triangles, &at)
    }
}
