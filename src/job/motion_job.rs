//! [`MotionJob`]: memory from an existing motion, without simulation. The motion is that of an animated glTF, or a folder of OBJ frames.

use crate::bake::{BakeResult, GarmentMotion, memory_from_motion};
use crate::files::{GarmentFile, file_name, read_fabric, read_frames};
use crate::job::garment_source::{GarmentSource, ReadGarment};
use crate::job::memory_source::left_out_warning;
use crate::job::observer::JobObserver;
use crate::job::output_options::OutputOptions;
use crate::job::outputs::{JobOutputs, JobRecord, TOOL, failure_of};
use crate::report::{Report, crossing_counts, source_crossings};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_io::gltf::read_rig;
use crease_io::{ReadOptions, compare_frame_size, sequence_from_assets};
use crease_model::body::rig::Rig;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourceAsset, SourceFormat, SourcePiece};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::PathBuf;

/// Name of the method in report and sidecar.
const METHOD: &str = "remember";

/// Memory from the motion of a garment: sources and options.
#[derive(Debug, Clone)]
pub struct MotionJob {
    /// An animated glTF, or a folder of numbered OBJ frames.
    pub motion: PathBuf,
    /// Source pose of the garment that the frames of a folder show; `None` for the first frame.
    pub mesh: Option<PathBuf>,
    /// Unit, axis, parts and masks of the garment.
    pub reading: ReadOptions,
    /// Frames per second: of a folder, or at which a clip is sampled.
    pub frames_per_second: Option<f64>,
    /// Unit of frames beside `mesh` [m]; `None` for metres.
    pub frames_unit_m: Option<f64>,
    /// Clip of an animated file: its name, or its number as in `clip#2`; `None` for the first that moves the garment.
    pub clip: Option<String>,
    /// Fabric: the name of a preset, a file, or `-` for the standard input.
    pub fabric: String,
    /// Repetitions of the motion.
    pub repetitions: u32,
    /// Files to write.
    pub output: OutputOptions,
}

impl MotionJob {
    /// Checks that the outputs can be written, reads the sources, and computes the memory.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] with the problems of a file, or for a body among what is taken for cloth; [`crease_model::error::Error::File`] for a
    /// file that cannot be read.
    pub fn run(self, observer: &mut dyn JobObserver) -> Result<JobOutputs<Report>> {
        let files = [Some(self.motion.as_path()), self.mesh.as_deref()];
        let mut record = JobRecord::start(self.output.clone(), files.into_iter().flatten())?;
        let fabric = read_fabric(&self.fabric)?;
        let mut input = MotionInput::read(&self)?;
        record.accept(&mut input.garment, observer)?;
        record.warn(left_out_warning(input.garment.name(), &input.garment.mesh));
        record.inputs_read()?;
        let baked = input.memory(&fabric, self.repetitions);
        record.computed();
        let garment = &input.garment.mesh.garment;
        let counts = crossing_counts(garment, &baked.worn, &source_crossings(garment));
        let report = Report::of_bake(garment, &baked, counts, observer.words());
        let report = Report { method: METHOD.to_owned(), ..report };
        let run = json!({
            "tool": TOOL,
            "method": METHOD,
            "motion": file_name(&self.motion),
            "frames": input.frame_count,
            "interval_s": input.interval,
            "repeat": self.repetitions,
        });
        let sidecar = input.garment.sidecar(&baked.worn, &fabric, Value::Null, run)?;
        record.warn_of_failure(baked.report.empty_reason.clone(), observer.words());
        let mut outputs = JobOutputs::new(
            input.garment,
            fabric,
            Some((baked.worn, sidecar)),
            report,
            record,
            observer.words(),
        );
        outputs.converged = baked.report.unconverged_reason.is_none();
        outputs.failure =
            failure_of(baked.report.unconverged_reason.map(Message::from), baked.report.empty_reason);
        Ok(outputs)
    }
}

/// Default rate at which clips are sampled [1/s].
const DEFAULT_CLIP_RATE: f64 = 30.0;
/// Maximum number of frames of a clip: an hour at the default rate, a guard against typing errors.
const MAX_FRAMES: f64 = 110_000.0;

/// A garment and its motion.
#[derive(Debug)]
pub(super) struct MotionInput {
    /// Garment.
    pub(super) garment: ReadGarment,
    source: MotionSource,
    /// Per point of the garment: its vertex in the source; `None` for a point without triangles.
    vertex_of: Vec<Option<u32>>,
    /// Time between frames [s].
    pub(super) interval: f64,
    /// Number of frames.
    pub(super) frame_count: usize,
}

/// Source of the positions of a motion.
#[derive(Debug)]
enum MotionSource {
    /// Positions per frame and vertex [m].
    Frames(Vec<Vec<Vec3>>),
    /// A clip of a rig whose vertices are those of the garment.
    Clip { rig: Box<Rig>, clip: usize },
}

