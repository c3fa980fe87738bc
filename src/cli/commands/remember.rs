//! `crease remember`: memory from a motion that already exists. Reads an animated glTF or a folder of OBJ frames; writes the
//! worn garment, its sidecar and the report, as `crease bake` does.

use crate::cli::args::body::read_frames;
use crate::cli::args::common::{MeshReading, glb_path, positive};
use crate::cli::commands::bake::BakeOutputs;
use crate::cli::files::input;
use crate::cli::files::mesh_file::MeshFile;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crate::cli::runtime::threads::use_threads;
use crease::bake::{BakeResult, GarmentMotion, memory_from_motion};
use crease::body::rig::Rig;
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::garment::{SourceAsset, SourcePiece};
use crease::io::gltf::{read_rig, write_worn_glb};
use crease::io::{Sidecar, sequence_from_assets, write_sidecar};
use crease::math::Vec3;
use crease::mesh::intersections::self_intersections;
use crease::report::{Report, crossing_counts};
use crease::{Error, Result};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease remember walk.glb --garment shirt --repeat 20 -o worn.glb
  crease remember capture/ --fps 60 -o worn.glb
  crease remember frames/ --fps 30 --mesh shirt.glb -o worn.glb    frames of a run, memory into the file it came from")]
pub struct Arguments {
    /// Motion of the garment: an animated .glb or .gltf (skin, nodes, morph targets), or a folder of numbered .obj frames
    motion: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// Garment in its own pose that frames are the motion of [default: the first frame]
    #[arg(long, value_name = "MESH")]
    mesh: Option<PathBuf>,
    /// Frames per second: of a folder (needed), or at which a clip is followed [default: 30]
    #[arg(long, value_name = "N", value_parser = positive)]
    fps: Option<f64>,
    /// Clip of an animated file [default: its first]
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,
    /// How often the motion is gone through
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// What it is made of: a name of `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    #[command(flatten)]
    reading: MeshReading,
    /// Worker threads [default: all cores]. Results are bit-identical for any value.
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// The report on standard output
    #[arg(long)]
    json: bool,
    /// Errors only
    #[arg(long)]
    quiet: bool,
}

/// Rate at which clips are followed, unless asked otherwise [1/s].
const CLIP_RATE: f64 = 30.0;
/// Frames of one clip at most: an hour at that rate, and a guard against typing errors.
const MOST_FRAMES: f64 = 110_000.0;

pub fn run(arguments: Arguments) -> Result<()> {
    let began = Instant::now();
    use_threads(arguments.threads)?;
    let files = BakeOutputs::beside(&arguments.output);
    let read = [Some(arguments.motion.as_path()), arguments.mesh.as_deref()];
    let mut outputs = Outputs::new(read.into_iter().flatten());
    for path in files.paths() {
        outputs.check(path)?;
    }
    let fabric = input::fabric(&arguments.fabric)?;
    let mut job = if arguments.motion.is_dir() { of_frames(&arguments)? } else { of_clip(&arguments)? };
    let mut warnings = job.mesh.repairs();
    let path = job.path.clone();
    warnings.extend(job.mesh.embed_images(&path));
    let read_s = began.elapsed().as_secs_f64();
    let baked = job.remember(&fabric, arguments.repeat);
    let write_began = Instant::now();
    let garment = &job.mesh.garment;
    let counts =
        crossing_counts(garment, &baked.worn, &self_intersections(&garment.points, &garment.triangles));
    let mut report = Report::of_bake(garment, &baked, counts);
    report.method = "remember".to_owned();
    report.warnings.extend(warnings);
    outputs.add(&files.worn, &write_worn_glb(&job.mesh.asset, garment, &baked.worn, &files.extras())?)?;
    let sidecar = job.sidecar(&baked, &fabric, &arguments)?;
    outputs.add(&files.sidecar, &write_sidecar(&sidecar))?;
    report.stages.add("read", read_s);
    report.stages.add("write", write_began.elapsed().as_secs_f64());
    report.wall_s = began.elapsed().as_secs_f64();
    outputs.add(&files.report, report.to_json().as_bytes())?;
    outputs.commit()?;
    if !arguments.quiet && !arguments.json {
        report.warnings.iter().for_each(|warning| console::say(&format!("warning: {warning}")));
        console::say(&format!(
            "{}: {} points, {:.1} s of motion remembered in {:.1} s; {} events, {} crossings",
            files.worn.display(),
            report.points,
            report.simulated_s,
            report.wall_s,
            report.events.gradual + report.events.critical,
            report.crossings
        ));
    }
    if arguments.json {
        console::data(&report.to_json())?;
    }
    baked.report.unconverged_reason.map_or(Ok(()), |what| Err(Error::NotConverged(what)))
}

/// A garment and its motion.
struct Job {
    mesh: MeshFile,
    path: PathBuf,
    source: Source,
    /// Per point of the garment: its vertex among those of the source (none for a point without triangles).
    vertex_of: Vec<Option<u32>>,
    interval: f64,
    frame_count: usize,
}

/// Where positions come from.
enum Source {
    /// Per frame: its places.
    Frames(Vec<Vec<Vec3>>),
    /// A clip of a rig whose vertices are the garment's.
    Clip { rig: Box<Rig>, clip: usize },
}

