//! Confidence of a transfer by region, and what was lost.
//!
//! A region is a ninth of the box in front view (left, middle, right by upper, middle, lower), front and back apart: names
//! that suit any garment and that a user can check by looking. Left and right are those of the person who wears it.

use crease_geometry::math::bounds;
use crease_model::garment::RestState;
use crease_model::remesh::{GarmentSurface, ResampledFace};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Confidence of one region of the target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Region")]
pub struct RegionConfidence {
    /// Name of the region: "upper left front", ...
    pub name: String,
    /// Area of its cloth [m²].
    pub area_m2: f64,
    /// Mean over its cloth, 0..1.
    pub confidence: f64,
}

/// Losses of one source.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TransferLosses {
    /// Fraction of the target's cloth without a match on the source.
    #[serde(rename = "target_without_source", alias = "unmatched_target_fraction")]
    pub unmatched_target_fraction: f64,
    /// Fraction of the source's crease (angle times length) on cloth that no point of the target is matched with.
    #[serde(rename = "crease_left_behind", alias = "lost_crease_fraction")]
    pub lost_crease_fraction: f64,
}

const ROWS: [&str; 3] = ["upper", "middle", "lower"];
const COLUMNS: [&str; 3] = ["left", "middle", "right"];
const SIDES: [&str; 2] = ["front", "back"];

/// Sums over the cloth of one region.
#[derive(Clone, Copy, Default)]
struct RegionSum {
    area: f64,
    /// Confidence times area.
    confidence: f64,
}

/// Confidence of the regions of `canonical`, a target in its canonical pose, from one confidence per triangle.
pub(super) fn confidence_by_region(canonical: &GarmentSurface, confidence: &[f64]) -> Vec<RegionConfidence> {
    let (low, high) = bounds(&canonical.points);
    let outward = canonical.orientation_sign();
    let third =
        |x: f64, low: f64, high: f64| (3.0 * (x - low) / (high - low).max(1e-9)).clamp(0.0, 2.0) as usize;
    let mut sums = [[[RegionSum::default(); SIDES.len()]; COLUMNS.len()]; ROWS.len()];
    for (f, own) in confidence.iter().enumerate() {
        let centroid = canonical.centroid(f);
        let normal = canonical.normal(f);
        let back = usize::from(outward * normal.z < 0.0);
        let row = 2 - third(centroid.y, low.y, high.y);
        let sum = &mut sums[row][2 - third(centroid.x, low.x, high.x)][back];
        let area = 0.5 * normal.norm();
        sum.area += area;
        sum.confidence += area * own;
    }
    let mut regions = Vec::new();
    for (row, columns) in ROWS.iter().zip(&sums) {
        for (column, sides) in COLUMNS.iter().zip(columns) {
            for (side, sum) in SIDES.iter().zip(sides) {
                if sum.area > 0.0 {
                    let name = format!("{row} {column} {side}");
                    let confidence = sum.confidence / sum.area;
                    regions.push(RegionConfidence { name, area_m2: sum.area, confidence });
                }
            }
        }
    }
    regions
}

/// Area-weighted mean of one `confidence` per triangle of `target`; 0 without area.
pub(crate) fn mean_confidence(target: &GarmentSurface, confidence: &[f64]) -> f64 {
    let areas = (0..target.triangles.len()).map(|f| target.normal(f).norm());
    let (sum, area) = areas.zip(confidence).fold((0.0, 0.0), |(sum, area), (a, c)| (sum + a * c, area + a));
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Losses between `source` with its `memory` and `target`, which received `faces`.
pub(super) fn transfer_losses(
    source: &GarmentSurface,
    memory: &RestState,
    target: &GarmentSurface,
    faces: &[ResampledFace],
) -> TransferLosses {
    let mut matched = vec![false; source.triangles.len()];
    let (mut area, mut unmatched) = (0.0, 0.0);
    for (f, face) in faces.iter().enumerate() {
        let own = target.normal(f).norm();
        area += own;
        unmatched += own * (1.0 - face.matched_fraction);
        face.source_triangles.iter().for_each(|&s| matched[s as usize] = true);
    }
    let (mut crease, mut lost) = (0.0, 0.0);
    for (h, hinge) in source.topology.hinges.iter().enumerate() {
        let length = (source.points[hinge.points[1].at()] - source.points[hinge.points[0].at()]).norm();
        let own = (memory.rest_angle[h] - memory.source_angle[h]).abs() * length;
        crease += own;
        if !hinge.triangles.iter().any(|&f| matched[f as usize]) {
            lost += own;
        }
    }
    let fraction = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    TransferLosses {
        unmatched_target_fraction: fraction(unmatched, area),
        lost_crease_fraction: fraction(lost, crease),
    }
}
