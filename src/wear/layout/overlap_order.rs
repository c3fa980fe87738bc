//! Order of the triangles that lie on one another in a garment that lies, as paper folding has it.
//!
//! Where two triangles overlap in the plane one lies above the other. Cloth does not pass through cloth: if an edge lies over a triangle,
//! all triangles on that edge lie on the same side of it. Pairs that are bound to one another in this way form a group, and a group has one
//! order: that of the shape before the garment is laid, in which the offset of one triangle from the other along their common outward normal
//! says which is the upper one; of a group the mean over its overlaps counts.

use crate::wear::layout::layout_sides::{LayoutSides, Neighbours};
use crate::wear::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{Groups, PointIndex, triangle};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Two triangles that overlap in the plane.
#[derive(Debug, Clone)]
pub(crate) struct Overlap {
    /// The lower and the upper triangle.
    pub triangles: [u32; 2],
    /// Corners of the common polygon [m].
    pub polygon: Vec<Vec2>,
    /// Area of it [m²].
    area: f64,
}

/// Points of the cloth seen from above [m]: x to the right, the second coordinate away from the viewer.
pub(crate) fn on_plane<const N: usize>(flat: &[Vec3], points: &[PointIndex; N]) -> [Vec2; N] {
    points.map(|p| Vec2::new(flat[p.at()].x, -flat[p.at()].z))
}

/// Corners of a triangle in the plane, counter-clockwise [m].
fn in_plane(flat: &[Vec3], t: &[PointIndex; 3]) -> [Vec2; 3] {
    let [a, b, c] = on_plane(flat, t);
    if (b - a).perp(&(c - a)) < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// The part of the convex `polygon` inside of the counter-clockwise triangle `clip` (Sutherland and Hodgman).
fn clipped(mut polygon: Vec<Vec2>, clip: &[Vec2; 3]) -> Vec<Vec2> {
    for k in 0..3 {
        let (a, along) = (clip[k], clip[(k + 1) % 3] - clip[k]);
        let side: Vec<f64> = polygon.iter().map(|p| along.perp(&(p - a))).collect();
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, p) in polygon.iter().enumerate() {
            let j = (i + 1) % polygon.len();
            if side[i] >= 0.0 {
                kept.push(*p);
            }
            if (side[i] > 0.0 && side[j] < 0.0) || (side[i] < 0.0 && side[j] > 0.0) {
                kept.push(p + (polygon[j] - p) * (side[i] / (side[i] - side[j])));
            }
        }
        polygon = kept;
    }
    polygon
}

/// Area of a polygon [m²].
fn area(polygon: &[Vec2]) -> f64 {
    let Some(first) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|w| 0.5 * (w[0] - first).perp(&(w[1] - first))).sum::<f64>().abs()
}

/// Pairs of triangles that overlap at `flat` [m], the lower one first, with their order in the shape at `source` [m].
pub(crate) fn ordered_overlaps(
    source: &[Vec3],
    flat: &[Vec3],
    triangles: &[[PointIndex; 3]],
    sides: &LayoutSides,
    neighbours: &[Neighbours],
    edges: &[[PointIndex; 2]],
) -> Vec<Overlap> {
    let mut overlaps = overlaps(flat, triangles);
    let index: FxHashMap<[u32; 2], u32> =
        (0..).zip(&overlaps).map(|(k, overlap)| (overlap.triangles, k)).collect();
    // Node 2 k says that the second triangle of pair k is the upper one, node 2 k + 1 that the first is.
    let node = |upper: u32, lower: u32| {
        let key = [upper.min(lower), upper.max(lower)];
        index.get(&key).map(|k| 2 * k + u32::from(upper < lower))
    };
    let mut groups = Groups::new(2 * overlaps.len());
    let mut above = vec![Vec::new(); triangles.len()];
    for overlap in &overlaps {
        let [f, g] = overlap.triangles;
        above[f as usize].push(g);
        above[g as usize].push(f);
    }
    let is_over = |edge: usize, g: u32| {
        let [a, b] = on_plane(flat, &edges[edge]);
        length_inside(a, b, &in_plane(flat, &triangles[g as usize])) > TUNING.lay.min_overlap
    };
    for pair in neighbours {
        let [f, g] = pair.triangles.map(|f| f as u32);
        for other in &above[f as usize] {
            let (Some(one), Some(two)) = (node(f, *other), node(g, *other)) else { continue };
            if is_over(pair.edge, *other) {
                groups.join(one, two);
                groups.join(one ^ 1, two ^ 1);
            }
        }
    }
    let weights: Vec<f64> = overlaps
        .iter()
        .map(|overlap| overlap.area * evidence(source, flat, triangles, sides, overlap))
        .collect();
    let mut sums = vec![0.0; 2 * overlaps.len()];
    for (k, weight) in (0u32..).zip(&weights) {
        for (node, sign) in [(2 * k, 1.0), (2 * k + 1, -1.0)] {
            sums[groups.find(node) as usize] += sign * weight;
        }
    }
    for (k, overlap) in (0u32..).zip(&mut overlaps) {
        let (root, opposite) = (groups.find(2 * k), groups.find(2 * k + 1));
        // A group that contradicts itself says nothing: every pair counts by itself.
        let sum = if root == opposite { weights[k as usize] } else { sums[root as usize] };
        if sum < 0.0 {
            overlap.triangles.swap(0, 1);
        }
    }
    overlaps
}

