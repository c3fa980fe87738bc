//! `OUT.report.json` of a transfer: what was carried, how sure that is, and what was lost.
//!
//! Plain data, as the report of a bake; names that both have mean the same.

use crate::report::{DetailReport, ExportCheck};
use crate::transfer::{GarmentSurface, RegionConfidence, TransferLosses, TransferResult};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The report of one transfer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "crease transfer report")]
pub struct TransferReport {
    /// Time the run took [s].
    pub wall_s: f64,
    /// Welded points of the target.
    pub points: usize,
    /// Triangles of the target.
    pub triangles: usize,
    /// Pairs of triangles that intersect in the result and did not at the start.
    pub crossings: usize,
    /// Pairs of triangles that intersect in the target already.
    pub crossings_at_start: usize,
    /// Largest magnitude of a change of rest angle [degrees].
    #[serde(alias = "max_rest_angle_deg")]
    pub max_rest_angle_change_deg: f64,
    /// Largest stiffness ratio [-]; 1 is new cloth.
    pub max_stiffness_ratio: f64,
    /// Mean confidence over the cloth, 0 to 1.
    pub confidence: f64,
    /// Confidence by region.
    pub regions: Vec<RegionConfidence>,
    /// One per sidecar, in the order given.
    pub sources: Vec<CarriedSource>,
    /// Normal maps of fine wrinkles; left out without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detail_maps: Vec<DetailReport>,
    /// Files of `--export`, compared after reading them back; omitted if there are none.
    #[serde(default, rename = "also", alias = "exports", skip_serializing_if = "Vec::is_empty")]
    pub exports: Vec<ExportCheck>,
    /// What the user should know of, in words.
    pub warnings: Vec<String>,
}

/// One sidecar of a transfer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CarriedSource {
    /// The sidecar as the user named it.
    pub file: String,
    /// How places were matched: `same`, `uv` or `surface`.
    pub by: String,
    /// MatchBy what the source was laid over the target before: `place`, `landmarks`, `joints` or `box`. Left out where numbers went
    /// over one by one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aligned: Option<String>,
    /// What was lost.
    #[serde(flatten)]
    pub losses: TransferLosses,
}

impl TransferReport {
    /// What `carried`, which lies on `target`, has to tell; counts, sources and times are the caller's.
    pub fn of_transfer(carried: &TransferResult, target: &GarmentSurface) -> Self {
        let memory = &carried.memory;
        let changes = memory.rest_angle.iter().zip(&memory.source_angle).map(|(rest, source)| rest - source);
        let areas = (0..target.triangles.len()).map(|f| target.normal(f).norm());
        let (sum, area) =
            areas.zip(&carried.confidence).fold((0.0, 0.0), |(sum, area), (a, c)| (sum + a * c, area + a));
        Self {
            max_rest_angle_change_deg: changes.map(f64::abs).fold(0.0, f64::max).to_degrees(),
            max_stiffness_ratio: memory.stiffness_ratio.iter().copied().fold(1.0, f64::max),
            confidence: if area > 0.0 { sum / area } else { 0.0 },
            regions: carried.regions.clone(),
            ..Self::default()
        }
    }

    /// As a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers and texts: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
