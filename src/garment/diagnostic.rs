//! What the importer noticed about a mesh, for `inspect` and for the report.

use serde::Serialize;

/// How serious a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Was, or would be, repaired on import.
    Repaired,
    /// Cannot be used: the garment is refused.
    Refused,
}

/// One thing noticed about an imported mesh.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ImportDiagnostic {
    /// How serious.
    pub severity: Severity,
    /// Where in the file (line, element), or empty.
    #[serde(rename = "place")]
    pub location: String,
    /// What was noticed, and the cure where there is one.
    #[serde(rename = "what")]
    pub message: String,
}
