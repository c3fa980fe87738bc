//! `crease schema`: the JSON Schema of a file format, for editors and other programs.

use super::talk;
use clap::ValueEnum;
use crease::Result;
use crease::fabric::Fabric;
use crease::json::schema_of;
use crease::report::Report;
use crease::wear::WearScript;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Which format
    #[arg(value_enum, value_name = "FORMAT")]
    format: Format,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// Wear script, crease-wear/1
    Wear,
    /// Fabric, crease-fabric/1
    Fabric,
    /// Report of a bake, OUT.report.json
    Report,
}

pub fn run(arguments: Arguments) -> Result<()> {
    let schema = match arguments.format {
        Format::Wear => WearScript::schema(),
        Format::Fabric => Fabric::schema(),
        Format::Report => schema_of::<Report>(),
    };
    talk::data(&format!("{schema:#}\n"))
}
