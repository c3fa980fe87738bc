//! `crease remember`: memory from an existing motion, without simulation. Reads an animated glTF or a folder of OBJ frames;
//! writes the worn garment, its sidecar and the report, as `crease bake` does.

use crate::args::apply::ApplyArgs;
use crate::args::mesh::ClothArgs;
use crate::args::run::RunArgs;
use crate::args::values::{Metres, glb_path, positive, unit};
use crate::commands::worn_job::{SideFiles, WornJob, WornResult, outcome};
use crate::files::earlier_memory::left_out_warning;
use crate::files::frame_sequence::read_frames;
use crate::files::input;
use crate::runtime::console;
use crate::runtime::threads::on_threads;
use crate::runtime::wording::ToolWords;
use crease::internal::bake::{BakeResult, GarmentMotion, memory_from_motion};
use crease::internal::files::GarmentFile;
use crease::internal::report::{Report, crossing_counts, source_crossings};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_io::gltf::read_rig;
use crease_io::{ReadOptions, Sidecar, compare_frame_size, sequence_from_assets};
use crease_model::body::rig::Rig;
use crease_model::error::{Error, Result};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{Garment, SourceAsset, SourceFormat, SourcePiece};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease remember walk.glb --garment shirt --repeat 20 -o worn.glb
  crease remember capture/ --fps 60 -o worn.glb
  crease remember frames/ --fps 30 --mesh shirt.glb -o worn.glb    frames of a run, memory into the file it came from")]
pub struct Arguments {
    /// Motion of the garment: an animated .glb or .gltf (skin, nodes, morph targets), or a folder of numbered .obj frames
    motion: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// Source pose of the garment that the frames show in motion [default: the first frame]
    #[arg(long, value_name = "MESH")]
    mesh: Option<PathBuf>,
    /// Frames per second: of a folder (required), or at which a clip is sampled [default: 30]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = positive)]
    fps: Option<f64>,
    /// Unit of the frames beside --mesh: m, dm, cm, mm, in or metres [default: metres, as frames of a bake]
    #[arg(long, value_name = "UNIT", value_parser = unit, requires = "mesh")]
    frames_unit: Option<Metres>,
    /// Clip of an animated file: its name, or its number as in clip#2 [default: the first that moves the garment]
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,
    /// Repetitions of the motion
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// Fabric of the garment: a name of `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    #[command(flatten)]
    reading: ClothArgs,
    #[command(flatten)]
    apply: ApplyArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Default rate at which clips are sampled [1/s].
const DEFAULT_CLIP_RATE: f64 = 30.0;
/// Maximum number of frames of a clip: an hour at the default rate, a guard against typing errors.
const MAX_FRAMES: f64 = 110_000.0;

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    on_threads(arguments.run.threads, || remember(&arguments))
}

fn remember(arguments: &Arguments) -> Result<()> {
    let inputs = [Some(arguments.motion.as_path()), arguments.mesh.as_deref()].into_iter().flatten();
    let side_files = SideFiles { apply: arguments.apply, ..SideFiles::default() };
    input::check_streams(&[
        ("MOTION", Some(&arguments.motion)),
        ("--mesh", arguments.mesh.as_deref()),
        ("--fabric", Some(Path::new(&arguments.fabric))),
    ])?;
    let mut job = WornJob::start(&arguments.run, &arguments.output, inputs, side_files)?;
    let fabric = input::fabric(&arguments.fabric)?;
    let mut motion = if arguments.motion.is_dir() {
        MotionInput::from_frames(arguments)?
    } else {
        MotionInput::from_clip(arguments)?
    };
    job.accept_mesh(&mut motion.mesh, &motion.path, None)?;
    job.warn(left_out_warning(&motion.path, &motion.mesh));
    job.inputs_read();
    let baked = motion.memory(&fabric, arguments.repeat);
    let computed = Instant::now();
    let garment = &motion.mesh.garment;
    let counts = crossing_counts(garment, &baked.worn, &source_crossings(garment));
    let mut report = Report::of_bake(garment, &baked, counts, &ToolWords);
    report.method = "remember".to_owned();
    let sidecar = motion.sidecar(&baked, &fabric, arguments)?;
    let result = WornResult {
        mesh: &motion.mesh,
        worn: &baked.worn,
        fabric: &fabric,
        sidecar: &sidecar,
        side_files,
        computed,
    };
    let empty_reason = baked.report.empty_reason.as_ref().map(|reason| reason.worded(&ToolWords));
    job.warn_of_failure(empty_reason.as_deref());
    job.write(&result, report)?.print(print_summary)?;
    outcome(baked.report.unconverged_reason, empty_reason)
}

fn print_summary(worn: &str, report: &Report) {
    console::message(&format!(
        "{worn}: {} points, memory of {:.1} s of motion in {:.1} s; {} events, {} crossings",
        report.points,
        report.simulated_s,
        report.wall_s,
        report.events.gradual + report.events.critical,
        report.crossings
    ));
}

