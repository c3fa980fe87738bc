//! `crease inspect`: what is in a mesh file, what would be repaired, what would be refused.

use super::arguments::MeshReading;
use super::input;
use crease::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Mesh file: .obj, .gltf or .glb
    mesh: PathBuf,
    #[command(flatten)]
    reading: MeshReading,
    /// Findings as JSON
    #[arg(long)]
    json: bool,
}

/// What `crease inspect` was asked for.
#[derive(Debug)]
pub struct InspectOptions {
    /// The mesh file.
    pub mesh: PathBuf,
    /// How its coordinates are to be read.
    pub reading: MeshReading,
    /// Findings as JSON instead of words.
    pub json: bool,
}

pub fn run(arguments: Arguments) -> Result<()> {
    let Arguments { mesh, reading, json } = arguments;
    inspect(InspectOptions { mesh, reading, json })
}

/// The boundary to the library.
fn inspect(options: InspectOptions) -> Result<()> {
    let _bytes = input::bytes(&options.mesh)?;
    Err(super::not_wired("inspect"))
}
