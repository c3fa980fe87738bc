//! The common frame of the commands that produce a worn garment: `bake`, `transfer`, `remember`. Before the computation
//! it checks that every output can be written; after it, it writes the worn garment, its sidecar,
//! the report and the files beside them, all or none, and prints the outcome.

use crate::args::apply::ApplyArgs;
use crate::args::export::ExportArgs;
use crate::args::refine::{RefineArgs, Refinement};
use crate::args::run::RunArgs;
use crate::files::frame_sequence::frame_paths;
use crate::files::input;
use crate::files::output::{self, Outputs, is_stream};
use crate::files::worn_outputs::WornOutputs;
use crate::runtime::console;
use crate::runtime::wording::ToolWords;
use crease::internal::files::GarmentFile;
use crease::internal::report::render::{Camera, encode_png};
use crease::internal::report::{ColorBy, DetailReport, ExportCheck, GarmentView, Report, TransferReport};
use crease_geometry::math::Vec3;
use crease_io::gltf::write_worn_glb_with;
use crease_io::{Sidecar, UsdFrames, read_shape_obj, write_sidecar_to};
use crease_model::error::{Error, Message, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{SourceAsset, WornGarment, mistaken_body};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Size of each half of `--preview` [pixels].
const PREVIEW_SIZE: [usize; 2] = [800, 600];

/// A run of one command.
#[derive(Debug)]
pub struct WornJob {
    run: RunArgs,
    files: WornOutputs,
    outputs: Outputs,
    started: Instant,
    /// Time until the inputs were read [s].
    read_s: f64,
    /// Warnings of the command itself, for the report.
    warnings: Vec<String>,
    /// Those among them that were printed before the run.
    printed: Vec<String>,
}

/// Files beside the main outputs.
#[derive(Debug, Clone, Copy, Default)]
pub struct SideFiles<'a> {
    /// Shape and normals of OUT.glb.
    pub apply: ApplyArgs,
    /// Detail maps, and the refinement whose wrinkles they show.
    pub detail: Option<(&'a RefineArgs, Option<&'a Refinement>)>,
    /// Files for other programs.
    pub export: Option<&'a ExportArgs>,
    /// Frames of the garment that are written already, for files that hold them.
    pub frames: Option<FrameSource<'a>>,
    /// Whether OUT.png is drawn.
    pub preview: bool,
}

/// Folder of frames.
#[derive(Debug, Clone, Copy)]
pub struct FrameSource<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// Frames per second.
    pub rate: f64,
}

impl FrameSource<'_> {
    /// Reads the positions per frame, which must be those of the worn vertices of `asset`; `None` if they are of another mesh.
    fn read(&self, asset: &SourceAsset) -> Result<Option<Vec<Vec<Vec3>>>> {
        let count: usize = asset.worn_pieces().map(|piece| piece.positions.len()).sum();
        let read = |path: PathBuf| read_shape_obj(&input::name_of(&path), &input::bytes(&path)?, asset);
        let frames: Vec<Vec<Vec3>> =
            frame_paths(self.folder)?.into_iter().map(read).collect::<Result<_>>()?;
        Ok(frames.iter().all(|frame| frame.len() == count).then_some(frames))
    }
}

/// Files that a run keeps when it ends before its script.
#[derive(Debug, Default)]
pub struct KeptFiles {
    /// Last checkpoint.
    pub checkpoint: Option<PathBuf>,
    /// Last frame.
    pub last_frame: Option<PathBuf>,
}

/// Outcome of a run, to be written.
#[derive(Debug, Clone, Copy)]
pub struct WornResult<'a> {
    /// File and garment before the wear.
    pub mesh: &'a GarmentFile,
    /// Worn garment.
    pub worn: &'a WornGarment,
    /// Fabric of the garment.
    pub fabric: &'a Fabric,
    /// Sidecar of the worn garment.
    pub sidecar: &'a Sidecar,
    /// Files beside the main outputs.
    pub side_files: SideFiles<'a>,
    /// Time at which the computation ended.
    pub computed: Instant,
}

