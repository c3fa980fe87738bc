//! [`BakeJob`]: a bake from sources to outputs.
//!
//! Errors are found before the long computation: files are read, outputs checked, and the garment is written once without wear.

use crate::bake::{BakeOptions, BakeReport, BakeResult, ModelDecision};
use crate::files::{CheckpointFile, FrameFolder, output_name};
use crate::job::bake_input::{BakeInput, BakeSources};
use crate::job::observer::{BakeRecorder, JobNotice, JobObserver, JobPhase};
use crate::job::output_options::{FrameOptions, OutputOptions};
use crate::job::outputs::{JobOutputs, JobRecord, TOOL, failure_of};
use crate::report::{Report, crossing_counts, source_crossings};
use crease_io::Sidecar;
use crease_model::error::{Error, Message, Result, Vocabulary};
use crease_model::remesh::{Crease, GarmentSurface, WornSurface};
use serde_json::{Value, json};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of a bake job.
#[derive(Debug)]
pub struct BakeJobOptions {
    /// Garment, script, fabric and body.
    pub sources: BakeSources,
    /// Options of the bake. The job sets the body, the skin, and the frames per second.
    pub bake: BakeOptions,
    /// Frames of the garment over time.
    pub frames: Option<FrameOptions>,
    /// Whether the run continues from the checkpoint beside the worn garment, if an interrupted run has left one.
    pub resume: bool,
    /// Minimum time between checkpoints within actions of the script.
    pub checkpoint_interval: Duration,
    /// Whether the sidecar also holds the memory of the simulated mesh, where that is another one.
    pub sidecar_of_simulated: bool,
    /// Files to write.
    pub output: OutputOptions,
}

/// A bake whose inputs are read.
#[derive(Debug)]
pub struct BakeJob {
    record: JobRecord,
    input: BakeInput,
    frames: Option<FrameOptions>,
    checkpoints: Option<CheckpointFile>,
    resume: bool,
    sidecar_of_simulated: bool,
}

/// Outcome of the simulation.
enum Simulated {
    /// It came to the end of the script.
    Finished {
        baked: Box<BakeResult>,
        /// Warning if the folder of frames holds frames of an earlier run.
        stale_frames: Option<String>,
    },
    /// It could not recover and ended before that, and left a last frame.
    Stopped { work: Box<BakeReport>, last_frame: Option<PathBuf> },
}

impl BakeJob {
    /// Checks that the outputs can be written, and reads the inputs.
    ///
    /// # Errors
    /// [`Error::Input`] with every problem of the files; [`Error::File`] for one that cannot be read.
    pub fn read(options: BakeJobOptions) -> Result<Self> {
        let BakeJobOptions { sources, mut bake, frames, resume, sidecar_of_simulated, .. } = options;
        let inputs = [sources.garment.path(), sources.wear.path(), Some(Path::new(&sources.fabric))];
        let record = JobRecord::start(options.output, inputs.into_iter().flatten())?;
        let files = record.files.as_ref();
        let file = files.map(|files| CheckpointFile::beside(&files.paths.worn, options.checkpoint_interval));
        if let (Some(files), Some(path)) = (files, file.as_ref().and_then(CheckpointFile::path)) {
            files.outputs.check(path)?;
        }
        bake.frames_per_second = frames.as_ref().map_or(0.0, |frames| frames.rate);
        let input = BakeInput::read(sources, bake)?;
        Ok(Self { record, input, frames, checkpoints: file, resume, sidecar_of_simulated })
    }

    /// Fails if the script names joints or clips that the body lacks, as [`Self::run`] does.
    ///
    /// # Errors
    /// [`Error::Input`] with every such name.
    pub fn check_body_motion(&self) -> Result<()> {
        self.input.check_body_motion()
    }

    /// Describes the inputs, and the models that the bake uses, with the reasons.
    pub fn decisions(&self) -> Vec<ModelDecision> {
        let mut decisions = self.input.bake().plan().decisions;
        let body = decisions.iter().position(|decision| decision.name == "body");
        let body = body.map(|k| decisions.remove(k));
        let mut of_input = self.input.decisions();
        of_input.splice(1..1, body);
        decisions.splice(0..0, of_input);
        decisions
    }

