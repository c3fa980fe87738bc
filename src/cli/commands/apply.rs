//! `crease apply`: the worn shape of a baked file as its base shape, what `--apply` of a bake does.

use crate::args::values::glb_path;
use crate::files::input;
use crate::files::output::{Outputs, commit};
use crease_io::gltf::{SourceShape, apply_worn};
use crease_model::error::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease apply worn.glb -o game.glb
  crease apply worn.glb -o game.glb --no-unworn")]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it, or - for the standard input
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// Garment to write, whose base shape is the worn one; - for the standard output
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// Leave the source shape out, which else becomes the morph target `unworn`
    #[arg(long)]
    no_unworn: bool,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new([arguments.worn.as_path()]);
    outputs.check(&arguments.output)?;
    let source = if arguments.no_unworn { SourceShape::Dropped } else { SourceShape::Target };
    let worn = input::bytes(&arguments.worn)?;
    let applied = apply_worn(&input::name_of(&arguments.worn), &worn, source)?;
    outputs.add(&arguments.output, &applied)?;
    commit(outputs)
}
