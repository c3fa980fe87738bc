//! Heights of the points of a garment that lies, from the order of its triangles.
//!
//! Two triangles do not cross if the upper one lies above the lower at every corner of the polygon that they have in common in the plane:
//! heights are linear on either. So the heights satisfy linear inequalities, which are met one by one, round by round (position-based
//! dynamics, Müller and others 2007), above the ground.

use crate::wear::layout::layout_sides::Neighbours;
use crate::wear::layout::overlap_order::{Overlap, on_plane, weights_at};
use crate::wear::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, Topology, edge_distances};

/// A corner of a common polygon: points with their weights, positive in the upper triangle, negative in the lower.
struct Constraint {
    points: [u32; 6],
    weights: [f64; 6],
    /// Least difference of the heights [m].
    apart: f64,
    /// Inverse of the sum of the squares of the weights [-].
    inverse: f64,
}

impl Constraint {
    /// `None` at a point that both triangles have in common.
    fn new(sheet: &Sheet, [lower, upper]: [&[PointIndex; 3]; 2], at: Vec2) -> Option<Self> {
        let [below, above] = [lower, upper].map(|t| weights_at(at, &on_plane(sheet.flat, t)));
        let gap = sheet.gap_at([(lower, &below), (upper, &above)]);
        let points = [upper[0], upper[1], upper[2], lower[0], lower[1], lower[2]].map(|p| p.0);
        let mut weights = [above[0], above[1], above[2], -below[0], -below[1], -below[2]];
        for k in 3..6 {
            if let Some(same) = (0..3).find(|i| points[*i] == points[k]) {
                weights[same] += weights[k];
                weights[k] = 0.0;
            }
        }
        let sum: f64 = weights.iter().map(|w| w * w).sum();
        let apart = 0.5 * weights.iter().map(|w| w.abs()).sum::<f64>();
        (apart > 1e-6).then(|| Self { points, weights, apart: gap * apart, inverse: 1.0 / sum })
    }

    /// Height that is missing [m].
    fn missing(&self, y: &[f64]) -> f64 {
        let difference: f64 = self.points.iter().zip(&self.weights).map(|(p, w)| w * y[*p as usize]).sum();
        self.apart - difference
    }
}

/// Cloth in the plane.
struct Sheet<'a> {
    /// Positions of the points [m].
    flat: &'a [Vec3],
    /// Per point: distance from the nearest edge where the cloth turns over, along edges [m].
    from_folds: Vec<f64>,
    /// Distance of layers [m].
    gap: f64,
}

impl Sheet<'_> {
    /// Distance of two layers [m] at a place with weights in either triangle: less where both turn over nearby, for they may meet there.
    fn gap_at(&self, place: [(&[PointIndex; 3], &[f64; 3]); 2]) -> f64 {
        let distance = |(t, w): (&[PointIndex; 3], &[f64; 3])| -> f64 {
            t.iter().zip(w).map(|(p, w)| w * self.from_folds[p.at()]).sum()
        };
        let farther = distance(place[0]).max(distance(place[1]));
        self.gap.min(TUNING.lay.rim_slope * farther).max(TUNING.lay.min_gap_fraction * self.gap)
    }
}

/// Per point at `flat` [m]: distance from the nearest edge across which the cloth is folded over, along edges [m].
fn distance_from_folds(
    flat: &[Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
    neighbours: &[Neighbours],
) -> Vec<f64> {
    let mut is_fold = vec![false; flat.len()];
    for Neighbours { edge, triangles: pair, .. } in neighbours {
        let ends = topology.edges[*edge];
        let [a, b] = ends.map(|p| flat[p.at()]);
        let side = |f: usize| {
            let opposite = triangles[f].iter().find(|p| !ends.contains(p)).map_or(a, |p| flat[p.at()]);
            (b - a).cross(&(opposite - a)).y
        };
        if side(pair[0]) * side(pair[1]) > 0.0 {
            ends.iter().for_each(|p| is_fold[p.at()] = true);
        }
    }
    edge_distances(flat, topology, &is_fold, f64::INFINITY)
}

/// Heights of the points at `flat` [m] above the ground, one per point, so that the triangles of every overlap lie `gap` [m] apart where
/// that is possible, and closer next to folds.
pub(crate) fn layer_heights(
    flat: &[Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
    neighbours: &[Neighbours],
    overlaps: &[Overlap],
    gap: f64,
) -> Vec<f64> {
    let from_folds = distance_from_folds(flat, triangles, topology, neighbours);
    let sheet = &Sheet { flat, from_folds, gap };
    let constraints: Vec<Constraint> = overlaps
        .iter()
        .flat_map(|overlap| {
            let pair = overlap.triangles.map(|f| &triangles[f as usize]);
            overlap.polygon.iter().filter_map(move |at| Constraint::new(sheet, pair, *at))
        })
        .collect();
    let mut y = vec![0.0; flat.len()];
    for _ in 0..TUNING.lay.max_gap_rounds {
        let mut largest = 0.0f64;
        for constraint in &constraints {
            let missing = constraint.missing(&y);
            if missing > 0.0 {
                largest = largest.max(missing / constraint.apart);
                let step = missing * constraint.inverse;
                for (p, w) in constraint.points.iter().zip(&constraint.weights) {
                    y[*p as usize] = (y[*p as usize] + step * w).max(0.0);
                }
            }
        }
        if largest < TUNING.lay.gap_tol {
            break;
        }
    }
    y
}

/// Most triangles on one another at the centroid of one.
pub(crate) fn layer_count(flat: &[Vec3], triangles: &[[PointIndex; 3]], overlaps: &[Overlap]) -> u32 {
    let mut others = vec![0; triangles.len()];
    let both = |overlap: &Overlap| {
        let [f, g] = overlap.triangles;
        [[f, g], [g, f]]
    };
    for f in overlaps.iter().flat_map(both) {
        let [[a, b, c], corners] = f.map(|f| on_plane(flat, &triangles[f as usize]));
        let is_over = weights_at((a + b + c) / 3.0, &corners).iter().all(|w| *w >= 0.0);
        others[f[0] as usize] += u32::from(is_over);
    }
    1 + others.into_iter().max().unwrap_or(0)
}
