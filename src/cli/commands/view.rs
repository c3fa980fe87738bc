//! `crease view`: an interactive page of worn garments in one self-contained file.

use crate::args::color_by::COLOR_BY;
use crate::args::mesh::ReferenceArgs;
use crate::args::values::{choice, html_path};
use crate::files::input;
use crate::files::output::{Outputs, commit};
use crate::files::view_file::ViewFile;
use crate::runtime::console;
use crate::runtime::wording::ToolWords;
use crease::internal::files::{GarmentFile, embed_asset_images, output_name, read_asset_file};
use crease::internal::report::{
    ColorBy, GarmentView, HingeLabel, ViewerItem, ViewerPiece, fine_worn_glb, own_triangles_message,
    viewer_page,
};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_io::ReadOptions;
use crease_io::gltf::plain_glb;
use crease_model::error::{Error, Result};
use crease_model::garment::MeshOptions;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease view worn.glb -o worn.html
  crease view worn.glb -o worn.html --frames frames
  crease view denim.glb linen.glb -o both.html --show stiffness")]
pub struct Arguments {
    /// Up to four worn garments, as written by `crease bake`, shown side by side; also any .glb, .gltf, .obj or USD
    #[arg(value_name = "WORN.glb", required = true, num_args = 1..=4)]
    worn: Vec<PathBuf>,
    /// Page to write
    #[arg(short, long, value_name = "OUT.html", value_parser = html_path)]
    output: PathBuf,
    /// Quantity that the colours show when the page opens
    #[arg(long, value_parser = choice(&COLOR_BY), default_value = "rest-angle-change")]
    show: ColorBy,
    /// Folder of the frames of the bake of the first garment; adds a timeline
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Maximum number of frames embedded; longer sequences are subsampled
    #[arg(long, alias = "most-frames", value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u16).range(1..=1000))]
    max_frames: u16,
    #[command(flatten)]
    references: ReferenceArgs,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let mut outputs = Outputs::new(arguments.worn.iter().map(PathBuf::as_path));
    outputs.check(&arguments.output)?;
    let reading = ReadOptions { allow_folder: arguments.references.allow_folder, ..ReadOptions::default() };
    let allow_folder = reading.allow_folder.as_deref();
    let files =
        arguments.worn.iter().map(|path| ViewFile::read(path, allow_folder)).collect::<Result<Vec<_>>>()?;
    let mut items: Vec<ViewerItem> = arguments
        .worn
        .iter()
        .zip(files)
        .map(|(path, file)| worn_item(path, file, &reading))
        .collect::<Result<_>>()?;
    let mut names = Vec::new();
    if let (Some(folder), Some(first)) = (&arguments.frames, items.first_mut()) {
        let FrameSeries { positions, names: shown, triangles } = frames(folder, arguments.max_frames.into())?;
        names = shown;
        let count = first.view.before.len();
        let own = positions.iter().map(|x| of_points(x, &triangles, &first.view.triangles, count));
        match own.collect::<Option<Vec<_>>>() {
            Some(own) => first.frames = own,
            // The simulated mesh has other points than the garment and becomes an item of its own.
            None => items.insert(1, simulated_item(folder, positions, triangles)?),
        }
    }
    let page = viewer_page(&items, arguments.show, &names);
    outputs.add(&arguments.output, page.as_bytes())?;
    commit(outputs)?;
    console::message(&format!("{}: {:.1} MB", output_name(&arguments.output), page.len() as f64 / 1e6));
    Ok(())
}

/// Positions of the points of a garment with `triangles` from a frame of it [m], whose vertices are others: each point lies where the
/// corners of its triangles do. `None` for a frame of another mesh.
fn of_points(
    frame: &[Vec3],
    frame_triangles: &[[PointIndex; 3]],
    triangles: &[[PointIndex; 3]],
    count: usize,
) -> Option<Vec<Vec3>> {
    if frame_triangles.len() != triangles.len() || frame.len() < count {
        return None;
    }
    let mut points = vec![Vec3::zeros(); count];
    for (vertices, corners) in frame_triangles.iter().zip(triangles) {
        for (vertex, corner) in vertices.iter().zip(corners) {
            points[corner.at()] = *frame.get(vertex.at())?;
        }
    }
    Some(points)
}