/// Report of a command that produces a worn garment.
pub trait JobReport {
    /// Warnings.
    fn warnings(&mut self) -> &mut Vec<String>;
    /// Sets what is known when the worn garment has been written.
    fn finish(&mut self, files: WrittenFiles, times: JobTimes);
    /// Returns the report file.
    fn json(&self) -> String;
}

/// Entries of a report about the files beside the main outputs.
#[derive(Debug, Default)]
pub struct WrittenFiles {
    /// One entry per detail map.
    pub detail_maps: Vec<DetailReport>,
    /// Checks of the exported files.
    pub exports: Vec<ExportCheck>,
}

/// Wall times of a run [s].
#[derive(Debug, Clone, Copy)]
pub struct JobTimes {
    /// Reading the inputs.
    pub read_s: f64,
    /// Writing the outputs.
    pub write_s: f64,
    /// The whole run.
    pub wall_s: f64,
}

impl WornJob {
    /// Checks that the outputs beside `output` can be written. `inputs` are never overwritten.
    pub fn start<'a>(
        run: &RunArgs,
        output: &Path,
        inputs: impl IntoIterator<Item = &'a Path>,
        side_files: SideFiles,
    ) -> Result<Self> {
        let started = Instant::now();
        let files = WornOutputs::beside(output);
        let outputs = Outputs::new(inputs);
        if is_stream(output) {
            let beside = [
                ("--json", run.json),
                ("--preview", side_files.preview),
                ("--export", side_files.export.is_some_and(ExportArgs::is_given)),
                ("--height-map", side_files.detail.is_some_and(|(refine, _)| refine.has_height_map())),
            ];
            if let Some((option, _)) = beside.iter().find(|(_, is_given)| *is_given) {
                return Err(beside_stream(option));
            }
        }
        for path in files.paths() {
            outputs.check(path)?;
        }
        if let Some(export) = side_files.export {
            export.check(&files.worn, &outputs)?;
        }
        if side_files.preview {
            outputs.check(&files.preview())?;
        }
        let left_out =
            "the garment goes to the standard output: no sidecar, report or checkpoint is written beside it";
        let warnings = if is_stream(output) { vec![left_out.to_owned()] } else { Vec::new() };
        Ok(Self { run: run.clone(), files, outputs, started, read_s: 0.0, warnings, printed: Vec::new() })
    }

    /// Paths of the outputs.
    pub fn files(&self) -> &WornOutputs {
        &self.files
    }

    /// Checks that a further file can be written.
    pub fn check(&self, path: &Path) -> Result<()> {
        self.outputs.check(path)
    }

    /// Adds warnings to the report.
    pub fn warn(&mut self, warnings: impl IntoIterator<Item = impl Into<Message>>) {
        self.warnings.extend(warnings.into_iter().map(|warning| warning.into().worded(&ToolWords)));
    }

    /// Adds warnings to the report and prints them at once, so that a long run can be stopped for them.
    pub fn warn_before_run(&mut self, warnings: impl IntoIterator<Item = impl Into<Message>>) {
        for warning in warnings.into_iter().map(|warning| warning.into().worded(&ToolWords)) {
            if self.run.is_verbose() {
                print_warning(&warning);
            }
            self.printed.push(warning.clone());
            self.warnings.push(warning);
        }
    }

    /// Adds the reason of a failure to the report; the error of the command prints it.
    pub fn warn_of_failure(&mut self, reason: Option<&str>) {
        self.printed.extend(reason.map(str::to_owned));
        self.warnings.extend(reason.map(str::to_owned));
    }

    /// Notes the doubts about the content and the repairs of the mesh file `path` and its refinement, and embeds the images that it refers to.
    ///
    /// # Errors
    /// A body among what is taken for cloth.
    pub fn accept_mesh(
        &mut self,
        mesh: &mut GarmentFile,
        path: &Path,
        refinement: Option<&Refinement>,
    ) -> Result<()> {
        if let Some(error) = mistaken_body(&mesh.asset, &mesh.garment) {
            return Err(error);
        }
        self.warn_before_run(mesh.content_warnings());
        self.warn(mesh.repairs());
        self.warn(refinement.map(|refinement| refinement.note.clone()));
        self.warn(mesh.embed_images(path));
        Ok(())
    }

    /// Marks the end of reading.
    pub fn inputs_read(&mut self) {
        self.read_s = self.started.elapsed().as_secs_f64();
    }

    /// Writes all outputs, or none.
    pub fn write<R: JobReport>(mut self, result: &WornResult, report: R) -> Result<WrittenJob<R>> {
        let mut report = report;
        report.warnings().append(&mut self.warnings);
        let written = self.add_outputs(result, report.warnings())?;
        let Self { run, files, mut outputs, started, read_s, printed, .. } = self;
        let write_s = result.computed.elapsed().as_secs_f64();
        report.finish(written, JobTimes { read_s, write_s, wall_s: started.elapsed().as_secs_f64() });
        if let Some(path) = &files.report {
            outputs.add(path, report.json().as_bytes())?;
        }
        outputs.commit()?;
        Ok(WrittenJob { run, worn: files.worn, report, printed })
    }

    /// Writes the report of a run that ended before its script and made no garment, with the files that it `kept`; prints its
    /// warnings. Returns the error that the command ends with.
    pub fn write_stopped(mut self, mut report: Report, kept: KeptFiles) -> Result<Error> {
        let name = |path: &PathBuf| output::name_of(path);
        let stopped = report.stopped.get_or_insert_default();
        stopped.checkpoint = kept.checkpoint.as_ref().map(name);
        stopped.last_frame = kept.last_frame.as_ref().map(name);
        let reason = format!("{}: {}", stopped.action, stopped.reason);
        let mut text = format!("{reason}; no garment was made");
        if let Some(path) = &self.files.report {
            text += &format!(", the report is in {}", name(path));
        }
        if let Some(checkpoint) = &stopped.checkpoint {
            text += &format!(", the last checkpoint in {checkpoint}");
        }
        if let Some(last_frame) = &stopped.last_frame {
            text += &format!(", the last frame in {last_frame}");
        }
        self.warn_of_failure(Some(&reason));
        if self.files.worn.exists() {
            self.warn([format!("{} is of an earlier run", name(&self.files.worn))]);
        }
        report.warnings.append(&mut self.warnings);
        report.finish(
            WrittenFiles::default(),
            JobTimes { read_s: self.read_s, write_s: 0.0, wall_s: self.started.elapsed().as_secs_f64() },
        );
        if let Some(path) = &self.files.report {
            self.outputs.add(path, report.to_json().as_bytes())?;
        }
        self.outputs.commit()?;
        let mut written = WrittenJob { run: self.run, worn: self.files.worn, report, printed: self.printed };
        written.print(|_, _| ())?;
        Ok(Error::NotConverged(text.into()))
    }

    fn add_outputs(&mut self, result: &WornResult, warnings: &mut Vec<String>) -> Result<WrittenFiles> {
        let WornResult { mesh, worn, fabric, sidecar, side_files, .. } = *result;
        let (files, outputs) = (&self.files, &mut self.outputs);
        let mut written = WrittenFiles::default();
        let flat_normals = side_files.apply.flat_normals();
        let mut glb = write_worn_glb_with(&mesh.asset, &mesh.garment, worn, &files.extras(), flat_normals)?;
        if let Some((refine, refinement)) = side_files.detail {
            let detail =
                refinement.and_then(|refinement| refinement.detail(&mesh.garment, worn, flat_normals));
            let detailed = refine.add(&files.worn, outputs, &mesh.asset, detail, glb)?;
            glb = detailed.glb;
            written.detail_maps = detailed.reports;
            warnings.extend(detailed.notes);
        }
        outputs.add(&files.worn, &side_files.apply.applied(&output::name_of(&files.worn), glb)?)?;
        if let Some(path) = &files.sidecar {
            outputs.add_written(path, &|out| write_sidecar_to(sidecar, out))?;
        }
        if side_files.preview {
            let view = GarmentView::of_sidecar(&output::name_of(&files.worn), sidecar);
            let picture = view.draw_before_after(ColorBy::Shape, &Camera::default(), PREVIEW_SIZE)?;
            outputs.add(&files.preview(), &encode_png(&picture)?)?;
        }
        if let Some(export) = side_files.export {
            let frames = match side_files.frames.filter(|_| export.has_usd()) {
                Some(source) => {
                    let frames = source.read(&mesh.asset)?;
                    if frames.is_none() {
                        let text = "no frames in the USD scene: they are not of the file's vertices";
                        warnings.push(text.to_owned());
                    }
                    frames.map(|positions| (source.rate, positions))
                }
                None => None,
            };
            let frames =
                frames.as_ref().map(|(rate, positions)| UsdFrames { rate: *rate, positions: &positions[..] });
            written.exports = export.add(&files.worn, outputs, mesh, worn, fabric, frames)?;
        }
        Ok(written)
    }
}

