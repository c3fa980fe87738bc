//! `crease inspect`: what is in a mesh file, what would be repaired, what would be refused.

use crate::cli::args::common::MeshReading;
use crate::cli::files::mesh_file::MeshFile;
use crate::cli::runtime::console;
use crease::Result;
use crease::mesh::intersections::self_intersections;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease inspect shirt.obj --unit cm
  crease inspect shirt.glb --json")]
pub struct Arguments {
    /// Mesh file: .obj, .gltf or .glb
    mesh: PathBuf,
    #[command(flatten)]
    reading: MeshReading,
    /// Findings as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: Arguments) -> Result<()> {
    let MeshFile { asset, garment, findings } = MeshFile::read(&arguments.mesh, &arguments.reading)?;
    let mut inspection = crease::garment::inspect(&asset, &garment, &findings);
    inspection.crossings_at_start = Some(self_intersections(&garment.points, &garment.triangles).len());
    match arguments.json {
        true => console::data(&format!("{:#}\n", json!(inspection))),
        false => console::data(&inspection.to_text()),
    }
}
