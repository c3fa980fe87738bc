//! Comparison of memories: crease angle across the folds of `fold-thrice`, and the change of curvature over a surface.

use crease::internal::transfer::{MatchBy, TransferOptions, TransferResult, TransferSource, transfer};
use crease_model::garment::RestState;
use crease_model::remesh::GarmentSurface;

/// A fold.
#[derive(Clone, Copy)]
pub struct Fold {
    /// Axis across it: 0 = x, 2 = z.
    pub axis: usize,
    /// Position on that axis [m].
    pub at: f64,
    /// Total angle [rad].
    pub angle: f64,
    /// Half width [m].
    pub width: f64,
}

/// Folds of `fold-thrice` on the T-shirt of 0.892 x 0.7 m.
pub const FOLDS: [Fold; 3] = [
    Fold { axis: 0, at: -0.178, angle: 1.2, width: 0.02 },
    Fold { axis: 0, at: 0.178, angle: -0.9, width: 0.02 },
    Fold { axis: 2, at: 0.0, angle: 0.7, width: 0.02 },
];

/// Sum of (change x length x (across)²) over the hinges of one layer near a fold, per length of the fold: the angle by which
/// the cloth turns there [rad]. Hinges count less and less towards the ends of the window: with a sharp end it would depend
/// on which side of it single hinges of other wrinkles fall.
pub fn total(surface: &GarmentSurface, memory: &RestState, fold: &Fold, front: bool) -> f64 {
    turns(surface, memory, fold, front).iter().sum()
}

/// The same for positive and for negative changes separately [rad]: cloth that was pressed flat beside a sharp crease bends
/// back there.
pub fn turns(surface: &GarmentSurface, memory: &RestState, fold: &Fold, front: bool) -> [f64; 2] {
    let other = 2 - fold.axis;
    // Away from borders and from the other folds.
    let (middle, half) = if fold.axis == 0 { (0.15, 0.1) } else { (0.0, 0.1) };
    let reach = 4.0 * fold.width;
    let mut sum = [0.0; 2];
    for (h, hinge) in surface.topology.hinges.iter().enumerate() {
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| surface.points[p.at()]);
        let (centre, edge) = (0.5 * (a + b), b - a);
        let up = surface.normal(hinge.triangles[0] as usize).y > 0.0;
        if up == front {
            let across = edge[other] / edge.norm();
            let window =
                window_at((centre[fold.axis] - fold.at) / reach) * window_at((centre[other] - middle) / half);
            let change = memory.rest_angle[h] - memory.source_angle[h];
            sum[usize::from(change < 0.0)] += window * change * edge.norm() * across * across;
        }
    }
    // The integral of the window along the fold.
    sum.map(|sum| sum / (1.5 * half))
}

/// Window function of a relative distance: 1 up to 0.5, then down to 0 at 1 as a cosine.
fn window_at(distance: f64) -> f64 {
    0.5 + 0.5 * (std::f64::consts::PI * (2.0 * distance.abs() - 1.0).clamp(0.0, 1.0)).cos()
}

/// Change of curvature of every triangle as (area, xx, zz, sqrt2 xz), from its hinges.
pub fn tensors(surface: &GarmentSurface, memory: &RestState) -> Vec<[f64; 4]> {
    let one = |f: usize| {
        let area = 0.5 * surface.normal(f).norm();
        let corners = surface.corners(f);
        let mut out = [area, 0.0, 0.0, 0.0];
        for k in 0..3 {
            let edge = corners[(k + 1) % 3] - corners[k];
            let Some(h) = surface.topology.edge_hinge[surface.topology.triangle_edges[f][k] as usize] else {
                continue;
            };
            let h = h as usize;
            let weight = (memory.rest_angle[h] - memory.source_angle[h]) / (2.0 * area * edge.norm());
            out[1] += weight * edge.z * edge.z;
            out[2] += weight * edge.x * edge.x;
            out[3] -= weight * edge.x * edge.z * 2f64.sqrt();
        }
        out
    };
    (0..surface.triangles.len()).map(one).collect()
}

/// Correlation of the change of curvature over the surface of one mesh.
pub fn correlation(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    let dot = |a: &[[f64; 4]], b: &[[f64; 4]]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a[0] * (1..4).map(|c| a[c] * b[c]).sum::<f64>()).sum()
    };
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

/// Transfers `memory` of `from` to `to` with default options.
pub fn carry(from: &GarmentSurface, memory: &RestState, to: &GarmentSurface, by: MatchBy) -> TransferResult {
    let source = TransferSource {
        file: "made".into(),
        surface: from.clone(),
        memory: memory.clone(),
        joints: Vec::new(),
        simulated: None,
    };
    let options = TransferOptions { match_by: by, ..TransferOptions::full(to.points.len()) };
    transfer(&[source], to, &options).expect("carries")
}
