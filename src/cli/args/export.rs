//! `--export`: files for other programs beside the main outputs.

use crate::args::values::{Choice, choice};
use crate::runtime::console;
use crease::internal::report::{Export, ExportCheck};

/// Files for other programs.
#[derive(Debug, Clone, clap::Args)]
pub struct ExportArgs {
    /// Files for other programs, comma-separated: worn shape as OBJ, rest mesh as OBJ, rest angles per vertex as GLB,
    /// USD scene
    #[arg(long, alias = "also", value_name = "LIST", value_delimiter = ',', value_parser = choice(&EXPORTS))]
    pub export: Vec<Export>,
}

/// Values of `--export`. Earlier scripts say `usda`.
const EXPORTS: [Choice<Export>; 4] = [
    ("obj", Export::Obj, ""),
    ("rest-mesh", Export::RestMesh, ""),
    ("rest-angle-map", Export::RestAngleMap, ""),
    ("usd|usda", Export::Usd, ""),
];

/// Prints the checks of exported files for people.
pub fn print_checks(checks: &[ExportCheck]) {
    for check in checks {
        console::message(&format!(
            "{}: {} differ by {:.3} {} RMS, {:.3} at most ({:.3} without the export)",
            check.file,
            check.compared,
            check.rms_difference,
            check.unit,
            check.largest_difference,
            check.rms_without
        ));
    }
}