impl MotionInput {
    /// Computes the memory of `repetitions` of the motion.
    pub(super) fn memory(&mut self, fabric: &Fabric, repetitions: u32) -> BakeResult {
        let Self { garment, source, vertex_of, interval, frame_count, .. } = self;
        let garment = &garment.mesh.garment;
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

    /// Reads the motion and its garment.
    pub(super) fn read(job: &MotionJob) -> Result<Self> {
        if job.motion.is_dir() { Self::from_frames(job) } else { Self::from_clip(job) }
    }

    /// Reads a folder of frames of a garment in a file of its own, or of the garment in the first frame.
    fn from_frames(job: &MotionJob) -> Result<Self> {
        let folder = file_name(&job.motion);
        let Some(rate) = job.frames_per_second else {
            let message = "a folder of frames has no rate of its own";
            return Err(Error::input(
                folder,
                "",
                message,
                Message::from("give it with ") + Setting::FrameRate,
            ));
        };
        // Frames of a run are in metres; the file of the garment has its own unit.
        let frames_unit_m = job.frames_unit_m.unwrap_or(1.0);
        let reading = match &job.mesh {
            Some(_) => ReadOptions { unit_m: Some(frames_unit_m), any_size: true, ..ReadOptions::default() },
            None => job.reading.clone(),
        };
        let assets = read_frames(&job.motion, &reading)?;
        let frames = sequence_from_assets(&assets, rate)?.frames;
        let Some(first) = assets.first() else { return Err(Error::input(folder, "", "has no frames", "")) };
        let path = job.mesh.clone().unwrap_or_else(|| PathBuf::from(&first.file));
        let garment = GarmentSource::File { path, reading: job.reading.clone() }.read()?;
        let mesh = &garment.mesh;
        let Some(vertex_of) = vertex_of_point(mesh, first) else {
            let count = |asset: &SourceAsset| {
                let pieces = || asset.worn_pieces();
                let vertices: usize = pieces().map(|piece| piece.positions.len()).sum();
                let triangles: usize = pieces().map(|piece| piece.triangles.len()).sum();
                format!("{vertices} vertices in {triangles} triangles")
            };
            let (frame, own) = (count(first), count(&mesh.asset));
            let message =
                format!("its frames ({frame}) are not of the garment {} ({own})", garment.name().display());
            let help = Message::from("give the mesh that the frames are of with ")
                + Setting::Mesh
                + " (and "
                + Setting::Garment
                + "), or leave it out; frames of a bake are of the garment unless made with "
                + Setting::FramesOf.to("simulated");
            return Err(Error::input(folder, "", message, help));
        };
        let ratio = frames.first().and_then(|frame| size_ratio(&mesh.garment, &vertex_of, frame));
        let checked = ratio.filter(|_| !job.reading.any_size);
        if let Some((message, help)) = checked.and_then(|ratio| compare_frame_size(ratio, frames_unit_m)) {
            return Err(Error::input(folder, "", message, help));
        }
        let frame_count = frames.len();
        Ok(Self {
            garment,
            source: MotionSource::Frames(frames),
            vertex_of,
            interval: 1.0 / rate,
            frame_count,
        })
    }

    /// Reads an animated glTF.
    fn from_clip(job: &MotionJob) -> Result<Self> {
        let path = job.motion.clone();
        let file = file_name(&path);
        if job.mesh.is_some() {
            let help =
                Message::from("leave ") + Setting::Mesh + " out: the garment is in the animated file itself";
            return Err(Error::input(file, "", "an animated file is its own garment", help));
        }
        let garment = GarmentSource::File { path, reading: job.reading.clone() }.read()?;
        let mesh = &garment.mesh;
        let pieces: Vec<&SourcePiece> = mesh.asset.worn_pieces().collect();
        let Some(rig) = read_rig(&mesh.asset, &pieces)? else {
            let help = Message::from("give an animated .glb, or a folder of numbered .obj frames with ")
                + Setting::FrameRate;
            let message = match mesh.asset.format {
                SourceFormat::Usd => "the motion of a USD file is not read",
                SourceFormat::Arrays => "a mesh from arrays does not move",
                _ => "an OBJ file does not move",
            };
            return Err(Error::input(file, "", message, help));
        };
        let refuse =
            |message: String, help: Message| Err(Error::input(file.clone(), "animations", message, help));
        if rig.clips.is_empty() {
            return refuse("the file has no clips".to_owned(), "export it with its animation".into());
        }
        let moving = rig.clips.iter().position(|clip| rig.is_moved_by(clip)).unwrap_or(0);
        let wanted = job.clip.clone().unwrap_or_else(|| format!("clip#{moving}"));
        let clip = match rig.find_clip(&wanted) {
            Ok(clip) => clip,
            Err(error) => return refuse(format!("the file has {}", error.message), error.help.into()),
        };
        let rate = job.frames_per_second.unwrap_or(DEFAULT_CLIP_RATE);
        let length = rig.clips.get(clip).map_or(0.0, |clip| clip.length());
        if length * rate > MAX_FRAMES {
            let message =
                format!("{length:.0} s at {rate} frames per second are more than {MAX_FRAMES:.0} frames");
            return refuse(message, Message::from("give a lower rate with ") + Setting::FrameRate);
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
            garment,
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
