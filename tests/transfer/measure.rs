//! How memories are compared: crease angle across the folds of `fold-thrice`, and the change of curvature over a surface.

use crease::garment::RestState;
use crease::transfer::{GarmentSurface, MatchBy, TransferOptions, TransferResult, TransferSource, transfer};

/// A fold: axis across it (0 = x, 2 = z), place on it [m], total angle [rad], half width [m].
#[derive(Clone, Copy)]
pub struct Fold {
    pub axis: usize,
    pub at: f64,
    pub angle: f64,
    pub width: f64,
}

/// Where `fold-thrice` folds the T-shirt of 0.892 x 0.7 m.
pub const FOLDS: [Fold; 3] = [
    Fold { axis: 0, at: -0.178, angle: 1.2, width: 0.02 },
    Fold { axis: 0, at: 0.178, angle: -0.9, width: 0.02 },
    Fold { axis: 2, at: 0.0, angle: 0.7, width: 0.02 },
];

/// Sum of (change x length x (across)²) over the hinges of one layer near a fold, per length of the fold: the angle by which
/// the cloth turns there [rad]. Hinges count less and less towards the ends of the window: with a sharp end it would depend
/// on which side of it single hinges of other wrinkles fall.
pub fn total(sheet: &GarmentSurface, memory: &RestState, fold: &Fold, front: bool) -> f64 {
    turns(sheet, memory, fold, front).iter().sum()
}

/// The same of hinges that turn one way and of those that turn the other [rad]: cloth that was pressed flat beside a sharp crease
/// bends back there.
pub fn turns(sheet: &GarmentSurface, memory: &RestState, fold: &Fold, front: bool) -> [f64; 2] {
    let other = 2 - fold.axis;
    // Away from borders and from the other folds.
    let (middle, half) = if fold.axis == 0 { (0.15, 0.1) } else { (0.0, 0.1) };
    let reach = 4.0 * fold.width;
    let mut sum = [0.0; 2];
    for (h, hinge) in sheet.topology.hinges.iter().enumerate() {
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| sheet.points[p.at()]);
        let (centre, edge) = (0.5 * (a + b), b - a);
        let up = sheet.normal(hinge.triangles[0] as usize).y > 0.0;
        if up == front {
            let across = edge[other] / edge.norm();
            let window =
                flank((centre[fold.axis] - fold.at) / reach) * flank((centre[other] - middle) / half);
            let change = memory.rest_angle[h] - memory.source_angle[h];
            sum[usize::from(change < 0.0)] += window * change * edge.norm() * across * across;
        }
    }
    // The integral of the window along the fold.
    sum.map(|sum| sum / (1.5 * half))
}

/// 1 up to half of the way, then down to 0 at its end as a cosine.
fn flank(way: f64) -> f64 {
    0.5 + 0.5 * (std::f64::consts::PI * (2.0 * way.abs() - 1.0).clamp(0.0, 1.0)).cos()
}

/// Change of curvature of every triangle as (area, xx, zz, sqrt2 xz), from its hinges.
pub fn tensors(sheet: &GarmentSurface, memory: &RestState) -> Vec<[f64; 4]> {
    let one = |f: usize| {
        let area = 0.5 * sheet.normal(f).norm();
        let corners = sheet.corners(f);
        let mut out = [area, 0.0, 0.0, 0.0];
        for k in 0..3 {
            let edge = corners[(k + 1) % 3] - corners[k];
            let Some(h) = sheet.topology.edge_hinge[sheet.topology.triangle_edges[f][k] as usize] else {
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
    (0..sheet.triangles.len()).map(one).collect()
}

/// Correlation of the change of curvature over the surface of one mesh.
pub fn correlation(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    let dot = |a: &[[f64; 4]], b: &[[f64; 4]]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a[0] * (1..4).map(|c| a[c] * b[c]).sum::<f64>()).sum()
    };
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

pub fn carry(from: &GarmentSurface, memory: &RestState, to: &GarmentSurface, by: MatchBy) -> TransferResult {
    let source = TransferSource {
        file: "made".into(),
        surface: from.clone(),
        memory: memory.clone(),
        joints: Vec::new(),
    };
    let options = TransferOptions { match_by: by, ..TransferOptions::full(to.points.len()) };
    transfer(&[source], to, &options).expect("carries")
}