    /// Runs the bake.
    ///
    /// # Errors
    /// Those of [`crate::bake::Bake::run_with`], [`Error::Input`] for a garment that the files cannot carry, and [`Error::File`]. A run that
    /// ends before its script fails only if nothing is written; otherwise its outputs hold the report alone.
    pub fn run(mut self, observer: &mut dyn JobObserver) -> Result<JobOutputs<Report>> {
        self.record.accept(&mut self.input.garment, observer)?;
        self.record.warn_before_run(std::mem::take(&mut self.input.earlier_warnings), observer);
        if let Some(earlier) = &self.input.earlier {
            observer.notice(JobNotice::EarlierMemory(&earlier.sidecar));
        }
        if let Some(files) = &self.record.files {
            self.input.check_writers(&files.paths.extras())?;
        }
        let start = source_crossings(&self.input.garment.mesh.garment);
        self.record.inputs_read()?;
        match self.simulate(observer)? {
            Simulated::Finished { baked, stale_frames } => {
                observer.phase(JobPhase::Write);
                self.record.warn(stale_frames);
                self.finished(*baked, &start, observer.words())
            }
            Simulated::Stopped { work, last_frame } => {
                Ok(self.stopped(&work, last_frame, start.len(), observer.words()))
            }
        }
    }

    /// Runs the simulation.
    fn simulate(&mut self, observer: &mut dyn JobObserver) -> Result<Simulated> {
        let checkpoints = self.checkpoints.take();
        checkpoints.iter().for_each(CheckpointFile::remove_parts);
        let resumed = match &checkpoints {
            Some(checkpoints) if self.resume => checkpoints.read()?,
            _ => None,
        };
        let frames_written = resumed.as_ref().map_or(0, |saved| saved.checkpoint.counts.frames.shown);
        let frames = match &self.frames {
            Some(FrameOptions { folder, .. }) => {
                let mesh = self.input.garment.path.clone();
                let mut frames = FrameFolder::new(folder, mesh, frames_written as usize)?;
                self.input.show_vertices(&mut frames);
                Some(frames)
            }
            None => None,
        };
        observer.phase(JobPhase::Simulate);
        let mut recorder = BakeRecorder {
            observer,
            frames,
            checkpoints,
            frames_of_simulated: self.input.options.frames_of_simulated,
            action_count: self.input.script.flatten().count(),
            stopped: None,
            frame_failure: None,
        };
        let mut bake = self.input.bake();
        if let Some(saved) = &resumed {
            bake = bake.resume(&saved.file, saved.checkpoint.clone());
        }
        let outcome = bake.run_with(&mut recorder);
        let BakeRecorder { frames, checkpoints, stopped, frame_failure, .. } = recorder;
        self.checkpoints = checkpoints;
        if let Some(failure) = frame_failure {
            // What is there is not all of them.
            self.frames = None;
            self.record.told.push(failure.clone());
            self.record.warn([failure]);
        }
        match (outcome, stopped) {
            (Ok(mut baked), _) => {
                baked.report.decisions.extend(self.input.no_leash());
                let stale = frames.and_then(|frames| frames.stale_frame()).map(|path| {
                    format!("{} and any after it are from an earlier run with more frames", path.display())
                });
                Ok(Simulated::Finished { baked: Box::new(baked), stale_frames: stale })
            }
            (Err(Error::NotConverged(_)), Some(mut work)) if self.record.files.is_some() => {
                work.decisions.extend(self.input.no_leash());
                let last_frame = frames.and_then(|frames| frames.last_frame());
                Ok(Simulated::Stopped { work: Box::new(work), last_frame })
            }
            (Err(error), _) => Err(error),
        }
    }

    /// Outputs of a run that came to the end of its script; `start` are the crossings of the input.
    fn finished(
        mut self,
        baked: BakeResult,
        start: &[[u32; 2]],
        words: &dyn Vocabulary,
    ) -> Result<JobOutputs<Report>> {
        self.record.warn_of_failure(baked.report.inside_body_reason.clone().map(Message::from), words);
        self.record.warn_of_failure(baked.report.empty_reason.clone(), words);
        self.record.computed();
        let garment = &self.input.garment.mesh.garment;
        let counts = crossing_counts(garment, &baked.worn, start);
        let mut report = Report::of_bake(garment, &baked, counts, words);
        report.method = self.method().to_owned();
        let sidecar = self.sidecar(&baked)?;
        let BakeResult { worn, simulated, report: work, .. } = baked;
        let width = self.input.fabric.crease_width();
        let surface = self.record.output.shows_surface().then(|| {
            WornSurface::new(&GarmentSurface::without_texture(&simulated.garment), &simulated.worn, width)
        });
        let Self { record, input, frames, checkpoints, .. } = self;
        let mut outputs =
            JobOutputs::new(input.garment, input.fabric, Some((worn, sidecar)), report, record, words);
        (outputs.frames, outputs.checkpoints) = (frames, checkpoints);
        outputs.surface = surface.map_or_else(OnceCell::new, OnceCell::from);
        let name = outputs.name();
        let place = |text: &str| match name.is_empty() {
            true => String::new(),
            false => format!("; {text} is in {name}"),
        };
        outputs.converged = work.unconverged_reason.is_none();
        let unconverged = work.inside_body_reason.or(work.unconverged_reason);
        outputs.failure =
            work.not_performed.map(|failure| Error::NotPerformed(Box::new(failure))).or_else(|| {
                failure_of(
                    unconverged.map(|reason| Message::from(reason) + place("the unconverged result")),
                    work.empty_reason.map(|reason| reason + place("the result")),
                )
            });
        Ok(outputs)
    }

