//! Prolongation of the memory of a coarse mesh to the garment it was made from.
//!
//! Both meshes lie in one position, and for every point of the garment its coarse triangle is known. A point is matched
//! with the nearest of the triangles around those its corners lie in, so that touching layers are never confused. Hinges
//! between triangles of both meshes are copied; the others are resampled as between any two meshes.

use crate::garment::{CoarseMesh, Garment, RestState};
use crate::math::Vec3;
use crate::mesh::distance::point_triangle_squared;
use crate::remesh::AlignedMesh;
use crate::transfer::correspondence::{Correspondence, Match, Query, smallest_rotation};
use crate::transfer::memory_delta::MemoryDelta;
use crate::transfer::options::TransferOptions;
use crate::transfer::resample::resample;
use crate::transfer::smoothing::smooth_curvature;
use crate::transfer::surface::GarmentSurface;
use rustc_hash::FxHashMap;

/// Memory of `garment`, one entry per hinge and triangle of it, from `memory` of `coarse`, which was made from it.
pub fn prolongate(coarse: &CoarseMesh, memory: &RestState, garment: &Garment) -> RestState {
    let target = GarmentSurface::without_texture(garment);
    let locator = CoarseMeshLocator::new(&coarse.garment, &coarse.containing_triangle, &target);
    let faces = resample(&locator, memory, &target, 1.0);
    let mut delta = MemoryDelta::from_faces(&target, &faces);
    copy_shared(&mut delta, &MemoryDelta::from_memory(memory), coarse, garment);
    delta.apply(&target, &TransferOptions::full(target.points.len()))
}

/// Memory of `garment`, one entry per hinge and triangle of it, from `memory` of `aligned`, a mesh of its surface. A crease
/// narrower than the triangles of the garment is spread over one ring of them, so that it keeps its angle and its course.
pub fn prolongate_aligned(aligned: &AlignedMesh, memory: &RestState, garment: &Garment) -> RestState {
    let target = GarmentSurface::without_texture(garment);
    let containing = aligned.containing_triangles();
    let locator = CoarseMeshLocator::new(&aligned.garment, &containing, &target);
    let mut faces = resample(&locator, memory, &target, 1.0);
    smooth_curvature(&target, &mut faces);
    let delta = MemoryDelta::from_faces(&target, &faces);
    delta.apply(&target, &TransferOptions::full(target.points.len()))
}

/// Copies `own`, the changes on the coarse mesh, where both meshes have the same hinges and triangles.
fn copy_shared(delta: &mut MemoryDelta, own: &MemoryDelta, coarse: &CoarseMesh, garment: &Garment) {
    let hinges = garment.topology.hinges.iter().enumerate();
    let by_triangles: FxHashMap<[u32; 2], usize> = hinges.map(|(h, hinge)| (hinge.triangles, h)).collect();
    for (h, hinge) in coarse.garment.topology.hinges.iter().enumerate() {
        let [Some(a), Some(b)] = hinge.triangles.map(|f| coarse.unchanged_from[f as usize]) else { continue };
        if let Some(&whole) = by_triangles.get(&[a.min(b), a.max(b)]) {
            delta.angle[whole] = own.angle[h];
            delta.stiffness[whole] = own.stiffness[h];
        }
    }
    for (f, unchanged) in coarse.unchanged_from.iter().enumerate() {
        if let Some(whole) = unchanged {
            delta.stretch[*whole as usize] = own.stretch[f];
        }
    }
}

/// Correspondence of a garment with its coarse mesh.
struct CoarseMeshLocator<'a> {
    source: GarmentSurface,
    target: &'a GarmentSurface,
    containing_triangle: &'a [u32],
    /// Per coarse triangle: itself and all that have a point in common with it, sorted.
    neighbourhood: Vec<Vec<u32>>,
    /// Per coarse triangle: outward unit normal.
    normals: Vec<Vec3>,
}

impl<'a> CoarseMeshLocator<'a> {
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

impl Correspondence for CoarseMeshLocator<'_> {
    fn source(&self) -> &GarmentSurface {
        &self.source
    }

    fn find(&self, f: usize, query: &Query) -> Option<Match> {
        let distance = |g: u32| {
            let [a, b, c] = self.source.corners(g as usize);
            point_triangle_squared(&query.position, &a, &b, &c)
        };
        let containing = self.target.triangles[f].iter().map(|p| self.containing_triangle[p.at()]);
        let near = containing.flat_map(|g| self.neighbourhood[g as usize].iter().copied());
        let nearest =
            near.map(|g| (distance(g), g)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let triangle = nearest.1 as usize;
        let map = smallest_rotation(&self.normals[triangle], &query.normal);
        Some(Match { triangle, quality: 1.0, map })
    }
}
