//! Rotations of the corners of a mesh by the wear: smooth over the panels between creases, and carried from there over the strips beside a
//! centre line, so that the angle of line and rows stands at the line.

use crate::remesh::GarmentSurface;
use crate::remesh::tuning::TUNING;
use crate::remesh::worn_surface::crease_edges::CreaseEdges;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::{Groups, PointIndex, mean_rotation, weighted_rotation};
use rustc_hash::{FxHashMap, FxHashSet};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Lengths of [`TUNING`]'s `strip_reach` beyond which a rotation has no weight where the nearest is as near as a row.
const STRIP_REACHES: f64 = 3.0;

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
    let panels = panel_rotations(mesh, after, creases);
    let of_triangle = |f: usize| {
        let seeds = if creases.strip[f] { seeds_around(mesh, creases, &panels, f) } else { Vec::new() };
        match seeds.is_empty() {
            true => panels[f],
            false => mesh.triangles[f].map(|p| carried(mesh, &seeds, &mesh.points[p.at()])),
        }
    };
    (0..mesh.triangles.len()).map(of_triangle).collect()
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

/// Rotations of the panel along the border of the strip around its triangle `first`: where the path to them over the strip, which does not cross a
/// centre line, is not much longer than the shortest. Where a centre line ends its two sides are one strip, and the path to the other side is longer.
fn seeds_around(
    mesh: &GarmentSurface,
    creases: &CreaseEdges,
    rotations: &[[Mat3; 3]],
    first: usize,
) -> Vec<Seed> {
    let mut found = FxHashMap::<u32, (Mat3, f64)>::default();
    // Bits of numbers that are not negative are ordered as they are.
    let mut open = BinaryHeap::from([Reverse((0.0f64.to_bits(), first))]);
    let mut seen = FxHashSet::default();
    let mut farthest = f64::INFINITY;
    while let Some(Reverse((length, f))) = open.pop() {
        let length = f64::from_bits(length);
        if length > farthest {
            break;
        }
        if !seen.insert(f) {
            continue;
        }
        for (other, ends) in neighbours(mesh, creases, f) {
            if creases.strip[other] {
                let step = (mesh.centroid(other) - mesh.centroid(f)).norm();
                open.push(Reverse(((length + step).to_bits(), other)));
                continue;
            }
            farthest = farthest.min(length + STRIP_REACHES * TUNING.strip_reach);
            for p in ends {
                let k = mesh.triangles[other].iter().position(|q| *q == p).unwrap_or(0);
                let entry = found.entry(p.0).or_insert((Mat3::zeros(), 0.0));
                entry.0 += rotations[other][k];
                entry.1 += 1.0;
            }
        }
    }
    let mut seeds: Vec<Seed> =
        found.into_iter().map(|(point, (sum, count))| Seed { point, rotation: sum / count }).collect();
    seeds.sort_by_key(|seed| seed.point);
    seeds
}

/// The triangles beside triangle `f` that no centre line parts from it, with the ends of the common edge.
fn neighbours<'a>(
    mesh: &'a GarmentSurface,
    creases: &'a CreaseEdges,
    f: usize,
) -> impl Iterator<Item = (usize, [PointIndex; 2])> + 'a {
    mesh.topology.triangle_edges[f].into_iter().filter_map(move |e| {
        let h = mesh.topology.edge_hinge[e as usize].filter(|h| !creases.is_centre(*h as usize))?;
        let hinge = &mesh.topology.hinges[h as usize];
        let other = hinge.triangles[usize::from(hinge.triangles[0] as usize == f)] as usize;
        Some((other, [hinge.points[0], hinge.points[1]]))
    })
}

/// The rotation of the seeds around `x` [m].
fn carried(mesh: &GarmentSurface, seeds: &[Seed], x: &Vec3) -> Mat3 {
    let squared = |seed: &Seed| (mesh.points[seed.point as usize] - x).norm_squared();
    let nearest = seeds.iter().map(squared).fold(f64::INFINITY, f64::min);
    let reach = TUNING.strip_reach * TUNING.strip_reach;
    let weighted = seeds.iter().map(|seed| seed.rotation * (-(squared(seed) - nearest) / reach).exp());
    mean_rotation(weighted.sum())
}
