//! How sure a transfer is, region by region, and what it left behind.
//!
//! A region is a ninth of the box seen from the front (left, middle, right by upper, middle, lower), front and back apart:
//! names that suit any garment and that a user can check by looking. Left and right are the wearer's.

use crate::garment::RestState;
use crate::math::bounds;
use crate::transfer::GarmentSurface;
use crate::transfer::resample::Gathered;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Confidence of one region of the target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Region")]
pub struct RegionConfidence {
    /// Where: "upper left front", ...
    pub name: String,
    /// Its cloth [m²].
    pub area_m2: f64,
    /// Mean over its cloth, 0..1.
    pub confidence: f64,
}

/// What one source lost on the way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TransferLosses {
    /// Share of the target's cloth that found no place on the source.
    #[serde(alias = "target_without_source")]
    pub unmatched_target_fraction: f64,
    /// Share of the source's crease (angle times length) on cloth that no place of the target landed on.
    #[serde(alias = "crease_left_behind")]
    pub lost_crease_fraction: f64,
}

/// Least confidence of the regions of `standing`, which has one confidence per triangle.
pub(super) fn regions(standing: &GarmentSurface, confidence: &[f64]) -> Vec<RegionConfidence> {
    let (low, high) = bounds(&standing.points);
    let outward = standing.outward();
    let third =
        |x: f64, low: f64, high: f64| (3.0 * (x - low) / (high - low).max(1e-9)).clamp(0.0, 2.0) as usize;
    let mut sums = [[0.0; 2]; 18];
    for (f, own) in confidence.iter().enumerate() {
        let middle = standing.corners(f).iter().sum::<crate::math::Vec3>() / 3.0;
        let normal = standing.normal(f);
        let back = usize::from(outward * normal.z < 0.0);
        let row = 2 - third(middle.y, low.y, high.y);
        let slot = &mut sums[6 * row + 2 * (2 - third(middle.x, low.x, high.x)) + back];
        let area = 0.5 * normal.norm();
        *slot = [slot[0] + area, slot[1] + area * own];
    }
    let mut all = Vec::new();
    for (r, row) in ["upper", "middle", "lower"].iter().enumerate() {
        for (c, column) in ["left", "middle", "right"].iter().enumerate() {
            for (s, side) in ["front", "back"].iter().enumerate() {
                let [area, sum] = sums[6 * r + 2 * c + s];
                if area > 0.0 {
                    let name = format!("{row} {column} {side}");
                    all.push(RegionConfidence { name, area_m2: area, confidence: sum / area });
                }
            }
        }
    }
    all
}

/// What was lost between `source` and `target`.
pub(super) fn losses(
    source: &GarmentSurface,
    memory: &RestState,
    target: &GarmentSurface,
    gathered: &[Gathered],
) -> TransferLosses {
    let mut reached = vec![false; source.triangles.len()];
    let (mut area, mut without) = (0.0, 0.0);
    for (f, one) in gathered.iter().enumerate() {
        let own = target.normal(f).norm();
        area += own;
        without += own * (1.0 - one.found);
        one.landed.iter().for_each(|&s| reached[s as usize] = true);
    }
    let (mut crease, mut behind) = (0.0, 0.0);
    for (h, hinge) in source.topology.hinges.iter().enumerate() {
        let length = (source.points[hinge.points[1].at()] - source.points[hinge.points[0].at()]).norm();
        let own = (memory.rest_angle[h] - memory.source_angle[h]).abs() * length;
        crease += own;
        if !hinge.triangles.iter().any(|&f| reached[f as usize]) {
            behind += own;
        }
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    TransferLosses {
        unmatched_target_fraction: share(without, area),
        lost_crease_fraction: share(behind, crease),
    }
}
