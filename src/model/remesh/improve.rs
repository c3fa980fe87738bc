//! Rounds of splits, collapses, flips and moves that bring a mesh to the wanted edge lengths (Botsch and Kobbelt 2004, "A
//! remeshing approach to multiresolution modeling"), with curves kept.

use crate::remesh::sizing::SizeField;
use crate::remesh::surface_mesh::SurfaceMesh;
use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle::quality as triangle_quality;
use rayon::prelude::*;

/// Brings the mesh to the lengths of `size`.
pub fn improve(mesh: &mut SurfaceMesh, size: &SizeField) {
    for round in 0..TUNING.max_rounds {
        let split = if round < TUNING.splitting_rounds { split_long(mesh, size) } else { 0 };
        let changed = split + collapse_short(mesh, size);
        flip_round(mesh);
        if round >= TUNING.rounds_before_moves {
            smooth(mesh);
        }
        if changed == 0 && round > TUNING.rounds_before_moves {
            break;
        }
    }
    for _ in 0..TUNING.smoothing_rounds {
        flip_round(mesh);
        smooth(mesh);
        mend(mesh);
    }
    flip_round(mesh);
}

/// Edge lengths that `size` asks for [m], one per point.
fn wanted_lengths(mesh: &SurfaceMesh, size: &SizeField) -> Vec<f64> {
    mesh.x.par_iter().map(|x| size.at(x)).collect()
}

/// Edges with their lengths over those `wanted`, one per point [m].
fn length_ratios(mesh: &SurfaceMesh, wanted: &[f64]) -> Vec<(f64, [u32; 2])> {
    let ratio = |[a, b]: [u32; 2]| mesh.length(a, b) / wanted[a as usize].min(wanted[b as usize]);
    mesh.edges().into_iter().map(|edge| (ratio(edge), edge)).collect()
}

fn split_long(mesh: &mut SurfaceMesh, size: &SizeField) -> usize {
    let mut long = length_ratios(mesh, &wanted_lengths(mesh, size));
    long.retain(|(ratio, _)| *ratio > TUNING.split_ratio);
    long.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, [a, b]) in &long {
        mesh.split(*a, *b, 0.5);
    }
    long.len()
}

fn collapse_short(mesh: &mut SurfaceMesh, size: &SizeField) -> usize {
    let lengths = wanted_lengths(mesh, size);
    let mut short = length_ratios(mesh, &lengths);
    short.retain(|(ratio, _)| *ratio < TUNING.collapse_ratio);
    short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let edges: Vec<[u32; 2]> = short.into_iter().map(|(_, edge)| edge).collect();
    collapse_each(mesh, &edges, |mesh, from, to| {
        let wanted = lengths[to as usize];
        mesh.neighbours(from)
            .into_iter()
            .all(|q| q == to || mesh.length(q, to) < TUNING.split_ratio * wanted.max(lengths[q as usize]))
    })
}

/// Collapses edges in order, no two of neighbours, in the better direction. Returns how many.
fn collapse_each(
    mesh: &mut SurfaceMesh,
    edges: &[[u32; 2]],
    allowed: impl Fn(&SurfaceMesh, u32, u32) -> bool,
) -> usize {
    let mut busy = vec![false; mesh.x.len()];
    let mut count = 0;
    for &[a, b] in edges {
        if busy[a as usize] || busy[b as usize] {
            continue;
        }
        let best = [(a, b), (b, a)]
            .into_iter()
            .filter_map(|(from, to)| {
                let [after, before] = mesh.collapse_quality(from, to)?;
                // A point on a curve is worth more than a free one.
                let kept =
                    f64::from(mesh.curve_degree(to).min(3)) - f64::from(mesh.curve_degree(from).min(3));
                (after > TUNING.min_shape.min(before) && allowed(mesh, from, to))
                    .then_some((kept, after, from, to))
            })
            .max_by(|x, y| x.0.total_cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let Some((_, _, from, to)) = best else { continue };
        for p in mesh.neighbours(from) {
            busy[p as usize] = true;
        }
        mesh.collapse(from, to);
        count += 1;
    }
    count
}

fn flip_round(mesh: &mut SurfaceMesh) -> usize {
    (0..4)
        .map(|_| mesh.edges().into_iter().filter(|[a, b]| mesh.flip(*a, *b)).count())
        .take_while(|count| *count > 0)
        .sum()
}

/// Moves free points towards the mean of their triangles' centroids, weighted by area.
fn smooth(mesh: &mut SurfaceMesh) {
    for p in 0..mesh.x.len() as u32 {
        if mesh.around[p as usize].is_empty() {
            continue;
        }
        if mesh.curve_degree(p) > 0 {
            mesh.slide_along_line(p, TUNING.min_line_shape);
            continue;
        }
        let (mut sum, mut weight) = (Vec3::zeros(), 0.0);
        for &f in &mesh.around[p as usize] {
            let x = mesh.corners(f);
            let area = (x[1] - x[0]).cross(&(x[2] - x[0])).norm();
            sum += (x[0] + x[1] + x[2]) * (area / 3.0);
            weight += area;
        }
        if weight > 0.0 {
            let target = sum / weight;
            let own = mesh.x[p as usize];
            mesh.slide(p, &(own + TUNING.relaxation * (target - own)), TUNING.min_shape);
        }
    }
}

/// Collapses the shortest edge of triangles of bad shape, whatever its wanted length.
fn mend(mesh: &mut SurfaceMesh) {
    let bad: Vec<u32> = (0..mesh.triangles.len() as u32)
        .filter(|&f| mesh.alive[f as usize] && triangle_quality(&mesh.corners(f)) < TUNING.bad_shape)
        .collect();
    let mut edges = Vec::new();
    for f in bad {
        let t = mesh.triangles[f as usize];
        let mut sides = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        sides.sort_by(|a, b| mesh.length(a[0], a[1]).total_cmp(&mesh.length(b[0], b[1])));
        edges.push(sides[0]);
    }
    collapse_each(mesh, &edges, |_, _, _| true);
}