/// A run whose outputs are written.
#[derive(Debug)]
pub struct WrittenJob<R> {
    run: RunArgs,
    worn: PathBuf,
    /// Report as written.
    pub report: R,
    /// Warnings that were printed before the run.
    printed: Vec<String>,
}

impl<R: JobReport> WrittenJob<R> {
    /// Prints the outcome: warnings and `summary`, which receives the name of the worn garment, as text, or the report as
    /// JSON.
    pub fn print(&mut self, summary: impl FnOnce(&str, &R)) -> Result<()> {
        if self.run.is_verbose() {
            let fresh = self.report.warnings().iter().filter(|text| !self.printed.contains(text));
            fresh.for_each(|text| print_warning(text));
            summary(&output::name_of(&self.worn), &self.report);
        }
        if self.run.json { console::data(&self.report.json()) } else { Ok(()) }
    }

    /// Path of the worn garment.
    pub fn worn(&self) -> &Path {
        &self.worn
    }
}

/// Returns the outcome of a command whose outputs are written: a failure if its result is no equilibrium, or empty.
pub fn outcome(unconverged_reason: Option<String>, empty_reason: Option<String>) -> Result<()> {
    match (unconverged_reason, empty_reason) {
        (Some(reason), _) => Err(Error::NotConverged(reason.into())),
        (None, Some(reason)) => Err(Error::Empty(reason.into())),
        (None, None) => Ok(()),
    }
}

/// The error of `option`, which needs a place that the standard output does not have.
pub fn beside_stream(option: &str) -> Error {
    let message = format!("takes the garment, and {option} needs a place of its own");
    Error::input("standard output", "", message, "name a file with -o")
}

fn print_warning(text: &str) {
    console::message(&format!("warning: {text}"));
}

impl JobReport for Report {
    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }

    fn finish(&mut self, files: WrittenFiles, times: JobTimes) {
        self.detail_maps = files.detail_maps;
        self.exports = files.exports;
        self.stages.add("read", times.read_s);
        self.stages.add("write", times.write_s);
        self.wall_s = times.wall_s;
    }

    fn json(&self) -> String {
        self.to_json()
    }
}

impl JobReport for TransferReport {
    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }

    fn finish(&mut self, files: WrittenFiles, times: JobTimes) {
        self.detail_maps = files.detail_maps;
        self.exports = files.exports;
        self.wall_s = times.wall_s;
    }

    fn json(&self) -> String {
        self.to_json()
    }
}
