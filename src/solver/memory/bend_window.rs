//! Bend of the cloth across each hinge within the reference length of the memory law.
//!
//! What creases is the bend within the reference length L, on whatever edges it lies: on a coarse mesh the angle of one hinge, on a fine
//! one that of several. The bends b of the hinges, from their source angles, are averaged as curvature over a disc around the middle of
//! the hinge:
//!
//! ```text
//! B_h = L / (pi R²) sum_j b_j l_j cos²(h, j),   R = 2 L / pi
//! ```
//!
//! with the length l_j of edge j inside the disc and the angle between the two edges. The bend of a hinge is that of the cloth on both
//! sides of its edge: l_j is the mean over lines parallel to the edge across the width of the hinge, as far as h itself. A lone
//! crease through the middle has `B = b`, and cloth bent evenly has `B = b L / w` with the width w of the hinge.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::{Hinge, Topology};
use rustc_hash::FxHashSet;
use std::f64::consts::PI;

/// Lines parallel to the edge of a hinge, in widths of the hinge from it [-]: middles of four strips.
const STRIPS: [f64; 4] = [-0.375, -0.125, 0.125, 0.375];

/// Weights of the bends of hinges in the bend within the reference length across each of them.
#[derive(Debug, Clone)]
pub(super) struct BendWindow {
    /// Per hinge narrower than L: the hinges in its disc and their weights [-]; empty for wider ones.
    around: Vec<Vec<(u32, f64)>>,
}

impl BendWindow {
    /// The weights on a mesh of `points` [m] and `topology`, whose hinges are `width` [m] wide, for the length `reference` [m].
    pub fn new(points: &[Vec3], topology: &Topology, width: &[f64], reference: f64) -> Self {
        let of = |h: usize| {
            if width[h] < reference {
                hinges_around(points, topology, width, h, reference)
            } else {
                Vec::new()
            }
        };
        Self { around: (0..topology.hinges.len()).map(of).collect() }
    }

    /// Returns the bend within the reference length across a hinge over its own [-] where the hinges have the bends `bend` [rad]; `None`
    /// for a hinge without a window or without a bend.
    pub fn concentration(&self, hinge: usize, bend: impl Fn(usize) -> f64) -> Option<f64> {
        let around = self.around.get(hinge).filter(|around| !around.is_empty())?;
        let own = bend(hinge);
        let all: f64 = around.iter().map(|(j, weight)| weight * bend(*j as usize)).sum();
        (own != 0.0).then_some(all / own)
    }
}

/// Returns the hinges in the disc around a hinge that are connected to it there, with their weights.
fn hinges_around(
    points: &[Vec3],
    topology: &Topology,
    width: &[f64],
    hinge: usize,
    reference: f64,
) -> Vec<(u32, f64)> {
    let radius = 2.0 * reference / PI;
    let ends = |e: u32| topology.edges[e as usize].map(|p| points[p.at()]);
    let own = &topology.hinges[hinge];
    let [a, b] = ends(own.edge);
    let (middle, along) = (0.5 * (a + b), (b - a).normalize());
    let mut found = Vec::new();
    let mut seen_edges = FxHashSet::default();
    let mut seen_triangles: FxHashSet<u32> = own.triangles.into_iter().collect();
    let mut waiting = own.triangles.to_vec();
    while let Some(f) = waiting.pop() {
        for e in topology.triangle_edges[f as usize] {
            let Some(j) = topology.edge_hinge[e as usize].filter(|_| seen_edges.insert(e)) else { continue };
            let [from, to] = ends(e);
            let direction = (to - from).normalize();
            // What lies on one line with the hinge belongs to the same crease.
            let distance = ((middle - from) - direction * (middle - from).dot(&direction)).norm();
            let spread = width[j as usize].min(2.0 * distance);
            let across = across_hinge(points, &topology.hinges[j as usize]) * spread;
            let part = |t: f64| length_in_ball(from + across * t, to + across * t, middle, radius);
            let length = STRIPS.iter().map(|t| part(*t)).sum::<f64>() / STRIPS.len() as f64;
            if length <= 0.0 {
                continue;
            }
            let cosine = direction.dot(&along);
            found.push((j, PI / (4.0 * reference) * length * cosine * cosine));
            let sides = topology.hinges[j as usize].triangles;
            waiting.extend(sides.into_iter().filter(|f| seen_triangles.insert(*f)));
        }
    }
    found.sort_unstable_by_key(|(j, _)| *j);
    found
}

