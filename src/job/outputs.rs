//! Outputs of a job: the worn garment, its sidecar, the report and the files beside them, written all or none.

use crate::files::{
    CheckpointFile, Outputs, RunLock, file_name, frame_paths, is_stream, output_name, read_bytes,
};
use crate::job::garment_source::ReadGarment;
use crate::job::observer::{JobNotice, JobObserver};
use crate::job::output_options::{FrameOptions, OutputOptions, WornPaths, WrittenFiles};
#[cfg(feature = "render")]
use crate::report::render::{Camera, encode_png};
#[cfg(feature = "render")]
use crate::report::{ColorBy, GarmentView};
use crate::report::{Export, Report, TransferReport, WrittenFile};
use crease_geometry::math::Vec3;
use crease_io::gltf::DetailInput;
use crease_io::{Sidecar, UsdFrames, read_shape_obj, write_sidecar_to};
use crease_model::error::{Error, Message, Result, Vocabulary};
use crease_model::fabric::Fabric;
use crease_model::garment::{SourceAsset, WornGarment, mistaken_body};
use crease_model::remesh::{GarmentSurface, WornSurface};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Name and version in sidecars.
pub(super) const TOOL: &str = concat!("crease ", env!("CARGO_PKG_VERSION"));

/// Size of each half of the preview [pixels].
#[cfg(feature = "render")]
const PREVIEW_SIZE: [usize; 2] = [800, 600];

/// Result of a job.
#[derive(Debug)]
pub struct JobOutputs<R> {
    /// File and garment before the wear.
    pub garment: ReadGarment,
    /// Worn garment and its sidecar; `None` for a run that ended before its script.
    pub worn: Option<(WornGarment, Sidecar)>,
    /// Report.
    pub report: R,
    /// Reason why the result is not what was asked for: no equilibrium, an action that did not take place, or nothing at all.
    pub failure: Option<Error>,
    /// Whether the result is an equilibrium.
    pub converged: bool,
    pub(super) record: JobRecord,
    pub(super) fabric: Fabric,
    /// What was worn, on the mesh that was simulated; made of the worn garment where nothing else was.
    pub(super) surface: OnceCell<WornSurface>,
    /// Frames that are written already, for files that hold them.
    pub(super) frames: Option<FrameOptions>,
    /// Checkpoint, which is removed when the outputs are written.
    pub(super) checkpoints: Option<CheckpointFile>,
}

/// Report of a job that produces a worn garment.
pub trait JobReport {
    /// Warnings.
    fn warnings(&mut self) -> &mut Vec<String>;
    /// Sets what is known when the worn garment has been written: with the times of reading, of writing, and of the whole job [s].
    fn finish(&mut self, files: WrittenFiles, times: [f64; 3]);
    /// Returns the report file.
    fn json(&self) -> String;
}

impl<R: JobReport> JobOutputs<R> {
    /// Makes the outputs of `worn`, without frames and checkpoints. The warnings of the record go to the report.
    pub(super) fn new(
        garment: ReadGarment,
        fabric: Fabric,
        worn: Option<(WornGarment, Sidecar)>,
        mut report: R,
        mut record: JobRecord,
        words: &dyn Vocabulary,
    ) -> Self {
        report.warnings().extend(record.warnings.drain(..).map(|warning| warning.worded(words)));
        Self {
            garment,
            worn,
            report,
            failure: None,
            converged: true,
            record,
            fabric,
            surface: OnceCell::new(),
            frames: None,
            checkpoints: None,
        }
    }

    /// Name of the worn garment in messages; empty if nothing is written.
    pub fn name(&self) -> String {
        self.record.output.path.as_deref().map_or(String::new(), output_name)
    }

    /// Warnings of the report that the observer does not know and the failure does not say.
    pub fn fresh_warnings(&mut self) -> impl Iterator<Item = &String> {
        self.report.warnings().iter().filter(|text| !self.record.told.contains(text))
    }

    /// Writes all outputs, or none, and completes the report; to be called once. Returns the bytes for the standard output.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be written; [`Error::Input`] for a garment that a file cannot carry.
    pub fn write(&mut self) -> Result<Vec<u8>> {
        let mut files = self.record.files.take();
        let mut written = match (&self.worn, &mut files) {
            (Some(worn), Some(files)) => self.add_files(worn, files)?,
            _ => WrittenFiles::default(),
        };
        self.report.warnings().append(&mut written.warnings);
        let sizes = files.as_ref().map_or_else(Vec::new, |files| files.outputs.sizes());
        written.files = sizes.into_iter().map(|(file, bytes)| WrittenFile { file, bytes }).collect();
        let JobRecord { read_s, started, computed, .. } = &self.record;
        let write_s = if self.worn.is_some() { computed.elapsed().as_secs_f64() } else { 0.0 };
        self.report.finish(written, [*read_s, write_s, started.elapsed().as_secs_f64()]);
        let Some(JobFiles { paths, mut outputs }) = files else { return Ok(Vec::new()) };
        if let Some(path) = &paths.report {
            outputs.add(path, self.report.json().as_bytes())?;
        }
        let stream = outputs.commit()?;
        if let Some(checkpoints) = &self.checkpoints {
            checkpoints.remove();
        }
        Ok(stream)
    }

