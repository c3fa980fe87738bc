//! `crease render`: a picture of a worn garment, or of any mesh.
//!
//! It shows the worn surface in the source pose, with memory, from the sidecar beside the file, or else the shape and the attributes
//! of the file. Coordinates of an OBJ, such as a frame of a bake, are in metres, y up.

use crate::args::color_by::COLOR_BY;
use crate::args::mesh::ReferenceArgs;
use crate::args::values::{Choice, choice, png_path};
use crate::files::output::{Outputs, commit};
use crate::files::view_file::ViewFile;
use crate::runtime::console;
use crate::runtime::wording::ToolWords;
use clap::ArgAction;
use crease::internal::report::render::{Camera, CameraView, encode_apng, encode_png};
use crease::internal::report::{ColorBy, GarmentView};
use crease_model::error::Result;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease render worn.glb -o worn.png --before-after
  crease render worn.glb --show rest-angle-change -o angles.png
  crease render worn.glb --view back --focus memory -o close.png
  crease render worn.glb --turntable 36 -o turn.png")]
pub struct Arguments {
    /// Worn garment, as `crease bake` wrote it; for shape and curvature any .glb, .gltf, .obj or USD
    #[arg(value_name = "WORN.glb")]
    worn: PathBuf,
    /// Quantity that the colours show
    #[arg(long, value_parser = choice(&COLOR_BY), default_value = "shape")]
    show: ColorBy,
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
    /// Direction of the camera
    #[arg(long, value_parser = choice(&VIEWS), value_name = "SIDE", conflicts_with_all = ["azimuth", "elevation"])]
    view: Option<CameraView>,
    /// Part of the garment that fills the picture
    #[arg(long, value_parser = choice(&FOCUS), action = ArgAction::Set, value_name = "PART", default_value = "garment")]
    focus: bool,
    /// Draw the source shape and the worn shape side by side
    #[arg(long)]
    before_after: bool,
    /// Draw N pictures around the garment, as one animated PNG
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=999))]
    turntable: Option<u16>,
    #[command(flatten)]
    references: ReferenceArgs,
}

/// Values of `--view`.
const VIEWS: [Choice<CameraView>; 5] = [
    ("front", CameraView::Front, "In front of the garment"),
    ("back", CameraView::Back, "Behind it"),
    ("left", CameraView::Left, "On its left side"),
    ("right", CameraView::Right, "On its right side"),
    ("top", CameraView::Top, "Above it"),
];

/// Values of `--focus`: whether the memory fills the picture.
const FOCUS: [Choice<bool>; 2] =
    [("garment", false, "The whole garment"), ("memory", true, "Where most of its memory is")];

/// Seconds of a whole turn of a turntable.
const TURN_S: u16 = 4;

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new([arguments.worn.as_path()]);
    outputs.check(&arguments.output)?;
    let ViewFile { view, sidecar, .. } =
        ViewFile::read(&arguments.worn, arguments.references.allow_folder.as_deref())?;
    let (view, message) = match &sidecar {
        Some(sidecar) => view.with_worn_surface(sidecar),
        None => (view, None),
    };
    if let Some(message) = message {
        console::message(&format!("warning: {}", message.worded(&ToolWords)));
    }
    let width = usize::from(arguments.size);
    let size = [width, width * 3 / 4];
    let color_by = arguments.show;
    let camera = camera(&arguments, &view);
    let draw = |camera: &Camera| match arguments.before_after {
        true => view.draw_before_after(color_by, camera, size),
        false => view.draw(color_by, camera, size),
    };
    let bytes = match arguments.turntable {
        Some(count) => {
            let turned = |k: u16| {
                let azimuth = camera.azimuth_deg.unwrap_or(0.0) + 360.0 * f64::from(k) / f64::from(count);
                // A focus on one side is hidden from the other.
                draw(&Camera { azimuth_deg: Some(azimuth), focus: None, ..camera })
            };
            encode_apng(&(0..count).map(turned).collect::<Result<Vec<_>>>()?, count.div_ceil(TURN_S))?
        }
        None => encode_png(&draw(&camera)?)?,
    };
    outputs.add(&arguments.output, &bytes)?;
    commit(outputs)
}

/// Returns the camera that the arguments ask for.
fn camera(arguments: &Arguments, view: &GarmentView) -> Camera {
    let [azimuth, elevation] = match arguments.view {
        Some(side) => side.angles_deg().map(Some),
        None => [arguments.azimuth, arguments.elevation],
    };
    let camera = Camera { azimuth_deg: azimuth, elevation_deg: elevation, ..Camera::default() };
    match arguments.focus {
        false => camera,
        true => view.focus_on_memory(&camera),
    }
}