fn worn_item(path: &Path, file: ViewFile, reading: &ReadOptions) -> Result<ViewerItem> {
    let ViewFile { view, sidecar, mut asset } = file;
    for warning in embed_asset_images(&mut asset, path, reading) {
        console::message(&format!("warning: {}", warning.worded(&ToolWords)));
    }
    let hinges = sidecar.as_ref().map_or_else(Vec::new, HingeLabel::from_sidecar);
    let name =
        path.file_name().map_or_else(|| input::name_of(path), |name| name.to_string_lossy().into_owned());
    let pieces = ViewerPiece::of_asset(&asset);
    let own = plain_glb(&asset)?;
    let fine = sidecar.as_ref().map_or(Ok(None), |sidecar| fine_worn_glb(&own, &asset, sidecar));
    let (glb, added) = match fine {
        Ok(Some(fine)) => (fine.glb, fine.added),
        Ok(None) => (own, Vec::new()),
        Err(error) => {
            let message = own_triangles_message(&error);
            console::message(&format!("warning: {name}: {}", message.worded(&ToolWords)));
            (own, Vec::new())
        }
    };
    Ok(ViewerItem { name, glb, pieces, added, view, hinges, frames: Vec::new() })
}

/// Frames of a run.
struct FrameSeries {
    /// Per frame: one position per point [m].
    positions: Vec<Vec<Vec3>>,
    /// Per frame: its number, as text.
    names: Vec<String>,
    /// Triangles of all frames.
    triangles: Vec<[PointIndex; 3]>,
}

/// Returns an item for the simulated mesh, from its first frame to its last.
fn simulated_item(
    folder: &Path,
    frames: Vec<Vec<Vec3>>,
    triangles: Vec<[PointIndex; 3]>,
) -> Result<ViewerItem> {
    let [before, after] = [frames.first(), frames.last()].map(|x| x.cloned().unwrap_or_default());
    let corners: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|p| p.0)).collect();
    let positions: Vec<[f64; 3]> = after.iter().map(|&x| x.into()).collect();
    let mesh = GarmentFile::from_mesh(
        &positions,
        &corners,
        MeshOptions::default().name("simulated").any_size(true),
    )?;
    let view = GarmentView::of_shapes(input::name_of(folder), [before, after], triangles);
    let (glb, pieces) = (plain_glb(&mesh.asset)?, ViewerPiece::of_asset(&mesh.asset));
    Ok(ViewerItem {
        name: "simulated".to_owned(),
        glb,
        pieces,
        added: Vec::new(),
        view,
        hinges: Vec::new(),
        frames,
    })
}

/// Reads the frames in `folder`, evenly subsampled to at most `max_count`.
fn frames(folder: &Path, max_count: usize) -> Result<FrameSeries> {
    let path = |number: usize| folder.join(format!("frame_{number:04}.obj"));
    let count = (0..).take_while(|&number| path(number).is_file()).count();
    if count == 0 {
        let help = "give the folder that `crease bake --frames DIR` wrote";
        return Err(Error::input(input::name_of(folder), "", "has no frame_0000.obj", help));
    }
    let step = count.div_ceil(max_count);
    let mut series = FrameSeries { positions: Vec::new(), names: Vec::new(), triangles: Vec::new() };
    for number in (0..count).step_by(step) {
        let options =
            ReadOptions { unit_m: Some(1.0), any_size: true, skip_damaged: true, ..ReadOptions::default() };
        let (asset, _) = read_asset_file(&path(number), &options)?;
        let (mut x, mut triangles) = (Vec::new(), Vec::new());
        for piece in asset.pieces {
            let first = x.len() as u32;
            x.extend(piece.positions);
            triangles.extend(piece.triangles.iter().map(|t| t.map(|v| PointIndex(v + first))));
        }
        if number == 0 {
            series.triangles = triangles;
        } else if x.len() != series.positions[0].len() || triangles != series.triangles {
            let message = "is of another mesh than frame_0000.obj";
            let help = "give the frames of one bake";
            return Err(Error::input(input::name_of(&path(number)), "", message, help));
        }
        series.positions.push(x);
        series.names.push(format!("{number}"));
    }
    Ok(series)
}