    /// Outputs of a run that ended before its script and made no garment.
    fn stopped(
        mut self,
        work: &BakeReport,
        last_frame: Option<PathBuf>,
        crossings_at_start: usize,
        words: &dyn Vocabulary,
    ) -> JobOutputs<Report> {
        let name = |path: &Path| output_name(path);
        let report = Report::of_stopped(&self.input.garment.mesh.garment, work, crossings_at_start, words);
        let mut report = Report { method: self.method().to_owned(), ..report };
        let stopped = report.stopped.get_or_insert_default();
        let checkpoint = self.checkpoints.as_ref().and_then(CheckpointFile::path);
        stopped.checkpoint = checkpoint.filter(|path| path.exists()).map(name);
        stopped.last_frame = last_frame.as_deref().map(name);
        let reason = format!("{}: {}", stopped.action, stopped.reason);
        let paths = self.record.files.as_ref().map(|files| files.paths.clone());
        let kept = [
            (", the report is in ", paths.as_ref().and_then(|paths| paths.report.as_deref()).map(name)),
            (", the last checkpoint in ", stopped.checkpoint.clone()),
            (", the last frame in ", stopped.last_frame.clone()),
        ];
        let mut text = format!("{reason}; no garment was made");
        for (what, file) in kept.iter().filter_map(|(what, file)| Some((what, file.as_ref()?))) {
            text += &format!("{what}{file}");
        }
        self.record.warn_of_failure(Some(reason.into()), words);
        if let Some(paths) = paths.filter(|paths| paths.worn.exists()) {
            self.record.warn([format!("{} is of an earlier run", name(&paths.worn))]);
        }
        let Self { record, input, .. } = self;
        let mut outputs = JobOutputs::new(input.garment, input.fabric, None, report, record, words);
        (outputs.failure, outputs.converged) = (Some(Error::NotConverged(text.into())), false);
        outputs
    }

    /// Name of the time integrator.
    fn method(&self) -> &'static str {
        self.input.options.step().method.name()
    }

    /// Returns the sidecar of the result.
    fn sidecar(&self, baked: &BakeResult) -> Result<Sidecar> {
        let sidecar = self.input.sidecar(&baked.worn, self.run_description(baked))?;
        let mesh = GarmentSurface::without_texture(&baked.simulated.garment);
        let (garment, width) = (&self.input.garment.mesh.garment, self.input.fabric.crease_width());
        let sidecar =
            sidecar.with_creases(&Crease::find(&mesh, &baked.simulated.worn.memory, garment, width))?;
        let has_own_mesh = baked.simulated.garment.triangles != self.input.garment.mesh.garment.triangles;
        match self.sidecar_of_simulated && has_own_mesh {
            true => sidecar.with_simulated(&baked.simulated.garment, &baked.simulated.worn),
            false => Ok(sidecar),
        }
    }

    /// Describes the run for the sidecar. It holds nothing that differs between repeated runs, whose sidecars are identical.
    fn run_description(&self, baked: &BakeResult) -> Value {
        let options = &self.input.options;
        let mut description = json!({
            "tool": TOOL,
            "method": self.method(),
            "quality": options.quality.name(),
            "memory": if options.memory { "on" } else { "off" },
            "simulated_s": baked.report.simulated,
            "steps": baked.report.steps,
        });
        if options.strength != 1.0 {
            description["strength"] = json!(options.strength);
        }
        if baked.report.points != baked.end.len() {
            description["simulated_points"] = json!(baked.report.points);
        }
        if let Some(earlier) = &self.input.earlier {
            description["earlier"] = earlier.origin.clone();
        }
        description
    }
}
