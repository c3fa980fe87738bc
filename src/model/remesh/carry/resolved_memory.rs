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
    let along_line = |t: &[PointIndex; 3]| t.iter().filter(|p| mesh.on_line[p.at()]).count() >= 2;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remesh::{Curve, Seed, SizeField, SurfaceMesh, improve};
    use crease_geometry::math::Vec3;

    /// A mesh with edges of 20 mm on a sheet of 0.4 x 0.4 m, with a line drawn along x = 0.1 m if asked.
    fn mesh(lined: bool) -> SimulationMesh {
        let sheet = crate::files::GarmentFile::sheet([0.4, 0.4], [20, 20]).expect("is a sheet").garment;
        let mut mesh = SurfaceMesh::new(&sheet);
        let low = sheet.points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        let mut seeds = Vec::new();
        if lined {
            let mut level: Vec<f64> = mesh.x.iter().map(|p| p.x - low - 0.1).collect();
            mesh.cut(&mut level);
            for [a, b] in mesh.edges_on_line(&level) {
                mesh.draw(a, b, Curve::Line(0));
                seeds.extend(Seed::along(mesh.x[a as usize], mesh.x[b as usize], 0.02));
            }
        }
        improve(&mut mesh, &SizeField::new(&seeds, 0.02, 1.0, 0.02));
        mesh.finish()
    }

    /// New cloth on `mesh`, with the change of rest angle [rad] `change` of a hinge between these points.
    fn memory(mesh: &SimulationMesh, change: impl Fn(&[Vec3; 2]) -> f64) -> RestState {
        let garment = &mesh.garment;
        let mut rest = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
        for (angle, hinge) in rest.rest_angle.iter_mut().zip(&garment.topology.hinges) {
            *angle = change(&[0, 1].map(|k| garment.points[hinge.points[k].at()]));
        }
        rest
    }

    /// Sum over the hinges of the angle times length, and the largest angle.
    fn sum_and_max(mesh: &SimulationMesh, rest: &RestState) -> [f64; 2] {
        let garment = &mesh.garment;
        let length = |p: &[PointIndex; 4]| (garment.points[p[0].at()] - garment.points[p[1].at()]).norm();
        let hinges = garment.topology.hinges.iter().zip(&rest.rest_angle);
        let sum = hinges.map(|(hinge, angle)| angle * length(&hinge.points)).sum();
        [sum, rest.rest_angle.iter().fold(0.0, |max: f64, angle| max.max(angle.abs()))]
    }

    /// Whether an edge runs through the disc of 60 mm around the middle of the sheet.
    fn is_central(ends: &[Vec3; 2], middle: &Vec3) -> bool {
        ((ends[0] + ends[1]) / 2.0 - middle).norm() < 0.06
    }

    fn middle(mesh: &SimulationMesh) -> Vec3 {
        mesh.garment.points.iter().sum::<Vec3>() / mesh.garment.points.len() as f64
    }

    #[test]
    fn a_wrinkle_on_single_hinges_is_rounded_and_keeps_its_angle() {
        let mesh = mesh(false);
        let middle = middle(&mesh);
        let earned = memory(&mesh, |ends| {
            let crosses = (ends[0].x - middle.x).abs() < 0.008 && (ends[1].x - middle.x).abs() < 0.008;
            if crosses && is_central(ends, &middle) { 1.5 } else { 0.0 }
        });
        let [sum, max] = sum_and_max(&mesh, &earned);
        assert!(max == 1.5 && sum > 0.06, "{sum} {max}");
        let [sum_after, max_after] = sum_and_max(&mesh, &resolved_memory(&mesh, &earned));
        assert!(max_after < 0.75, "{max_after}");
        assert!((sum_after / sum - 1.0).abs() < 0.1, "{sum_after} of {sum}");
    }

    #[test]
    fn what_the_mesh_can_show_and_what_is_masked_stay() {
        let mut mesh = mesh(false);
        let middle = middle(&mesh);
        let soft = memory(&mesh, |ends| if is_central(ends, &middle) { 0.1 } else { 0.0 });
        assert_eq!(resolved_memory(&mesh, &soft), soft);
        mesh.garment.memory_mask.fill(0.0);
        let sharp = memory(&mesh, |ends| if is_central(ends, &middle) { 1.5 } else { 0.0 });
        assert_eq!(resolved_memory(&mesh, &sharp), sharp);
    }

    #[test]
    fn a_crease_along_a_drawn_line_stays_and_one_along_a_border_does_not() {
        let mesh = mesh(true);
        let low = mesh.garment.points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        let on = |ends: &[Vec3; 2], x: f64| ends.iter().all(|p| (p.x - low - x).abs() < 1e-6);
        let crease = memory(&mesh, |ends| if on(ends, 0.1) { 1.2 } else { 0.0 });
        let along = mesh
            .garment
            .topology
            .hinges
            .iter()
            .enumerate()
            .filter(|(_, hinge)| on(&[0, 1].map(|k| mesh.garment.points[hinge.points[k].at()]), 0.1));
        let along: Vec<usize> = along.map(|(h, _)| h).collect();
        assert!(along.len() > 10, "{}", along.len());
        let resolved = resolved_memory(&mesh, &crease);
        assert!(
            along.iter().all(|&h| resolved.rest_angle[h] > 0.9),
            "the line is on both sides of its triangles"
        );
        // A hinge that ends in the border.
        let border =
            memory(&mesh, |ends| if ends.iter().any(|p| (p.x - low).abs() < 1e-6) { 0.2 } else { 0.0 });
        let [_, max] = sum_and_max(&mesh, &resolved_memory(&mesh, &border));
        assert!(max < 0.19, "{max}");
    }
}