/// A garment and its motion.
struct MotionInput {
    mesh: GarmentFile,
    /// File of the garment.
    path: PathBuf,
    source: MotionSource,
    /// Per point of the garment: its vertex in the source; `None` for a point without triangles.
    vertex_of: Vec<Option<u32>>,
    /// Time between frames [s].
    interval: f64,
    frame_count: usize,
}

/// Source of the positions of a motion.
enum MotionSource {
    /// Positions per frame and vertex [m].
    Frames(Vec<Vec<Vec3>>),
    /// A clip of a rig whose vertices are those of the garment.
    Clip { rig: Box<Rig>, clip: usize },
}

impl MotionInput {
    /// Computes the memory of `repetitions` of the motion.
    fn memory(&mut self, fabric: &Fabric, repetitions: u32) -> BakeResult {
        let Self { mesh, source, vertex_of, interval, frame_count, .. } = self;
        let garment = &mesh.garment;
        let of_points = |vertices: &[Vec3]| -> Vec<Vec3> {
            let own = |vertex: &Option<u32>| vertex.and_then(|v| vertices.get(v as usize)).copied();
            vertex_of.iter().zip(&garment.points).map(|(v, rest)| own(v).unwrap_or(*rest)).collect()
        };
        let mut frame = |k: usize| match source {
            MotionSource::Frames(frames) => of_points(frames.get(k).map_or(&[], Vec::as_slice)),
            MotionSource::Clip { rig, clip } => match rig.clips.get(*clip) {
                Some(clip) => {
                    let t = k as f64 * *interval;
                    let pose = clip.pose(&rig.skeleton.rest(), t);
                    of_points(&rig.vertices(&pose, Some(&rig.morph_weights(Some((clip, t))))))
                }
                None => garment.points.clone(),
            },
        };
        let mut motion =
            GarmentMotion { frame_count: *frame_count, interval: *interval, repetitions, frame: &mut frame };
        memory_from_motion(garment, fabric, &mut motion)
    }

    fn sidecar(&self, baked: &BakeResult, fabric: &Fabric, arguments: &Arguments) -> Result<Sidecar> {
        let run = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "method": "remember",
            "motion": input::name_of(&arguments.motion),
            "frames": self.frame_count,
            "interval_s": self.interval,
            "repeat": arguments.repeat,
        });
        Sidecar::new(&self.mesh.asset, &self.mesh.garment, &baked.worn, json!(fabric), Value::Null, run)
    }

    /// Reads a folder of frames of the garment `--mesh`, or of its own first frame.
    fn from_frames(arguments: &Arguments) -> Result<Self> {
        let folder = input::name_of(&arguments.motion);
        let Some(rate) = arguments.fps else {
            let message = "a folder of frames has no rate of its own";
            return Err(Error::input(folder, "", message, "give it with --fps"));
        };
        // Frames of a run are in metres; the file of `--mesh` has its own unit.
        let frames_unit_m = arguments.frames_unit.map_or(1.0, |unit| unit.0);
        let reading = match &arguments.mesh {
            Some(_) => ReadOptions { unit_m: Some(frames_unit_m), any_size: true, ..ReadOptions::default() },
            None => arguments.reading.options(),
        };
        let assets = read_frames(&arguments.motion, &reading)?;
        let frames = sequence_from_assets(&assets, rate)?.frames;
        let Some(first) = assets.first() else { return Err(Error::input(folder, "", "has no frames", "")) };
        let path = arguments.mesh.clone().unwrap_or_else(|| PathBuf::from(&first.file));
        let mesh = GarmentFile::load(&path, &arguments.reading.options())?;
        let Some(vertex_of) = vertex_of_point(&mesh, first) else {
            let count = |asset: &SourceAsset| {
                let pieces = || asset.worn_pieces();
                let vertices: usize = pieces().map(|piece| piece.positions.len()).sum();
                let triangles: usize = pieces().map(|piece| piece.triangles.len()).sum();
                format!("{vertices} vertices in {triangles} triangles")
            };
            let (frame, own) = (count(first), count(&mesh.asset));
            let message = format!("its frames ({frame}) are not of the garment {} ({own})", path.display());
            let help = "give the mesh that the frames are of with --mesh (and --garment), or leave it out; frames of a bake \
                        are of the garment unless made with --frames-of simulated";
            return Err(Error::input(folder, "", message, help));
        };
        let ratio = frames.first().and_then(|frame| size_ratio(&mesh.garment, &vertex_of, frame));
        let checked = ratio.filter(|_| !arguments.reading.options().any_size);
        if let Some((message, help)) = checked.and_then(|ratio| compare_frame_size(ratio, frames_unit_m)) {
            return Err(Error::input(folder, "", message, help));
        }
        let frame_count = frames.len();
        Ok(Self {
            mesh,
            path,
            source: MotionSource::Frames(frames),
            vertex_of,
            interval: 1.0 / rate,
            frame_count,
        })
    }

    /// Reads an animated glTF.
    fn from_clip(arguments: &Arguments) -> Result<Self> {
        let path = arguments.motion.clone();
        let file = input::name_of(&path);
        if arguments.mesh.is_some() {
            let help = "leave --mesh out: the garment is in the animated file itself";
            return Err(Error::input(file, "", "an animated file is its own garment", help));
        }
        let mesh = GarmentFile::load(&path, &arguments.reading.options())?;
        let pieces: Vec<&SourcePiece> = mesh.asset.worn_pieces().collect();
        let Some(rig) = read_rig(&mesh.asset, &pieces)? else {
            let help = "give an animated .glb, or a folder of numbered .obj frames with --fps";
            let message = match mesh.asset.format {
                SourceFormat::Usd => "the motion of a USD file is not read",
                SourceFormat::Arrays => "a mesh from arrays does not move",
                _ => "an OBJ file does not move",
            };
            return Err(Error::input(file, "", message, help));
        };
        let refuse =
            |message: String, help: String| Err(Error::input(file.clone(), "animations", message, help));
        if rig.clips.is_empty() {
            return refuse("the file has no clips".to_owned(), "export it with its animation".to_owned());
        }
        let moving = rig.clips.iter().position(|clip| rig.is_moved_by(clip)).unwrap_or(0);
        let wanted = arguments.clip.clone().unwrap_or_else(|| format!("clip#{moving}"));
        let clip = match rig.find_clip(&wanted) {
            Ok(clip) => clip,
            Err(error) => return refuse(format!("the file has {}", error.message), error.help),
        };
        let rate = arguments.fps.unwrap_or(DEFAULT_CLIP_RATE);
        let length = rig.clips.get(clip).map_or(0.0, |clip| clip.length());
        if length * rate > MAX_FRAMES {
            let message =
                format!("{length:.0} s at {rate} frames per second are more than {MAX_FRAMES:.0} frames");
            return refuse(message, "give a lower rate with --fps".to_owned());
        }
        let frame_count = (length * rate).round() as usize + 1;
        let mut vertex_of = vec![None; mesh.garment.points.len()];
        for (vertex, point) in (0..).zip(&mesh.garment.source_point) {
            if let Some(own) = vertex_of.get_mut(point.at()) {
                own.get_or_insert(vertex);
            }
        }
        Ok(Self {
            vertex_of,
            mesh,
            path,
            source: MotionSource::Clip { rig: Box::new(rig), clip },
            interval: 1.0 / rate,
            frame_count,
        })
    }
}

