//! Frames for the observer: evenly spaced in simulated time, while steps are not.

use crate::bake::tuning::TUNING;
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::intersections::self_intersections;
use crate::sim::State;
use serde::{Deserialize, Serialize};

/// Times of frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSchedule {
    /// Time between two frames [s]; infinite for no frames.
    #[serde(with = "crate::math::serde_vec::limit")]
    interval: f64,
    /// Simulated time of the next frame [s].
    #[serde(with = "crate::math::serde_vec::limit")]
    next: f64,
    /// Frames that the observer was given.
    pub shown: u64,
}

/// Receives the positions of a frame, one per point [m].
pub(super) type ShowFrame<'a> = dyn FnMut(&[Vec3]) -> Result<()> + 'a;

/// The state from which a step started.
pub(super) struct StepStart {
    /// Time [s].
    time: f64,
    /// Positions, one per point [m].
    positions: Vec<Vec3>,
}

impl FrameSchedule {
    /// A schedule of `per_second` frames per simulated second; of none for 0.
    pub(super) fn new(per_second: f64) -> Self {
        let interval = if per_second > 0.0 { 1.0 / per_second } else { f64::INFINITY };
        Self { interval, next: 0.0, shown: 0 }
    }

    /// Whether there are to be frames.
    pub(super) fn is_wanted(&self) -> bool {
        self.interval.is_finite()
    }

    /// The start of a step from `state`, if frames are wanted.
    pub(super) fn step_start(&self, state: &State) -> Option<StepStart> {
        self.is_wanted().then(|| StepStart { time: state.time, positions: state.x.clone() })
    }

    /// Shows the frames that the step from `start` to `state` passed. Positions between two accepted states are interpolated;
    /// where layers of `triangles` would cross in that, the later state is shown instead.
    pub(super) fn show_due(
        &mut self,
        start: &StepStart,
        state: &State,
        triangles: &[[PointIndex; 3]],
        show: &mut ShowFrame,
    ) -> Result<()> {
        let step = state.time - start.time;
        if self.interval < TUNING.stepping.min_frame_interval {
            return self.show(&state.x, show);
        }
        while self.next <= state.time + 1e-9 {
            let fraction = ((self.next - start.time) / step.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let between: Vec<Vec3> =
                start.positions.iter().zip(&state.x).map(|(a, b)| a + (b - a) * fraction).collect();
            let crossing = |x: &[Vec3]| self_intersections(x, triangles).len();
            let count = if fraction < 1.0 { crossing(&between) } else { 0 };
            let crosses = count > 0 && count > crossing(&state.x);
            self.show(if crosses { &state.x } else { &between }, show)?;
            self.next += self.interval;
        }
        Ok(())
    }

    /// Shows one frame.
    pub(super) fn show(&mut self, positions: &[Vec3], show: &mut ShowFrame) -> Result<()> {
        show(positions)?;
        self.shown += 1;
        Ok(())
    }
}
