//! Observer of a bake: progress, frames, checkpoints and interruption.

use crate::files::checkpoints::CheckpointFile;
use crate::files::frame_folder::FrameFolder;
use crate::runtime::interrupt::Interrupt;
use crate::runtime::progress::{Progress, StepProgress};
use crease::internal::bake::{BakeReport, Checkpoint, Observer};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::Garment;

/// Observer that connects a bake with the terminal and the file system.
pub struct BakeObserver<'a, 'b> {
    /// Progress display.
    pub progress: &'a mut Progress,
    /// Folder of the frames, if they were asked for.
    pub frames: Option<FrameFolder<'b>>,
    /// Checkpoint file.
    pub checkpoints: &'a mut CheckpointFile,
    /// Signal handlers.
    pub interrupt: &'a Interrupt,
    /// Whether the frames show the simulated mesh.
    pub frames_of_simulated: bool,
    /// Number of actions in the script.
    pub action_count: usize,
    /// Report of a run that ended before its script.
    pub stopped: Option<BakeReport>,
}

impl Observer for BakeObserver<'_, '_> {
    fn progress(&mut self, now: &crease::internal::bake::BakeProgress) {
        self.progress.step(
            now.stage,
            StepProgress {
                simulated_s: now.time,
                total_s: now.total,
                step: now.steps,
                events: now.events.gradual + now.events.critical,
            },
        );
    }

    fn on_mesh(&mut self, mesh: &Garment) {
        if let Some(frames) = self.frames.as_mut().filter(|_| self.frames_of_simulated) {
            frames.show_points(&mesh.triangles);
        }
    }

    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        self.frames.as_mut().map_or(Ok(()), |frames| frames.write(x))
    }

    fn on_early_stop(&mut self, report: &BakeReport) {
        self.checkpoints.flush();
        self.stopped = Some(report.clone());
    }

    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        let script_ended = now.position.action == self.action_count;
        self.checkpoints.update(now);
        if script_ended {
            // The relaxation to the source pose has no steps to stop after; its start is saved here.
            self.checkpoints.flush();
            self.interrupt.set_exit_immediately(true);
        }
        Ok(())
    }

    fn should_stop(&mut self) -> bool {
        if !self.interrupt.is_requested() {
            return false;
        }
        self.checkpoints.flush();
        true
    }
}