/// Returns the mean length of the garment's edges in `frame` over their length in its file; `None` without edges.
fn size_ratio(garment: &Garment, vertex_of: &[Option<u32>], frame: &[Vec3]) -> Option<f64> {
    let shown = |p: PointIndex| frame.get((*vertex_of.get(p.at())?)? as usize).copied();
    let (mut there, mut own) = (0.0, 0.0);
    for [a, b] in &garment.topology.edges {
        if let (Some(x), Some(y)) = (shown(*a), shown(*b)) {
            there += (x - y).norm();
            own += (garment.points[a.at()] - garment.points[b.at()]).norm();
        }
    }
    (own > 0.0 && there > 0.0).then(|| there / own)
}

/// Returns per point of the garment its vertex in `frame`, whose numbering may differ: triangles are matched corner by
/// corner. The triangles of `frame` must be those of the garment (frames of a run) or those of its file; otherwise the
/// result is `None`.
fn vertex_of_point(mesh: &GarmentFile, frame: &SourceAsset) -> Option<Vec<Option<u32>>> {
    let garment = &mesh.garment;
    let corners = frame.worn_triangles();
    let own: Vec<[u32; 3]> = garment.triangles.iter().map(|t| t.map(|p| p.0)).collect();
    let point_of = |v: u32| garment.source_point.get(v as usize).map(|p| p.0);
    let of_file: Option<Vec<[u32; 3]>> = mesh
        .asset
        .worn_triangles()
        .into_iter()
        .map(|[a, b, c]| Some([point_of(a)?, point_of(b)?, point_of(c)?]))
        .collect();
    std::iter::once(own).chain(of_file).find_map(|triangles| {
        if triangles.len() != corners.len() {
            return None;
        }
        let mut point_of: HashMap<u32, u32> = HashMap::new();
        let mut vertex_of = vec![None; garment.points.len()];
        for (&vertex, &point) in corners.iter().flatten().zip(triangles.iter().flatten()) {
            if *point_of.entry(vertex).or_insert(point) != point {
                return None;
            }
            vertex_of.get_mut(point as usize)?.get_or_insert(vertex);
        }
        Some(vertex_of)
    })
}