    fn add_files(
        &self,
        (worn, sidecar): &(WornGarment, Sidecar),
        JobFiles { paths, outputs }: &mut JobFiles,
    ) -> Result<WrittenFiles> {
        let (options, ReadGarment { mesh, .. }) = (&self.record.output, &self.garment);
        let mut written = WrittenFiles::default();
        let mut glb = options.shape.worn_glb(mesh, worn, &paths.extras())?;
        let fine = match options.fine {
            true => {
                let path = paths.fine();
                let name = output_name(&path);
                let (fine, report) = options.shape.fine_glb(&name, mesh, worn, &self.detail_input(worn))?;
                written.fine = Some(report);
                Some((path, fine))
            }
            false => None,
        };
        if let Some(maps) = options.detail {
            let detail = self.detail_input(worn);
            glb = maps.add(&paths.worn, outputs, &mut written, &mesh.asset, &detail, glb)?;
        }
        let name = output_name(&paths.worn);
        outputs.add(&paths.worn, &options.shape.applied(&name, glb)?)?;
        if let Some((path, fine)) = fine {
            outputs.add(&path, &fine)?;
        }
        if let Some(path) = &paths.sidecar {
            outputs.add_written(path, &|out| write_sidecar_to(sidecar, out))?;
        }
        #[cfg(feature = "render")]
        if options.preview {
            let (view, message) = GarmentView::of_sidecar(&name, sidecar).with_worn_surface(sidecar);
            written.warnings.extend(message.map(|message| format!("picture: {message}")));
            let picture = view.draw_before_after(ColorBy::Shape, &Camera::default(), PREVIEW_SIZE)?;
            outputs.add(&paths.preview(), &encode_png(&picture)?)?;
        }
        let frames = self.usd_frames(&mut written.warnings)?;
        let frames = frames.as_ref().map(|(rate, frames)| UsdFrames { rate: *rate, positions: &frames[..] });
        written.exports = options.add_exports(&paths.worn, outputs, mesh, worn, &self.fabric, frames)?;
        Ok(written)
    }

    /// The garment on the mesh of its file, and the surface of what was worn.
    fn detail_input<'a>(&'a self, worn: &'a WornGarment) -> DetailInput<'a> {
        let surface = self.surface.get_or_init(|| {
            let mesh = GarmentSurface::without_texture(&self.garment.mesh.garment);
            WornSurface::new(&mesh, worn, self.fabric.crease_width())
        });
        DetailInput {
            coarse: self.garment.coarse(),
            displacement: &worn.displacement,
            surface,
            flat_normals: self.record.output.shape.flat_normals,
        }
    }

    /// Takes what was worn as a surface; `None` if there is no worn garment.
    pub fn take_surface(&mut self) -> Option<WornSurface> {
        let (worn, _) = self.worn.as_ref()?;
        self.detail_input(worn);
        self.surface.take()
    }

    /// Frames for a USD scene: their rate [1/s], and positions per frame and vertex [m].
    fn usd_frames(&self, warnings: &mut Vec<String>) -> Result<Option<(f64, Vec<Vec<Vec3>>)>> {
        let has_usd = self.record.output.exports.contains(&Export::Usd);
        let Some(FrameOptions { folder, rate }) = self.frames.as_ref().filter(|_| has_usd) else {
            return Ok(None);
        };
        let frames = read_frames_of(folder, &self.garment.mesh.asset)?;
        if frames.is_none() {
            warnings.push("no frames in the USD scene: they are not of the file's vertices".to_owned());
        }
        Ok(frames.map(|frames| (*rate, frames)))
    }
}

/// Reads the positions per frame of `folder`, which must be those of the worn vertices of `asset`; `None` if they are of another mesh.
fn read_frames_of(folder: &Path, asset: &SourceAsset) -> Result<Option<Vec<Vec<Vec3>>>> {
    let count: usize = asset.worn_pieces().map(|piece| piece.positions.len()).sum();
    let read = |path: PathBuf| read_shape_obj(&file_name(&path), &read_bytes(&path)?, asset);
    let frames: Vec<Vec<Vec3>> = frame_paths(folder)?.into_iter().map(read).collect::<Result<_>>()?;
    Ok(frames.iter().all(|frame| frame.len() == count).then_some(frames))
}

/// Failure of a result that is no equilibrium, or empty.
pub(super) fn failure_of(unconverged: Option<Message>, empty: Option<Message>) -> Option<Error> {
    unconverged.map(Error::NotConverged).or(empty.map(Error::Empty))
}

impl JobReport for Report {
    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }

    fn finish(&mut self, files: WrittenFiles, [read_s, write_s, wall_s]: [f64; 3]) {
        (self.detail_maps, self.exports) = (files.detail_maps, files.exports);
        (self.fine, self.files) = (files.fine, files.files);
        self.stages.add("read", read_s);
        self.stages.add("write", write_s);
        self.wall_s = wall_s;
    }

    fn json(&self) -> String {
        self.to_json()
    }
}