/// Pairs of triangles that overlap in the plane at `flat` [m], in the order of their numbers.
fn overlaps(flat: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<Overlap> {
    let near = TriangleBvh::new(flat, triangles, 1e-6).overlaps();
    let overlap = |(f, g): (u32, u32)| {
        let [one, two] = [f, g].map(|f| in_plane(flat, &triangles[f as usize]));
        let polygon = clipped(one.to_vec(), &two);
        let area = area(&polygon);
        (polygon.len() > 2 && area > TUNING.lay.min_overlap.powi(2)).then(|| Overlap {
            triangles: [f.min(g), f.max(g)],
            polygon,
            area,
        })
    };
    let mut found: Vec<Overlap> = near.into_par_iter().filter_map(overlap).collect();
    found.sort_unstable_by_key(|overlap| overlap.triangles);
    found
}

/// Length of the part of the segment from `a` to `b` inside of a triangle [m].
fn length_inside(a: Vec2, b: Vec2, triangle: &[Vec2; 3]) -> f64 {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for k in 0..3 {
        let (corner, along) = (triangle[k], triangle[(k + 1) % 3] - triangle[k]);
        let (s, e) = (along.perp(&(a - corner)), along.perp(&(b - corner)));
        if s <= 0.0 && e <= 0.0 {
            return 0.0;
        }
        if s < 0.0 {
            first = first.max(s / (s - e));
        } else if e < 0.0 {
            last = last.min(s / (s - e));
        }
    }
    (last - first).max(0.0) * (b - a).norm()
}

/// Cosine of the angle between the offset of the second triangle of a pair from the first, where they overlap, and their common outward
/// normal [-]: positive where the second is the upper one.
fn evidence(
    source: &[Vec3],
    flat: &[Vec3],
    triangles: &[[PointIndex; 3]],
    sides: &LayoutSides,
    overlap: &Overlap,
) -> f64 {
    let middle = overlap.polygon.iter().sum::<Vec2>() / overlap.polygon.len() as f64;
    let [(x, m), (y, n)] = overlap.triangles.map(|f| {
        let t = &triangles[f as usize];
        let [a, b, c] = triangle::corners(source, t);
        let weights = weights_at(middle, &on_plane(flat, t));
        let normal = triangle::normal(&[a, b, c]).unwrap_or_else(Vec3::zeros);
        let upward = if sides.up[f as usize] { normal } else { -normal };
        (a * weights[0] + b * weights[1] + c * weights[2], upward)
    });
    let upward = m + n + Vec3::y() * TUNING.lay.upward_weight;
    let apart = y - x;
    let cosine = apart.dot(&upward) / (apart.norm() * upward.norm()).max(f64::MIN_POSITIVE);
    if cosine == 0.0 {
        // Copies in one place: the later one is the outer one.
        return if sides.up[overlap.triangles[1] as usize] { 1e-9 } else { -1e-9 };
    }
    cosine
}

/// Barycentric coordinates of `p` in a triangle of the plane; thirds where it has no area.
pub(crate) fn weights_at(p: Vec2, [a, b, c]: &[Vec2; 3]) -> [f64; 3] {
    let all = (b - a).perp(&(c - a));
    if all == 0.0 {
        return [1.0 / 3.0; 3];
    }
    let (v, w) = ((p - a).perp(&(c - a)) / all, (b - a).perp(&(p - a)) / all);
    [1.0 - v - w, v, w]
}
