//! Prolongation of the memory of a simulation mesh to the garment whose surface it lies on, and restriction of the garment's
//! memory to that mesh.
//!
//! Both meshes lie in one position, and for every point of the one its triangle of the other is known. A point is matched
//! with the nearest triangle that is reached from those its corners lie in, from neighbour to neighbour, so that touching layers
//! are never confused.

use crate::garment::{Garment, RestState};
use crate::remesh::SimulationMesh;
use crate::remesh::carry::correspondence::{Correspondence, Match, Query, smallest_rotation};
use crate::remesh::carry::memory_delta::{DeltaScale, MemoryDelta};
use crate::remesh::carry::resample::resample;
use crate::remesh::carry::scatter::scatter_curvature;
use crate::remesh::carry::smoothing::smooth_curvature;
use crate::remesh::carry::surface::GarmentSurface;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::SurfaceWalk;

/// Memory of `garment`, one entry per hinge and triangle of it, from `memory` of `mesh`, which lies on its surface. A crease
/// narrower than the triangles of the garment is spread over one ring of them, so that it keeps its angle and its course.
pub fn prolongate(mesh: &SimulationMesh, memory: &RestState, garment: &Garment) -> RestState {
    if mesh.is_source {
        return memory.clone();
    }
    on_one_surface(&mesh.garment, memory, garment, &mesh.containing_triangles())
}

/// Memory of `mesh`, one entry per hinge and triangle of it, from `memory` of `garment`, on whose surface it lies.
pub fn restrict(garment: &Garment, memory: &RestState, mesh: &SimulationMesh) -> RestState {
    if mesh.is_source {
        return memory.clone();
    }
    on_one_surface(garment, memory, &mesh.garment, &mesh.source_triangle)
}

/// Memory of `to` from `memory` of `from`, which lies on the same surface; `containing` has the triangle of `from` that every point
/// of `to` lies in or beside.
fn on_one_surface(from: &Garment, memory: &RestState, to: &Garment, containing: &[u32]) -> RestState {
    let target = GarmentSurface::without_texture(to);
    let locator = MeshLocator::new(from, containing, &target);
    let mut faces = resample(&locator, memory, &target, 1.0);
    let curvature = scatter_curvature(&locator.source, memory, &target, containing);
    faces.iter_mut().zip(curvature).for_each(|(face, curvature)| face.curvature = curvature);
    smooth_curvature(&target, &mut faces);
    let delta = MemoryDelta::from_faces(&target, &faces);
    delta.apply(&target, &DeltaScale::FULL)
}

/// Correspondence of a garment with a mesh on its surface.
struct MeshLocator<'a> {
    source: GarmentSurface,
    target: &'a GarmentSurface,
    containing_triangle: &'a [u32],
    walk: SurfaceWalk,
    /// Per triangle of the mesh: outward unit normal.
    normals: Vec<Vec3>,
}

impl<'a> MeshLocator<'a> {
    fn new(mesh: &Garment, containing_triangle: &'a [u32], target: &'a GarmentSurface) -> Self {
        let source = GarmentSurface::without_texture(mesh);
        let outward = target.orientation_sign();
        let unit = |f: usize| outward * source.normal(f).try_normalize(0.0).unwrap_or_else(Vec3::z);
        Self {
            walk: SurfaceWalk::new(source.points.len(), &source.triangles),
            normals: (0..source.triangles.len()).map(unit).collect(),
            source,
            target,
            containing_triangle,
        }
    }
}

impl Correspondence for MeshLocator<'_> {
    fn source(&self) -> &GarmentSurface {
        &self.source
    }

    fn find(&self, f: usize, query: &Query) -> Option<Match> {
        let containing = self.target.triangles[f].map(|p| self.containing_triangle[p.at()]);
        let (points, triangles) = (&self.source.points, &self.source.triangles);
        let (_, start) = self.walk.nearest_around(points, triangles, &containing, &query.position)?;
        // Between the corners of a large triangle lie others of the mesh.
        let triangle = self.walk.closest(points, triangles, start, &query.position) as usize;
        let map = smallest_rotation(&self.normals[triangle], &query.normal);
        Some(Match { triangle, position: query.position, quality: 1.0, map })
    }
}
