//! `crease render`: a picture of a worn garment, or of any mesh.
//!
//! Shown is the garment's own pose with the worn shape on. The sidecar beside the file is asked first; without one,
//! the file's own attributes. Coordinates of an OBJ, such as a frame of a bake, are taken for metres, y up.

use super::arguments::{MeshReading, Metres, png_path};
use super::input;
use super::mesh_file::read_asset_at;
use super::output::Outputs;
use clap::ValueEnum;
use crease::format::gltf::{keep_worn_pieces, sidecar_name};
use crease::format::read_sidecar;
use crease::report::render::{Camera, encode_png};
use crease::report::{Portrait, Show};
use crease::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it; for shape and curvature any .glb, .gltf or .obj
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// What the colours show
    #[arg(long, value_enum, default_value_t = Colours::Shape)]
    show: Colours,
    /// Picture to write
    #[arg(short, long, value_name = "OUT.png", value_parser = png_path)]
    output: PathBuf,
    /// Width of the picture in pixels; its height is three quarters of that
    #[arg(long, value_name = "PIXELS", default_value_t = 1024, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    /// Where to look from, around the vertical [degrees]: 0 from the front, 90 from the wearer's left [default: 0]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    azimuth: Option<f64>,
    /// How far above the horizon to look from [degrees; default: from above if the garment lies, else from the front]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    elevation: Option<f64>,
    /// Its own shape and the worn one beside each other
    #[arg(long)]
    before_after: bool,
}

/// What the colours of a picture show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Colours {
    /// The shape alone, in one colour
    Shape,
    /// Change of the hinges' rest angle
    RestAngle,
    /// Magnitude of curvature
    Curvature,
    /// Stiffness ratio
    Stiffness,
    /// Displacement from the garment's own shape
    Displacement,
    /// After a transfer: how sure it is that the memory belongs there
    Confidence,
}

impl From<Colours> for Show {
    fn from(colours: Colours) -> Self {
        match colours {
            Colours::Shape => Self::Shape,
            Colours::RestAngle => Self::RestAngle,
            Colours::Curvature => Self::Curvature,
            Colours::Stiffness => Self::Stiffness,
            Colours::Displacement => Self::Displacement,
            Colours::Confidence => Self::Confidence,
        }
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new([arguments.worn.as_path()]);
    outputs.check(&arguments.output)?;
    let portrait = portrait(&arguments.worn)?;
    let camera =
        Camera { azimuth_deg: arguments.azimuth, elevation_deg: arguments.elevation, ..Camera::default() };
    let width = usize::from(arguments.size);
    let size = [width, width * 3 / 4];
    let show = arguments.show.into();
    let image = match arguments.before_after {
        true => portrait.draw_before_after(show, &camera, size)?,
        false => portrait.draw(show, &camera, size)?,
    };
    outputs.add(&arguments.output, &encode_png(&image)?)?;
    outputs.commit()
}

fn portrait(path: &Path) -> Result<Portrait> {
    // The size of what is only looked at is not questioned.
    let reading = MeshReading { unit: Some(Metres(1.0)), up: None, garment: None };
    let (mut asset, _) = read_asset_at(path, &reading)?;
    let sidecar = asset.document.as_ref().and_then(sidecar_name).map(|name| path.with_file_name(name));
    match sidecar.filter(|path| path.is_file()) {
        Some(beside) => {
            let file = input::name_of(&beside);
            let sidecar = read_sidecar(&file, &input::bytes(&beside)?)?;
            keep_worn_pieces(&mut asset);
            if let Some(what) = sidecar.misfit(&asset) {
                let cure = format!("put the sidecar that was written with {} beside it", path.display());
                return Err(Error::fault(file, "mesh", what, cure));
            }
            Ok(Portrait::of_sidecar(&input::name_of(path), &sidecar))
        }
        None => Portrait::of_asset(asset),
    }
}