impl Job {
    fn remember(&mut self, fabric: &Fabric, times: u32) -> BakeResult {
        let Self { mesh, source, vertex_of, interval, frame_count, .. } = self;
        let garment = &mesh.garment;
        let of_points = |vertices: &[Vec3]| -> Vec<Vec3> {
            let own = |vertex: &Option<u32>| vertex.and_then(|v| vertices.get(v as usize)).copied();
            vertex_of.iter().zip(&garment.points).map(|(v, rest)| own(v).unwrap_or(*rest)).collect()
        };
        let mut frame = |k: usize| match source {
            Source::Frames(frames) => of_points(frames.get(k).map_or(&[], Vec::as_slice)),
            Source::Clip { rig, clip } => match rig.clips.get(*clip) {
                Some(clip) => {
                    let t = k as f64 * *interval;
                    let pose = clip.pose(&rig.skeleton.rest(), t);
                    of_points(&rig.vertices(&pose, Some((clip, t))))
                }
                None => garment.points.clone(),
            },
        };
        let mut motion = GarmentMotion {
            frame_count: *frame_count,
            interval: *interval,
            repetitions: times,
            frame: &mut frame,
        };
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
}

/// A folder of frames, of `--mesh` or of its own first frame.
fn of_frames(arguments: &Arguments) -> Result<Job> {
    let folder = input::name_of(&arguments.motion);
    let Some(rate) = arguments.fps else {
        let what = "a folder of frames has no rate of its own";
        return Err(Error::input(folder, "", what, "give it with --fps"));
    };
    // Frames are in metres when they are those of a run; a file beside them has its own unit.
    let reading = match &arguments.mesh {
        Some(_) => MeshReading { unit: Some(crate::cli::args::common::Metres(1.0)), up: None, garment: None },
        None => arguments.reading.clone(),
    };
    let assets = read_frames(&arguments.motion, &reading)?;
    let frames = sequence_from_assets(&assets, rate)?.frames;
    let Some(first) = assets.first() else { return Err(Error::input(folder, "", "has no frames", "")) };
    let path = arguments.mesh.clone().unwrap_or_else(|| PathBuf::from(&first.file));
    let mesh = MeshFile::read(&path, &arguments.reading)?;
    let Some(vertex_of) = vertex_of_point(&mesh, first) else {
        let count = |asset: &SourceAsset| {
            let pieces = || asset.worn_pieces();
            let vertices: usize = pieces().map(|piece| piece.positions.len()).sum();
            let triangles: usize = pieces().map(|piece| piece.triangles.len()).sum();
            format!("{vertices} vertices in {triangles} triangles")
        };
        let (frame, own) = (count(first), count(&mesh.asset));
        let what = format!("its frames ({frame}) are not of the garment {} ({own})", path.display());
        let cure = "give the mesh that the frames are of with --mesh (and --garment), or leave it out; frames of a bake \
                    are of the whole garment with --no-grading";
        return Err(Error::input(folder, "", what, cure));
    };
    let frame_count = frames.len();
    Ok(Job { mesh, path, source: Source::Frames(frames), vertex_of, interval: 1.0 / rate, frame_count })
}

/// Per point of the garment: its vertex in `frame`, found corner by corner, as files number their vertices as they
/// like. The triangles of `frame` are those of the garment (frames of a run) or those of its file; `None` if neither.
fn vertex_of_point(mesh: &MeshFile, frame: &SourceAsset) -> Option<Vec<Option<u32>>> {
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

/// An animated glTF.
fn of_clip(arguments: &Arguments) -> Result<Job> {
    let path = arguments.motion.clone();
    let file = input::name_of(&path);
    if arguments.mesh.is_some() {
        let cure = "leave --mesh out: the garment is in the animated file itself";
        return Err(Error::input(file, "", "an animated file is its own garment", cure));
    }
    let mesh = MeshFile::read(&path, &arguments.reading)?;
    let pieces: Vec<&SourcePiece> = mesh.asset.worn_pieces().collect();
    let Some(rig) = read_rig(&mesh.asset, &pieces)? else {
        let cure = "give an animated .glb, or a folder of numbered .obj frames with --fps";
        return Err(Error::input(file, "", "an OBJ file does not move", cure));
    };
    let names: Vec<String> = rig.clips.iter().map(|clip| format!("\"{}\"", clip.name)).collect();
    let refuse = |what: String, cure: String| Err(Error::input(file.clone(), "animations", what, cure));
    let found = match &arguments.clip {
        Some(name) => rig.clips.iter().position(|clip| clip.name == *name),
        None => (!rig.clips.is_empty()).then_some(0),
    };
    let Some(clip) = found else {
        let wanted = arguments.clip.as_ref().map_or("clip".to_owned(), |name| format!("clip \"{name}\""));
        return refuse(format!("has no {wanted}"), format!("clips in it: {}", names.join(", ")));
    };
    let rate = arguments.fps.unwrap_or(CLIP_RATE);
    let length = rig.clips.get(clip).map_or(0.0, |clip| clip.length());
    if length * rate > MOST_FRAMES {
        let what = format!("{length:.0} s at {rate} frames per second are more than {MOST_FRAMES:.0} frames");
        return refuse(what, "give a lower rate with --fps".to_owned());
    }
    let frame_count = (length * rate).round() as usize + 1;
    let mut vertex_of = vec![None; mesh.garment.points.len()];
    for (vertex, point) in (0..).zip(&mesh.garment.source_point) {
        if let Some(own) = vertex_of.get_mut(point.at()) {
            own.get_or_insert(vertex);
        }
    }
    Ok(Job {
        vertex_of,
        mesh,
        path,
        source: Source::Clip { rig: Box::new(rig), clip },
        interval: 1.0 / rate,
        frame_count,
    })
}
