//! [`JobObserver`]: what a job reports while it runs; and the recorder of a bake, which writes frames and checkpoints.

use crate::bake::{BakeProgress, BakeReport, Checkpoint, Observer};
use crate::files::{CheckpointFile, FrameFolder};
use crease_geometry::math::Vec3;
use crease_model::error::{Error, LibraryWords, Result, Vocabulary};
use crease_model::garment::Garment;

/// Part of a bake job, as far as it decides what an interruption loses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobPhase {
    /// The simulation, whose steps ask [`Observer::should_stop`].
    Simulate,
    /// The relaxation to the source pose, whose start is in the checkpoint.
    Relax,
    /// The writing of the outputs.
    Write,
}

/// What a job reports at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobNotice<'a> {
    /// A warning before the computation, for which a long run may be stopped. It is in the report, too.
    Warning(&'a str),
    /// The garment begins with the memory in this sidecar.
    EarlierMemory(&'a str),
    /// A checkpoint cannot be written; the run continues without.
    NoCheckpoint(&'a str),
    /// A frame cannot be written; the run continues without. The warning is in the report, too.
    NoFrames(&'a str),
}

/// Receiver of what happens during a job. Every method has a default that does nothing; `()` observes nothing.
pub trait JobObserver: Observer {
    /// Called when a part of a bake job begins.
    fn phase(&mut self, _phase: JobPhase) {}

    /// Words of the front end for what messages hold as data.
    fn words(&self) -> &'static dyn Vocabulary {
        &LibraryWords
    }

    /// Called with a notice.
    fn notice(&mut self, _notice: JobNotice) {}
}

impl JobObserver for () {}

/// Recorder of one bake.
pub struct BakeRecorder<'a> {
    /// Observer of the job.
    pub observer: &'a mut dyn JobObserver,
    /// Folder of the frames, if they are asked for.
    pub frames: Option<FrameFolder>,
    /// Checkpoint file, if outputs are written.
    pub checkpoints: Option<CheckpointFile>,
    /// Whether the frames show the simulated mesh.
    pub frames_of_simulated: bool,
    /// Number of actions in the script.
    pub action_count: usize,
    /// Report of a run that ended before its script.
    pub stopped: Option<BakeReport>,
    /// Warning if the frames ended before the run, because one could not be written.
    pub frame_failure: Option<String>,
}

impl BakeRecorder<'_> {
    /// Writes the latest checkpoint.
    fn flush(&mut self) {
        if let Some(failure) = self.checkpoints.as_mut().and_then(CheckpointFile::flush) {
            self.observer.notice(JobNotice::NoCheckpoint(&failure));
        }
    }
}

impl Observer for BakeRecorder<'_> {
    fn progress(&mut self, now: &BakeProgress) {
        self.observer.progress(now);
    }

    fn on_mesh(&mut self, mesh: &Garment) {
        if let Some(frames) = self.frames.as_mut().filter(|_| self.frames_of_simulated) {
            frames.show_points(&mesh.triangles);
        }
    }

    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        let Some(frames) = &mut self.frames else { return Ok(()) };
        match frames.write(x) {
            // A full disk loses the frames, not the garment.
            Err(Error::File { file, source }) => {
                let failure = format!("{file}: {source}; the run continues without frames");
                self.observer.notice(JobNotice::NoFrames(&failure));
                (self.frames, self.frame_failure) = (None, Some(failure));
                Ok(())
            }
            other => other,
        }
    }

    fn on_early_stop(&mut self, report: &BakeReport) {
        self.flush();
        self.stopped = Some(report.clone());
    }

    fn wants_checkpoints(&self) -> bool {
        self.checkpoints.is_some()
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        let script_ended = now.position.action == self.action_count;
        if let Some(failure) = self.checkpoints.as_mut().and_then(|file| file.update(now)) {
            self.observer.notice(JobNotice::NoCheckpoint(&failure));
        }
        if script_ended {
            // The relaxation to the source pose has no steps to stop after; its start is saved here.
            self.flush();
            self.observer.phase(JobPhase::Relax);
        }
        Ok(())
    }

    fn should_stop(&mut self) -> bool {
        let stop = self.observer.should_stop();
        if stop {
            self.flush();
        }
        stop
    }
}
