//! `crease render`: a picture of a worn garment.

use super::arguments::png_path;
use super::input;
use super::output::Outputs;
use clap::ValueEnum;
use crease::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// What the colours show
    #[arg(long, value_enum, default_value_t = Show::Shape)]
    show: Show,
    /// Picture to write
    #[arg(short, long, value_name = "OUT.png", value_parser = png_path)]
    output: PathBuf,
}

/// What the colours of a picture show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// The shape alone, in one colour
    Shape,
    /// Rest angle of the hinges
    RestAngle,
    /// Mean curvature
    Curvature,
    /// Stiffness ratio
    Stiffness,
    /// Displacement from the garment's own shape
    Displacement,
}

/// What `crease render` was asked for.
#[derive(Debug)]
pub struct RenderOptions {
    /// The worn garment.
    pub worn: PathBuf,
    /// What the colours show.
    pub show: Show,
    /// The picture.
    pub output: PathBuf,
}

pub fn run(arguments: Arguments) -> Result<()> {
    let Arguments { worn, show, output } = arguments;
    render(RenderOptions { worn, show, output })
}

/// The boundary to the library.
fn render(options: RenderOptions) -> Result<()> {
    let _bytes = input::bytes(&options.worn)?;
    Outputs::new([options.worn.as_path()]).check(&options.output)?;
    let _ = options.show;
    Err(super::not_wired("render"))
}
