//! `crease schema`: JSON Schema of a file format, for editors and other programs.

use crate::commands::batch::JobFile;
use crate::runtime::console;
use clap::ValueEnum;
use crease::internal::report::{Report, TransferReport};
use crease::internal::wear::WearScript;
use crease_io::{Landmarks, Sidecar};
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::json::schema_of;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease schema wear > wear.schema.json")]
pub struct Arguments {
    /// File format
    #[arg(value_enum, value_name = "FORMAT")]
    format: Format,
}

/// File formats with a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// Wear script, crease-wear/1
    Wear,
    /// Fabric, crease-fabric/1
    Fabric,
    /// Sidecar, crease-sidecar/1
    Sidecar,
    /// Report of a bake, OUT.report.json
    Report,
    /// Report of a transfer, OUT.report.json
    TransferReport,
    /// Job file of `crease batch`, crease-batch/1
    Batch,
    /// Landmark file of `crease transfer`, crease-landmarks/1
    Landmarks,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let schema = match arguments.format {
        Format::Wear => WearScript::schema(),
        Format::Fabric => Fabric::schema(),
        Format::Sidecar => schema_of::<Sidecar>(),
        Format::Batch => JobFile::schema(),
        Format::Landmarks => Landmarks::schema(),
        Format::TransferReport => schema_of::<TransferReport>(),
        Format::Report => schema_of::<Report>(),
    };
    console::data(&format!("{schema:#}\n"))
}
