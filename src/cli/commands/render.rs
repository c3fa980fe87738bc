//! `crease render`: a picture of a worn garment, or of any mesh.
//!
//! Shown is the garment's own pose with the worn shape on. The sidecar beside the file is asked first; without one,
//! the file's own attributes. Coordinates of an OBJ, such as a frame of a bake, are taken for metres, y up.

use crate::cli::args::common::{MeshReading, Metres, png_path};
use crate::cli::files::input;
use crate::cli::files::mesh_file::read_asset_at;
use crate::cli::files::output::Outputs;
use clap::ValueEnum;
use crease::io::gltf::{keep_worn_pieces, sidecar_name};
use crease::io::{Sidecar, read_sidecar};
use crease::report::render::{Camera, encode_png};
use crease::report::{ColorBy, GarmentView};
use crease::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease render worn.glb -o worn.png --before-after
  crease render worn.glb --show rest-angle-change -o angles.png
  crease render worn.glb --turntable 36 -o turn.png")]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it; for shape and curvature any .glb, .gltf or .obj
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// What the colours show
    #[arg(long, value_enum, default_value_t = ColorByArg::Shape)]
    show: ColorByArg,
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
    /// N pictures from all around instead of one: OUT_000.png, OUT_001.png ...
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=999))]
    turntable: Option<u16>,
}

/// What the colours of a picture show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorByArg {
    /// The shape alone, in one colour
    Shape,
    /// Change of the hinges' rest angle
    #[value(alias = "rest-angle")]
    RestAngleChange,
    /// Magnitude of curvature
    Curvature,
    /// Stiffness ratio
    Stiffness,
    /// Displacement from the garment's own shape
    Displacement,
    /// Growth of the rest lengths
    Stretch,
    /// After a transfer: how sure it is that the memory belongs there
    Confidence,
}

impl From<ColorByArg> for ColorBy {
    fn from(colours: ColorByArg) -> Self {
        match colours {
            ColorByArg::Shape => Self::Shape,
            ColorByArg::RestAngleChange => Self::RestAngleChange,
            ColorByArg::Curvature => Self::Curvature,
            ColorByArg::Stiffness => Self::Stiffness,
            ColorByArg::Displacement => Self::Displacement,
            ColorByArg::Stretch => Self::Stretch,
            ColorByArg::Confidence => Self::Confidence,
        }
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new([arguments.worn.as_path()]);
    let views = views(&arguments);
    for (path, _) in &views {
        outputs.check(path)?;
    }
    let garment_view = read(&arguments.worn)?.0;
    let width = usize::from(arguments.size);
    let size = [width, width * 3 / 4];
    let show = arguments.show.into();
    for (path, camera) in &views {
        let image = match arguments.before_after {
            true => garment_view.draw_before_after(show, camera, size)?,
            false => garment_view.draw(show, camera, size)?,
        };
        outputs.add(path, &encode_png(&image)?)?;
    }
    outputs.commit()
}

/// Every picture with the camera it is taken by.
fn views(arguments: &Arguments) -> Vec<(PathBuf, Camera)> {
    let camera =
        Camera { azimuth_deg: arguments.azimuth, elevation_deg: arguments.elevation, ..Camera::default() };
    let Some(count) = arguments.turntable else { return vec![(arguments.output.clone(), camera)] };
    let stem = arguments.output.with_extension("");
    let view = |k: u16| {
        let azimuth = arguments.azimuth.unwrap_or(0.0) + 360.0 * f64::from(k) / f64::from(count);
        let mut path = stem.clone().into_os_string();
        path.push(format!("_{k:03}.png"));
        (PathBuf::from(path), Camera { azimuth_deg: Some(azimuth), ..camera })
    };
    (0..count).map(view).collect()
}

/// What can be drawn of `path`, and its sidecar where it names one that lies beside it.
pub fn read(path: &Path) -> Result<(GarmentView, Option<Sidecar>)> {
    // The size of what is only looked at is not questioned.
    let reading = MeshReading { unit: Some(Metres(1.0)), up: None, garment: None };
    let (mut asset, _) = read_asset_at(path, &reading)?;
    let sidecar = asset.document.as_ref().and_then(sidecar_name).map(|name| path.with_file_name(name));
    match sidecar.filter(|path| path.is_file()) {
        Some(beside) => {
            let file = input::name_of(&beside);
            let sidecar = read_sidecar(&file, &input::bytes(&beside)?)?;
            keep_worn_pieces(&mut asset);
            if let Some(what) = sidecar.mesh_mismatch(&asset) {
                let cure = format!("put the sidecar that was written with {} beside it", path.display());
                return Err(Error::input(file, "mesh", what, cure));
            }
            Ok((GarmentView::of_sidecar(&input::name_of(path), &sidecar), Some(sidecar)))
        }
        None => Ok((GarmentView::of_asset(asset)?, None)),
    }
}
