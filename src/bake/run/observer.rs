//! Observation of a bake: progress, frames, checkpoints and the request to stop.

use crate::bake::{BakeReport, Checkpoint};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::Garment;
use crease_solver::memory::EventCount;

/// Progress of a bake after a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BakeProgress<'a> {
    /// Name of the current action.
    pub stage: &'a str,
    /// Simulated time [s].
    pub time: f64,
    /// Simulated time at the end of the script [s].
    pub total: f64,
    /// Steps made.
    pub steps: u64,
    /// Length of the last step [s].
    pub step: f64,
    /// Linear solves of the last step.
    pub iterations: usize,
    /// Memory events so far.
    pub events: EventCount,
}

/// Receives what happens during a bake. Every method has a default that does nothing; `()` observes nothing.
///
/// ```
/// use crease::Observer;
/// struct StepCounter(u64);
/// impl Observer for StepCounter {
///     fn progress(&mut self, now: &crease::BakeProgress) {
///         self.0 = now.steps;
///     }
/// }
/// assert!(!StepCounter(0).should_stop());
/// ```
pub trait Observer {
    /// Called after every step.
    fn progress(&mut self, _progress: &BakeProgress) {}

    /// Called before the first step with the mesh whose points the frames are of: the garment, or the simulated mesh if that was
    /// asked for ([`crate::bake::BakeOptions::frames_of_simulated`]), and then again when that is refined.
    fn on_mesh(&mut self, _mesh: &Garment) {}

    /// Called when a frame is due, with one position per point of that mesh [m]. An error ends the bake.
    fn frame(&mut self, _x: &[Vec3]) -> Result<()> {
        Ok(())
    }

    /// Called when the run ends before the end of its script, as it cannot recover: with what is known until there, and
    /// [`BakeReport::stopped`]. The bake then fails with [`crease_model::error::Error::NotConverged`].
    fn on_early_stop(&mut self, _report: &BakeReport) {}

    /// Whether [`Observer::checkpoint`] is called.
    fn wants_checkpoints(&self) -> bool {
        false
    }

    /// Called with a state from which the run can be resumed: before every action, after the last, and every few steps
    /// between ([`crate::bake::BakeOptions::checkpoint_steps`]). An error ends the bake.
    fn checkpoint(&mut self, _now: Checkpoint) -> Result<()> {
        Ok(())
    }

    /// Whether the bake stops here with [`crease_model::error::Error::Interrupted`]; asked after every step.
    fn should_stop(&mut self) -> bool {
        false
    }
}

impl Observer for () {}