/// Returns the unit vector from one triangle of a hinge to the other, across its edge.
fn across_hinge(points: &[Vec3], hinge: &Hinge) -> Vec3 {
    let [a, b, c, d] = hinge.points.map(|p| points[p.at()]);
    let along = (b - a).normalize();
    let across = (d - c) - along * (d - c).dot(&along);
    across.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
}

/// Returns the length of the part of a segment within `radius` of `centre` [m].
fn length_in_ball(from: Vec3, to: Vec3, centre: Vec3, radius: f64) -> f64 {
    let length = (to - from).norm();
    let along = (to - from) / length;
    let nearest = (centre - from).dot(&along);
    let half_squared = radius * radius - ((centre - from).norm_squared() - nearest * nearest);
    if half_squared <= 0.0 || !half_squared.is_finite() {
        return 0.0;
    }
    let half = half_squared.sqrt();
    ((nearest + half).min(length) - (nearest - half).max(0.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::mesh::PointIndex;

    const REFERENCE: f64 = 0.01;
    /// Size of the sheet [m].
    const SIZE: f64 = 0.08;

    /// The bend within the reference length over its own of the hinge in the middle of a square sheet with edges of `edge` [m], where the
    /// hinges along y have the angle `bend` at their distance in x from it [m].
    fn concentration(edge: f64, reference: f64, bend: impl Fn(f64) -> f64) -> f64 {
        let cells = (SIZE / edge).round() as u32;
        let row = cells + 1;
        let points: Vec<Vec3> =
            (0..row * row).map(|k| edge * Vec3::new(f64::from(k % row), f64::from(k / row), 0.0)).collect();
        let cell = |k: u32| {
            let a = k / cells * row + k % cells;
            [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]].map(|t| t.map(PointIndex))
        };
        let triangles: Vec<[PointIndex; 3]> = (0..cells * cells).flat_map(cell).collect();
        let topology = Topology::new(points.len(), &triangles);
        let ends = |h: usize| [0, 1].map(|k| points[topology.hinges[h].points[k].at()]);
        let middle = |h: &usize| {
            let [a, b] = ends(*h);
            (a.x - 0.5 * SIZE).abs() < 1e-9 && b.x == a.x && a.y.min(b.y) == edge * f64::from(cells / 2)
        };
        let hinges = topology.hinges.len();
        let window = BendWindow::new(&points, &topology, &vec![edge; hinges], reference);
        let middle = (0..hinges).find(middle).expect("a hinge in the middle");
        let angle = |h: usize| {
            let [a, b] = ends(h);
            if (a.x - b.x).abs() < 1e-9 { bend(a.x - 0.5 * SIZE) } else { 0.0 }
        };
        window.concentration(middle, angle).expect("narrower than the reference length")
    }

    #[test]
    fn a_lone_crease_counts_with_its_angle_and_even_bending_with_its_curvature() {
        for edge in [0.005, 0.0025, 0.00125] {
            let lone = concentration(edge, REFERENCE, |x| f64::from(u8::from(x.abs() < 1e-9)));
            assert!((lone - 1.0).abs() < 1e-9, "{edge}: {lone}");
            let even = concentration(edge, REFERENCE, |_| 1.0);
            let wanted = REFERENCE / edge;
            assert!((even / wanted - 1.0).abs() < 0.03, "{edge}: {even} for {wanted}");
        }
    }

    /// Angles that folded cloth had on edges of 16 and of 8 mm along its fold line.
    #[test]
    fn a_fold_counts_alike_on_coarse_and_on_fine_edges() {
        let coarse = 160.0;
        let fine = |x: f64| if x.abs() < 1e-9 { 135.0 } else { f64::from(u8::from(x.abs() < 0.009)) * 30.0 };
        let bend = 135.0 * concentration(0.008, 0.02, fine);
        assert!((bend / coarse - 1.0).abs() < 0.15, "{bend} degrees on edges of 8 mm");
    }
}
