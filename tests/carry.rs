//! The part of a memory that a simulation mesh can show.

use crease::GarmentFile;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::garment::RestState;
use crease_model::remesh::{Curve, Seed, SimulationMesh, SizeField, SurfaceMesh, improve, resolved_memory};

/// A mesh with edges of 20 mm on a sheet of 0.4 x 0.4 m, with a line drawn along x = 0.1 m if asked.
fn mesh(lined: bool) -> SimulationMesh {
    let sheet = GarmentFile::sheet([0.4, 0.4], [20, 20]).expect("is a sheet").garment;
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
    let border = memory(&mesh, |ends| if ends.iter().any(|p| (p.x - low).abs() < 1e-6) { 0.2 } else { 0.0 });
    let [_, max] = sum_and_max(&mesh, &resolved_memory(&mesh, &border));
    assert!(max < 0.19, "{max}");
}
