//! `crease render`: a picture of a worn garment, or of any mesh.
//!
//! It shows the worn shape in the source pose, with memory from the sidecar beside the file, or else from the attributes
//! of the file. Coordinates of an OBJ, such as a frame of a bake, are in metres, y up.

use crate::cli::args::color_by::ColorByArg;
use crate::cli::args::values::png_path;
use crate::cli::files::output::Outputs;
use crate::cli::files::view_file::ViewFile;
use crease::Result;
use crease::report::render::{Camera, encode_png};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease render worn.glb -o worn.png --before-after
  crease render worn.glb --show rest-angle-change -o angles.png
  crease render worn.glb --turntable 36 -o turn.png")]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it; for shape and curvature any .glb, .gltf or .obj
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// Quantity that the colours show
    #[arg(long, value_enum, default_value_t = ColorByArg::Shape)]
    show: ColorByArg,
    /// Picture to write
    #[arg(short, long, value_name = "OUT.png", value_parser = png_path)]
    output: PathBuf,
    /// Width of the picture in pixels; its height is three quarters of that
    #[arg(long, value_name = "PIXELS", default_value_t = 1024, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    /// Azimuth of the camera [degrees]: 0 in front, 90 on the garment's left side [default: 0]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    azimuth: Option<f64>,
    /// Elevation of the camera [degrees; default: from above if the garment lies flat, else from the front]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    elevation: Option<f64>,
    /// Draw the source shape and the worn shape side by side
    #[arg(long)]
    before_after: bool,
    /// Draw N pictures around the garment instead of one: OUT_000.png, OUT_001.png, ...
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=999))]
    turntable: Option<u16>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new([arguments.worn.as_path()]);
    let pictures = pictures(&arguments);
    for (path, _) in &pictures {
        outputs.check(path)?;
    }
    let view = ViewFile::read(&arguments.worn)?.view;
    let width = usize::from(arguments.size);
    let size = [width, width * 3 / 4];
    let color_by = arguments.show.into();
    for (path, camera) in &pictures {
        let image = match arguments.before_after {
            true => view.draw_before_after(color_by, camera, size)?,
            false => view.draw(color_by, camera, size)?,
        };
        outputs.add(path, &encode_png(&image)?)?;
    }
    outputs.commit()
}

/// Returns the path and camera of every picture.
fn pictures(arguments: &Arguments) -> Vec<(PathBuf, Camera)> {
    let camera =
        Camera { azimuth_deg: arguments.azimuth, elevation_deg: arguments.elevation, ..Camera::default() };
    let Some(count) = arguments.turntable else { return vec![(arguments.output.clone(), camera)] };
    let stem = arguments.output.with_extension("");
    let picture = |k: u16| {
        let azimuth = arguments.azimuth.unwrap_or(0.0) + 360.0 * f64::from(k) / f64::from(count);
        let mut path = stem.clone().into_os_string();
        path.push(format!("_{k:03}.png"));
        (PathBuf::from(path), Camera { azimuth_deg: Some(azimuth), ..camera })
    };
    (0..count).map(picture).collect()
}
