//! Rotations of the corners of a mesh by the wear: smooth over the panels between creases, and carried from there over the strips beside a
//! centre line, so that the angle of line and rows stands at the line.

use crate::remesh::GarmentSurface;
use crate::remesh::tuning::TUNING;
use crate::remesh::worn_surface::crease_edges::CreaseEdges;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::{Groups, mean_rotation, weighted_rotation};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Rotation of a panel at a point of its border with a strip.
struct Seed {
    point: u32,
    rotation: Mat3,
}

/// Rotations per triangle and corner of `mesh`, whose points move to `after` [m].
pub(super) fn corner_rotations(
    mesh: &GarmentSurface,
    after: &[Vec3],
    creases: &CreaseEdges,
) -> Vec<[Mat3; 3]> {
    let mut all = panel_rotations(mesh, after, creases);
    let mut seen = vec![false; mesh.triangles.len()];
    for f in 0..mesh.triangles.len() {
        if !creases.strip[f] || seen[f] {
            continue;
        }
        let (strip, seeds) = strip_from(mesh, creases, &all, f, &mut seen);
        if seeds.is_empty() {
            continue;
        }
        for g in strip {
            let t = mesh.triangles[g];
            all[g] = t.map(|p| carried(mesh, &seeds, &mesh.points[p.at()]));
        }
    }
    all
}

/// Rotations averaged over the triangles around each point that no centre line parts and of which all or none are in strips.
fn panel_rotations(mesh: &GarmentSurface, after: &[Vec3], creases: &CreaseEdges) -> Vec<[Mat3; 3]> {
    let count = mesh.triangles.len();
    let mut groups = Groups::new(3 * count);
    let corner = |f: u32, p| mesh.triangles[f as usize].iter().position(|q| *q == p).unwrap_or(0) as u32;
    for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
        let [f, g] = hinge.triangles;
        if creases.is_centre(h) || creases.strip[f as usize] != creases.strip[g as usize] {
            continue;
        }
        for p in &hinge.points[..2] {
            groups.join(3 * f + corner(f, *p), 3 * g + corner(g, *p));
        }
    }
    let mut sums = vec![Mat3::zeros(); 3 * count];
    for (f, t) in mesh.triangles.iter().enumerate() {
        let weighted = weighted_rotation(&mesh.points, after, t);
        for k in 0..3 {
            sums[groups.find((3 * f + k) as u32) as usize] += weighted;
        }
    }
    let mean: Vec<Mat3> = sums.into_iter().map(mean_rotation).collect();
    (0..count).map(|f| std::array::from_fn(|k| mean[groups.find((3 * f + k) as u32) as usize])).collect()
}

/// The strip around triangle `first` on its side of the centre line, and the rotations of the panel along its border.
fn strip_from(
    mesh: &GarmentSurface,
    creases: &CreaseEdges,
    rotations: &[[Mat3; 3]],
    first: usize,
    seen: &mut [bool],
) -> (Vec<usize>, Vec<Seed>) {
    let (mut strip, mut found) = (Vec::new(), FxHashMap::<u32, (Mat3, f64)>::default());
    let mut queue = VecDeque::from([first]);
    seen[first] = true;
    while let Some(f) = queue.pop_front() {
        strip.push(f);
        for e in mesh.topology.triangle_edges[f] {
            let Some(h) = mesh.topology.edge_hinge[e as usize] else { continue };
            if creases.is_centre(h as usize) {
                continue;
            }
            let hinge = &mesh.topology.hinges[h as usize];
            let other = hinge.triangles[usize::from(hinge.triangles[0] as usize == f)] as usize;
            if creases.strip[other] {
                if !seen[other] {
                    seen[other] = true;
                    queue.push_back(other);
                }
                continue;
            }
            for p in &hinge.points[..2] {
                let k = mesh.triangles[other].iter().position(|q| q == p).unwrap_or(0);
                let entry = found.entry(p.0).or_insert((Mat3::zeros(), 0.0));
                entry.0 += rotations[other][k];
                entry.1 += 1.0;
            }
        }
    }
    let mut seeds: Vec<Seed> =
        found.into_iter().map(|(point, (sum, count))| Seed { point, rotation: sum / count }).collect();
    seeds.sort_by_key(|seed| seed.point);
    (strip, seeds)
}

/// The rotation of the seeds around `x` [m].
fn carried(mesh: &GarmentSurface, seeds: &[Seed], x: &Vec3) -> Mat3 {
    let squared = |seed: &Seed| (mesh.points[seed.point as usize] - x).norm_squared();
    let nearest = seeds.iter().map(squared).fold(f64::INFINITY, f64::min);
    let reach = TUNING.strip_reach * TUNING.strip_reach;
    let weighted = seeds.iter().map(|seed| seed.rotation * (-(squared(seed) - nearest) / reach).exp());
    mean_rotation(weighted.sum())
}
