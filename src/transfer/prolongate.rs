//! Prolongation of the memory of a simulation mesh to the garment whose surface it lies on.
//!
//! Both meshes lie in one position, and for every point of the garment its triangle of the mesh is known. A point is matched
//! with the nearest triangle that is reached from those its corners lie in, from neighbour to neighbour, so that touching layers
//! are never confused.

use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::mesh::distance::point_triangle_squared;
use crate::remesh::SimulationMesh;
use crate::transfer::correspondence::{Correspondence, Match, Query, smallest_rotation};
use crate::transfer::memory_delta::MemoryDelta;
use crate::transfer::options::TransferOptions;
use crate::transfer::resample::resample;
use crate::transfer::scatter::scatter_curvature;
use crate::transfer::smoothing::smooth_curvature;
use crate::transfer::surface::GarmentSurface;

/// Memory of `garment`, one entry per hinge and triangle of it, from `memory` of `mesh`, which lies on its surface. A crease
/// narrower than the triangles of the garment is spread over one ring of them, so that it keeps its angle and its course.
pub fn prolongate(mesh: &SimulationMesh, memory: &RestState, garment: &Garment) -> RestState {
    if mesh.is_source {
        return memory.clone();
    }
    let target = GarmentSurface::without_texture(garment);
    let containing = mesh.containing_triangles();
    let locator = MeshLocator::new(&mesh.garment, &containing, &target);
    let mut faces = resample(&locator, memory, &target, 1.0);
    let curvature = scatter_curvature(&locator.source, memory, &target, &containing);
    faces.iter_mut().zip(curvature).for_each(|(face, curvature)| face.curvature = curvature);
    smooth_curvature(&target, &mut faces);
    let delta = MemoryDelta::from_faces(&target, &faces);
    delta.apply(&target, &TransferOptions::full(target.points.len()))
}

/// Correspondence of a garment with a mesh on its surface.
struct MeshLocator<'a> {
    source: GarmentSurface,
    target: &'a GarmentSurface,
    containing_triangle: &'a [u32],
    /// Per triangle of the mesh: itself and all that have a point in common with it, sorted.
    neighbourhood: Vec<Vec<u32>>,
    /// Per triangle of the mesh: outward unit normal.
    normals: Vec<Vec3>,
}

impl<'a> MeshLocator<'a> {
    fn new(mesh: &Garment, containing_triangle: &'a [u32], target: &'a GarmentSurface) -> Self {
        let source = GarmentSurface::without_texture(mesh);
        let mut on_point = vec![Vec::new(); source.points.len()];
        for (f, t) in source.triangles.iter().enumerate() {
            t.iter().for_each(|p| on_point[p.at()].push(f as u32));
        }
        let neighbourhood = source.triangles.iter().map(|t| {
            let mut near: Vec<u32> = t.iter().flat_map(|p| on_point[p.at()].iter().copied()).collect();
            near.sort_unstable();
            near.dedup();
            near
        });
        let outward = target.orientation_sign();
        let unit = |f: usize| outward * source.normal(f).try_normalize(0.0).unwrap_or_else(Vec3::z);
        Self {
            neighbourhood: neighbourhood.collect(),
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
        let distance = |g: u32| {
            let [a, b, c] = self.source.corners(g as usize);
            point_triangle_squared(&query.position, &a, &b, &c)
        };
        let nearest = |near: &mut dyn Iterator<Item = u32>| {
            near.map(|g| (distance(g), g)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
        };
        let containing = self.target.triangles[f].iter().map(|p| self.containing_triangle[p.at()]);
        let mut best = nearest(&mut containing.flat_map(|g| self.neighbourhood[g as usize].iter().copied()))?;
        // Between the corners of a large triangle lie others of the mesh: on from ring to ring, ever closer.
        while best.0 > 0.0 {
            match nearest(&mut self.neighbourhood[best.1 as usize].iter().copied()) {
                Some(next) if next.0 < best.0 => best = next,
                _ => break,
            }
        }
        let triangle = best.1 as usize;
        let map = smallest_rotation(&self.normals[triangle], &query.normal);
        Some(Match { triangle, quality: 1.0, map })
    }
}
