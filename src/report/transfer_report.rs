//! `OUT.report.json` of a transfer: transferred memory, its confidence, and losses.
//!
//! Plain data. Names that it has in common with the report of a bake mean the same.

use crate::report::detail_report::DetailReport;
use crate::report::export::ExportCheck;
use crate::report::fine_report::{FineReport, WrittenFile};
use crate::report::report_file::ShownReport;
use crate::transfer::{RegionConfidence, TransferLosses, TransferResult, mean_confidence};
use crease_model::remesh::GarmentSurface;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Report of one transfer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "crease transfer report")]
pub struct TransferReport {
    /// Wall time of the run [s].
    pub wall_s: f64,
    /// Welded points of the target.
    pub points: usize,
    /// Triangles of the target.
    pub triangles: usize,
    /// Pairs of triangles that intersect in the result but not in the target.
    pub crossings: usize,
    /// Pairs of triangles that intersect in the target.
    pub crossings_at_start: usize,
    /// All pairs of triangles that intersect in the result, those of the target among them.
    #[serde(default)]
    pub crossings_in_result: usize,
    /// Maximum magnitude of the change of rest angle [degrees].
    #[serde(alias = "max_rest_angle_deg")]
    pub max_rest_angle_change_deg: f64,
    /// Maximum stiffness ratio [-]; 1 for new cloth.
    pub max_stiffness_ratio: f64,
    /// What the worn shape shows.
    #[serde(default)]
    pub shown: ShownReport,
    /// Area-weighted mean confidence, 0 to 1.
    pub confidence: f64,
    /// Confidence per region.
    pub regions: Vec<RegionConfidence>,
    /// One entry per sidecar, in the order of the command line.
    pub sources: Vec<CarriedSource>,
    /// Normal maps of fine wrinkles; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detail_maps: Vec<DetailReport>,
    /// Finer mesh of `--fine`; omitted if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fine: Option<FineReport>,
    /// Files that were written beside the report, with their sizes; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<WrittenFile>,
    /// Files of `--export`, compared after reading them back; omitted if there are none.
    #[serde(default, rename = "also", alias = "exports", skip_serializing_if = "Vec::is_empty")]
    pub exports: Vec<ExportCheck>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// One sidecar of a transfer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CarriedSource {
    /// Sidecar as the user named it.
    pub file: String,
    /// Matching of points: `same`, `uv` or `surface`.
    pub by: String,
    /// Alignment of the source with the target: `place` (none), `landmarks`, `joints`, `texture`, `openings` or `box`. Omitted where points were
    /// matched by number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aligned: Option<String>,
    /// Losses of the transfer.
    #[serde(flatten)]
    pub losses: TransferLosses,
}

impl TransferReport {
    /// Creates the report of the transfer `carried` to `target`. The caller adds counts, sources and times.
    pub fn of_transfer(carried: &TransferResult, target: &GarmentSurface) -> Self {
        let memory = &carried.memory;
        Self {
            max_rest_angle_change_deg: memory.angle_changes().map(f64::abs).fold(0.0, f64::max).to_degrees(),
            max_stiffness_ratio: memory.stiffness_ratio.iter().copied().fold(1.0, f64::max),
            confidence: mean_confidence(target, &carried.confidence),
            regions: carried.regions.clone(),
            ..Self::default()
        }
    }

    /// Returns the report file: indented JSON with a final line break.
    pub fn to_json(&self) -> String {
        // Plain numbers and strings can always be serialised.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
