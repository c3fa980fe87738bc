//! The part of a memory that a simulation mesh can show.
//!
//! Away from fold lines a wrinkle does not run along the edges of the mesh. Where it is narrower than a few of them, one hinge or another
//! has it by chance, far more sharply than cloth bends: facets. Curvature that the mesh can show stays as it is; what exceeds that
//! is averaged over a ring of triangles, and along borders, where cloth is hemmed, all of it. The integral of the curvature over
//! the surface stays, and with it the angle across a wrinkle. Along fold lines, where the mesh has edges and rows of points
//! for the crease, the memory stays as it was earned.

use crate::garment::{Garment, RestState, changed_curvature};
use crate::remesh::SimulationMesh;
use crate::remesh::carry::hinge_fit::{FaceFrame, PlaneTensor, fit_hinge_angles};
use crate::remesh::carry::smoothing::{ring_mean, to_plane};
use crate::remesh::carry::surface::GarmentSurface;
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::mesh::PointIndex;

/// The memory `earned` on `mesh`, one entry per hinge and triangle of it, with the rest angles that the mesh can show. Cloth whose memory
/// is masked out takes no part; rest lengths and stiffness stay.
pub fn resolved_memory(mesh: &SimulationMesh, earned: &RestState) -> RestState {
    let garment = &mesh.garment;
    let surface = GarmentSurface::without_texture(garment);
    let averaged = averaged_triangles(mesh);
    let shown = shown_curvature(garment, &surface);
    let in_plane = |(f, tensor)| to_plane(&FaceFrame::new(&surface.corners(f)), tensor);
    let own: Vec<PlaneTensor> = changed_curvature(garment, earned).iter().enumerate().map(in_plane).collect();
    let mut resolved = own.clone();
    for _ in 0..TUNING.resolved.rounds {
        let excess_of = |(tensor, shown): (&PlaneTensor, &f64)| {
            tensor * (1.0 - shown / tensor.norm().max(f64::MIN_POSITIVE)).max(0.0)
        };
        let excess: Vec<PlaneTensor> = resolved.iter().zip(&shown).map(excess_of).collect();
        let spread = ring_mean(&surface, &excess, &averaged);
        resolved.iter_mut().zip(excess.iter().zip(&spread)).for_each(|(now, (from, to))| *now += to - from);
    }
    // The difference is fitted: where nothing was averaged angles stay what they are.
    let change: Vec<PlaneTensor> = resolved.iter().zip(&own).map(|(resolved, own)| resolved - own).collect();
    let by = fit_hinge_angles(&surface, &change);
    let rest_angle = earned.rest_angle.iter().zip(by).map(|(angle, by)| angle + by).collect();
    RestState { rest_angle, ..earned.clone() }
}

/// Per triangle of `mesh`: whether it has memory and no side along a line that was drawn.
fn averaged_triangles(mesh: &SimulationMesh) -> Vec<bool> {
    let remembers = |p: &PointIndex| mesh.garment.memory_mask[p.at()] > 0.0;
    let on_line = |p: &&PointIndex| mesh.garment.on_fold_line.as_ref().is_some_and(|on| on[p.at()]);
    let along_line = |t: &[PointIndex; 3]| t.iter().filter(on_line).count() >= 2;
    mesh.garment.triangles.iter().map(|t| t.iter().all(remembers) && !along_line(t)).collect()
}

/// Per triangle of `garment`: the largest change of curvature that stays [1/m]; none along borders.
fn shown_curvature(garment: &Garment, surface: &GarmentSurface) -> Vec<f64> {
    let mut at_border = vec![false; garment.points.len()];
    let edges = garment.topology.edges.iter().zip(&garment.topology.edge_valence);
    edges
        .filter(|(_, valence)| **valence == 1)
        .flat_map(|(edge, _)| edge)
        .for_each(|p| at_border[p.at()] = true);
    let of_triangle = |(f, t): (usize, &[PointIndex; 3])| {
        // Side of the equilateral triangle of the same area.
        let side = (2.0 * surface.normal(f).norm() / 3f64.sqrt()).sqrt();
        let hemmed = t.iter().any(|p| at_border[p.at()]);
        if hemmed || side <= 0.0 { 0.0 } else { 1.0 / (TUNING.resolved.min_radius_edges * side) }
    };
    garment.triangles.iter().enumerate().map(of_triangle).collect()
}
