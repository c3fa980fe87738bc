//! `crease inspect`: content of a mesh file, with the repairs and errors that a bake would report.

use crate::args::mesh::MeshArgs;
use crate::runtime::console;
use crate::runtime::wording::ToolWords;
use crease::internal::files::GarmentFile;
use crease_geometry::mesh::intersections::self_intersections;
use crease_io::gltf::file_contents;
use crease_io::{ReadOptions, check_size};
use crease_model::error::Result;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease inspect shirt.obj --unit cm
  crease inspect shirt.glb --json")]
pub struct Arguments {
    /// Mesh file: .obj, .gltf, .glb or USD (.usda, .usdc, .usd, .usdz); - for the standard input
    mesh: PathBuf,
    #[command(flatten)]
    reading: MeshArgs,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command. What does not depend on the unit is shown of a file of a wrong size, too, before that is an error.
pub fn run(arguments: Arguments) -> Result<()> {
    let options = arguments.reading.options();
    let any_size = ReadOptions { any_size: true, ..options.clone() };
    let GarmentFile { asset, garment, diagnostics: mut findings } =
        GarmentFile::load(&arguments.mesh, &any_size)?;
    let size = if options.any_size { Ok(None) } else { check_size(&asset) };
    findings.extend(size.as_ref().ok().cloned().flatten());
    let mut inspection = crease_model::garment::inspect(&asset, &garment, &findings).worded(&ToolWords);
    inspection.contents = file_contents(&asset)?;
    inspection.crossings_at_start = Some(self_intersections(&garment.points, &garment.triangles).len());
    match arguments.json {
        true => console::data(&format!("{:#}\n", json!(inspection))),
        false => console::data(&inspection.to_text()),
    }?;
    size.map(|_| ())
}
