//! Meshing of a panel with near-equilateral triangles.
//!
//! Interior points are those of a hexagonal lattice, boundary points those of the outline. Lattice points close to
//! the border are removed, and a constrained Delaunay triangulation connects the others. A few rounds of spring
//! relaxation with the target edge length distribute the irregularity at the border over a few rows; the interior
//! lattice is in equilibrium.

use crate::outline::Boundary;
use crease_geometry::math::Vec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::BTreeMap;

/// Triangle mesh in the plane.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Boundary points in the order of the outline, then interior points [m].
    pub points: Vec<Vec2>,
    /// Triangles over the points, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

/// Smallest distance of lattice points from the border, over the edge length [-].
const MIN_BORDER_DISTANCE: f64 = 0.60;
/// Rounds of triangulation and relaxation; the quality converges after about a dozen.
const ROUNDS: usize = 16;
/// Relaxation steps between two triangulations.
const STEPS: usize = 4;
/// Fraction of the summed spring displacement per step; about 1/6 for six neighbours [-].
const RELAXATION: f64 = 0.15;
/// Area over squared edge below which a triangle is a rounding error [-].
const SLIVER_FRACTION: f64 = 1e-6;

/// Meshes the inside of `boundary` with edges of about `edge_m` [m]; `shift` displaces the lattice [edges].
pub fn fill(boundary: &Boundary, edge_m: f64, shift: Vec2) -> Panel {
    let mut points = boundary.points.clone();
    let boundary_count = points.len();
    points.extend(
        lattice(boundary, edge_m, shift)
            .into_iter()
            .filter(|&p| boundary.contains(p) && boundary.distance(p, None) > MIN_BORDER_DISTANCE * edge_m),
    );
    let mut triangles = Vec::new();
    for _ in 0..ROUNDS {
        triangles = delaunay(&points, boundary);
        flip_corner_chords(&mut triangles, &points, boundary_count);
        for _ in 0..STEPS {
            relax(&mut points, &triangles, edge_m, boundary_count);
        }
    }
    Panel { points, triangles }
}

/// Lattice points over the bounding box of the outline, columns along the length.
fn lattice(boundary: &Boundary, edge_m: f64, shift: Vec2) -> Vec<Vec2> {
    let (mut low, mut high) = (boundary.points[0], boundary.points[0]);
    for p in &boundary.points {
        (low, high) = (low.inf(p), high.sup(p));
    }
    let column_m = edge_m * 3f64.sqrt() / 2.0;
    let columns = ((high.x - low.x) / column_m).ceil() as i64 + 2;
    let rows = ((high.y - low.y) / edge_m).ceil() as i64 + 2;
    let mut points = Vec::new();
    for i in -1..columns {
        for j in -1..rows {
            let half = if i.rem_euclid(2) == 1 { 0.5 } else { 0.0 };
            let x = low.x + (i as f64 + shift.x) * column_m;
            let y = low.y + (j as f64 + half + shift.y) * edge_m;
            points.push(Vec2::new(x, y));
        }
    }
    points
}

fn delaunay(points: &[Vec2], boundary: &Boundary) -> Vec<[u32; 3]> {
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let handles: Vec<_> = points
        .iter()
        .map(|p| mesh.insert(Point2::new(p.x, p.y)).expect("pattern points are finite and not tiny"))
        .collect();
    let count = boundary.points.len();
    for i in 0..count {
        mesh.add_constraint(handles[i], handles[(i + 1) % count]);
    }
    mesh.inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .filter(|&t| {
            // Collinear points of the outline span slivers of rounding errors.
            let [a, b, c] = t.map(|i| points[i as usize]);
            area(points, t) > SLIVER_FRACTION * (b - a).norm_squared() && boundary.contains((a + b + c) / 3.0)
        })
        .collect()
}

fn area(points: &[Vec2], t: [u32; 3]) -> f64 {
    let [a, b, c] = t.map(|i| points[i as usize]);
    (b - a).perp(&(c - a)) / 2.0
}

/// Flips every interior edge between two points of the outline. Such a chord cuts off a corner of the panel: after
/// sewing, the chords of front and back would be one edge with four triangles.
fn flip_corner_chords(triangles: &mut [[u32; 3]], points: &[Vec2], boundary_count: usize) {
    let mut sides: BTreeMap<[u32; 2], (usize, usize)> = BTreeMap::new();
    let mut chords = Vec::new();
    for (f, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if (a as usize) < boundary_count && (b as usize) < boundary_count {
                sides.insert([a, b], (f, k));
                if a < b {
                    chords.push([a, b]);
                }
            }
        }
    }
    for [a, b] in chords {
        let (Some(&(f, k)), Some(&(g, l))) = (sides.get(&[a, b]), sides.get(&[b, a])) else { continue };
        let (c, d) = (triangles[f][(k + 2) % 3], triangles[g][(l + 2) % 3]);
        let (left, right) = ([a, d, c], [d, b, c]);
        if area(points, left) > 0.0 && area(points, right) > 0.0 {
            (triangles[f], triangles[g]) = (left, right);
        }
    }
}

/// One step of every interior point under springs along the edges, of rest length `edge_m`.
fn relax(points: &mut [Vec2], triangles: &[[u32; 3]], edge_m: f64, boundary_count: usize) {
    let mut displacements = vec![Vec2::zeros(); points.len()];
    for t in triangles {
        for k in 0..3 {
            // An interior edge is visited once from each side: half a spring each.
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            let d = points[b] - points[a];
            let displacement = 0.5 * (1.0 - edge_m / d.norm()) * d;
            displacements[a] += displacement;
            displacements[b] -= displacement;
        }
    }
    for (p, displacement) in points.iter_mut().zip(displacements).skip(boundary_count) {
        *p += RELAXATION * displacement;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::{Border, boundary, line};

    #[test]
    fn a_filled_square_has_its_area_and_no_chord() {
        let half =
            [line([0.5, 0.0], Border::Sewn), line([0.5, 1.0], Border::Sewn), line([0.0, 1.0], Border::Sewn)];
        let outline = boundary([0.0, 0.0], &half, 0.05);
        let panel = fill(&outline, 0.05, Vec2::zeros());
        let total: f64 = panel.triangles.iter().map(|&t| area(&panel.points, t)).sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert!(panel.triangles.iter().all(|&t| area(&panel.points, t) > 0.0));
        let count = outline.points.len() as u32;
        for t in &panel.triangles {
            let on_border = t.iter().filter(|&&i| i < count).count();
            assert!(on_border < 3, "a corner is cut off: {t:?}");
        }
    }
}