impl JobReport for TransferReport {
    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }

    fn finish(&mut self, files: WrittenFiles, [_, _, wall_s]: [f64; 3]) {
        (self.detail_maps, self.exports, self.wall_s) = (files.detail_maps, files.exports, wall_s);
        (self.fine, self.files) = (files.fine, files.files);
    }

    fn json(&self) -> String {
        self.to_json()
    }
}

/// Files of a job, which can be written.
#[derive(Debug)]
pub(super) struct JobFiles {
    /// Paths of the garment, its sidecar and the report.
    pub(super) paths: WornPaths,
    /// Files written so far.
    pub(super) outputs: Outputs,
}

/// Record of a job until it has its result.
#[derive(Debug)]
pub(super) struct JobRecord {
    /// Outputs that are asked for.
    pub(super) output: OutputOptions,
    /// Files of the outputs; `None` if nothing is written.
    pub(super) files: Option<JobFiles>,
    /// Lock of the outputs, from the time when the inputs are read.
    pub(super) lock: Option<RunLock>,
    /// Start of the job.
    pub(super) started: Instant,
    /// Time until the inputs were read [s].
    pub(super) read_s: f64,
    /// Time at which the computation ended.
    pub(super) computed: Instant,
    /// Warnings of the job itself, for the report.
    pub(super) warnings: Vec<Message>,
    /// Those among them that the observer knows, or that are the reason of a failure, as it was told.
    pub(super) told: Vec<String>,
}

impl JobRecord {
    /// Checks that every file of `output` can be written. `inputs` are never overwritten.
    pub(super) fn start<'a>(
        output: OutputOptions,
        inputs: impl IntoIterator<Item = &'a Path>,
    ) -> Result<Self> {
        let started = Instant::now();
        let (mut files, mut warnings) = (None, Vec::new());
        if let Some(path) = &output.path {
            let (paths, outputs) = (WornPaths::beside(path), Outputs::new(inputs));
            output.check(&paths, &outputs)?;
            if paths.report.is_none() {
                let left_out = "the garment goes to the standard output: no sidecar, report or checkpoint is written beside it";
                warnings.push(left_out.into());
            }
            files = Some(JobFiles { paths, outputs });
        }
        Ok(Self {
            output,
            files,
            lock: None,
            started,
            read_s: 0.0,
            computed: started,
            warnings,
            told: Vec::new(),
        })
    }

    /// Adds warnings to the report.
    pub(super) fn warn(&mut self, warnings: impl IntoIterator<Item = impl Into<Message>>) {
        self.warnings.extend(warnings.into_iter().map(Into::into));
    }

    /// Adds warnings to the report and gives them to `observer` at once, so that a long run can be stopped for them.
    pub(super) fn warn_before_run(
        &mut self,
        warnings: impl IntoIterator<Item = Message>,
        observer: &mut dyn JobObserver,
    ) {
        for warning in warnings {
            let text = warning.worded(observer.words());
            observer.notice(JobNotice::Warning(&text));
            self.told.push(text);
            self.warnings.push(warning);
        }
    }

    /// Adds the reason of a failure to the report, in the words of `words`.
    pub(super) fn warn_of_failure(&mut self, reason: Option<Message>, words: &dyn Vocabulary) {
        self.told.extend(reason.iter().map(|reason| reason.worded(words)));
        self.warnings.extend(reason);
    }

    /// Notes the doubts about the content and the repairs of `garment` and its refinement, and embeds the images that its file
    /// refers to.
    ///
    /// # Errors
    /// A body among what is taken for cloth.
    pub(super) fn accept(&mut self, garment: &mut ReadGarment, observer: &mut dyn JobObserver) -> Result<()> {
        let ReadGarment { mesh, path, reading, refinement } = garment;
        if let Some(error) = mistaken_body(&mesh.asset, &mesh.garment) {
            return Err(error);
        }
        self.warn_before_run(mesh.content_warnings(), observer);
        self.warn(mesh.repairs());
        self.warn(refinement.as_ref().map(|refinement| refinement.note.clone()));
        self.warn(path.as_ref().map(|path| mesh.embed_images(path, reading)).unwrap_or_default());
        Ok(())
    }

    /// Marks the end of reading, and takes the lock of the outputs.
    ///
    /// # Errors
    /// Another run with these outputs.
    pub(super) fn inputs_read(&mut self) -> Result<()> {
        self.read_s = self.started.elapsed().as_secs_f64();
        let worn = self.files.as_ref().map(|files| &files.paths.worn).filter(|worn| !is_stream(worn));
        self.lock = worn.map(|worn| RunLock::take(worn)).transpose()?.flatten();
        Ok(())
    }

    /// Marks the end of the computation.
    pub(super) fn computed(&mut self) {
        self.computed = Instant::now();
    }
}
