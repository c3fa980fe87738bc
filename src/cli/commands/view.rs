//! `crease view`: worn garments as one page to turn, colour and compare; opened from the disk, without a network.

use crate::cli::args::common::{MeshReading, Metres, html_path};
use crate::cli::commands::render;
use crate::cli::commands::render::ColorByArg;
use crate::cli::files::input;
use crate::cli::files::mesh_file::read_asset_at;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crease::math::Vec3;
use crease::mesh::PointIndex;
use crease::report::{GarmentView, HingeLabel, ViewerItem, viewer_page};
use crease::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease view worn.glb -o worn.html
  crease view worn.glb -o worn.html --frames frames
  crease view denim.glb linen.glb -o both.html --show stiffness")]
pub struct Arguments {
    /// Worn garments, as `crease bake` wrote them, up to four beside each other; also any .glb, .gltf or .obj
    #[arg(value_name = "WORN.glb", required = true, num_args = 1..=4)]
    worn: Vec<PathBuf>,
    /// Page to write
    #[arg(short, long, value_name = "OUT.html", value_parser = html_path)]
    output: PathBuf,
    /// Colours it opens with
    #[arg(long, value_enum, default_value_t = ColorByArg::RestAngleChange)]
    show: ColorByArg,
    /// Folder of the frames of the bake (the first garment's): adds a timeline
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Maximum number of frames embedded; longer sequences are subsampled
    #[arg(long, alias = "most-frames", value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..=1000))]
    max_frames: u16,
}

pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new(arguments.worn.iter().map(PathBuf::as_path));
    outputs.check(&arguments.output)?;
    let mut items = arguments.worn.iter().map(|path| item(path)).collect::<Result<Vec<_>>>()?;
    let mut names = Vec::new();
    if let (Some(folder), Some(first)) = (&arguments.frames, items.first_mut()) {
        let Shots { positions, names: shown, triangles } = frames(folder, arguments.max_frames.into())?;
        names = shown;
        if positions.iter().all(|x| x.len() == first.garment_view.before.len()) {
            first.frames = positions;
        } else {
            // Of the mesh that was simulated, which had fewer points: it stands beside the garment.
            items.insert(1, simulated(folder, positions, triangles));
        }
    }
    let page = viewer_page(&items, arguments.show.into(), &names);
    outputs.add(&arguments.output, page.as_bytes())?;
    outputs.commit()?;
    console::say(&format!("{}: {:.1} MB", input::name_of(&arguments.output), page.len() as f64 / 1e6));
    Ok(())
}

fn item(path: &Path) -> Result<ViewerItem> {
    let (garment_view, sidecar) = render::read(path)?;
    let hinges = sidecar.as_ref().map_or_else(Vec::new, HingeLabel::all_of);
    let name =
        path.file_name().map_or_else(|| input::name_of(path), |name| name.to_string_lossy().into_owned());
    Ok(ViewerItem { name, garment_view, hinges, frames: Vec::new() })
}

/// Frames of a run.
struct Shots {
    /// Per frame: one position per point [m].
    positions: Vec<Vec<Vec3>>,
    names: Vec<String>,
    triangles: Vec<[PointIndex; 3]>,
}

/// The mesh of frames: as it began, and as it ended.
fn simulated(folder: &Path, frames: Vec<Vec<Vec3>>, triangles: Vec<[PointIndex; 3]>) -> ViewerItem {
    let file = input::name_of(folder);
    let [before, after] = [frames.first(), frames.last()].map(|x| x.cloned().unwrap_or_default());
    let garment_view = GarmentView { file, before, after, triangles, memory: None, confidence: None };
    ViewerItem { name: "simulated".to_owned(), garment_view, hinges: Vec::new(), frames }
}

/// The frames in `folder`, evenly thinned to at most `most`.
fn frames(folder: &Path, most: usize) -> Result<Shots> {
    let path = |number: usize| folder.join(format!("frame_{number:04}.obj"));
    let count = (0..).take_while(|&number| path(number).is_file()).count();
    if count == 0 {
        let cure = "give the folder that `crease bake --frames DIR` wrote";
        return Err(Error::input(input::name_of(folder), "", "has no frame_0000.obj", cure));
    }
    let step = count.div_ceil(most);
    let mut shots = Shots { positions: Vec::new(), names: Vec::new(), triangles: Vec::new() };
    for number in (0..count).step_by(step) {
        let reading = MeshReading { unit: Some(Metres(1.0)), up: None, garment: None };
        let (asset, _) = read_asset_at(&path(number), &reading)?;
        let (mut x, mut triangles) = (Vec::new(), Vec::new());
        for piece in asset.pieces {
            let first = x.len() as u32;
            x.extend(piece.positions);
            triangles.extend(piece.triangles.iter().map(|t| t.map(|v| PointIndex(v + first))));
        }
        if number == 0 {
            shots.triangles = triangles;
        } else if x.len() != shots.positions[0].len() || triangles != shots.triangles {
            let what = "is of another mesh than frame_0000.obj";
            let cure = "give the frames of one bake";
            return Err(Error::input(input::name_of(&path(number)), "", what, cure));
        }
        shots.positions.push(x);
        shots.names.push(format!("{number}"));
    }
    Ok(shots)
}
