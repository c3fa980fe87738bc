//! Frames for the observer: evenly spaced in simulated time, while steps are not.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::error::{Message, Result, Setting};
use crease_solver::sim::State;
use serde::{Deserialize, Serialize};

/// Time after the end of a step up to which a frame is still of that step [s]: rounding.
const END_TOL: f64 = 1e-9;

/// Times of frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSchedule {
    /// Time between two frames [s]; infinite for no frames.
    #[serde(with = "crease_geometry::math::serde_vec::limit")]
    interval: f64,
    /// Simulated time of the next frame [s].
    #[serde(with = "crease_geometry::math::serde_vec::limit")]
    next: f64,
    /// Frames that the observer was given.
    pub shown: u64,
    /// Those in which the garment lies far from the simulated mesh somewhere.
    #[serde(default)]
    pub far: u64,
    /// Largest distance between the two [m].
    #[serde(default)]
    pub max_distance: f64,
}

/// Receives the positions of a frame, one per point of the simulated mesh [m]; returns the largest distance between that and what is
/// shown [m].
pub(in crate::bake) type ShowFrame<'a> = dyn FnMut(&[Vec3]) -> Result<f64> + 'a;

/// The state from which a step started.
pub(in crate::bake) struct StepStart {
    /// Time [s].
    pub(in crate::bake) time: f64,
    /// Positions, one per point [m].
    pub(in crate::bake) positions: Vec<Vec3>,
}

impl FrameSchedule {
    /// A schedule of `per_second` frames per simulated second; of none for 0.
    pub(in crate::bake) fn new(per_second: f64) -> Self {
        let interval = if per_second > 0.0 { 1.0 / per_second } else { f64::INFINITY };
        Self { interval, next: 0.0, shown: 0, far: 0, max_distance: 0.0 }
    }

    /// Whether there are to be frames.
    pub(in crate::bake) fn is_wanted(&self) -> bool {
        self.interval.is_finite()
    }

    /// The start of a step from `state`, if frames are wanted.
    pub(in crate::bake) fn step_start(&self, state: &State) -> Option<StepStart> {
        self.is_wanted().then(|| StepStart { time: state.time, positions: state.x.clone() })
    }

    /// Fractions of the step from `start` to `end` [s] at which frames are due.
    pub(in crate::bake) fn due(&self, start: f64, end: f64) -> Vec<f64> {
        let (mut all, mut next) = (Vec::new(), self.next);
        if self.interval < TUNING.stepping.min_frame_interval {
            return all;
        }
        while next <= end + END_TOL {
            all.push(((next - start) / (end - start).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0));
            next += self.interval;
        }
        all
    }

    /// Shows the frames that the step from `start` to `state` passed. Positions between two accepted states are interpolated, and
    /// moved by `offsets`, one list per frame that is due, where there are some; where layers of `triangles` would cross in that, without
    /// the offsets, and where they would cross even so, the later state is shown instead.
    pub(in crate::bake) fn show_due(
        &mut self,
        start: &StepStart,
        state: &State,
        triangles: &[[PointIndex; 3]],
        offsets: &[Vec<Vec3>],
        show: &mut ShowFrame,
    ) -> Result<()> {
        if self.interval < TUNING.stepping.min_frame_interval {
            return self.show(&state.x, show);
        }
        let crossing = |x: &[Vec3]| self_intersections(x, triangles).len();
        for (k, fraction) in self.due(start.time, state.time).into_iter().enumerate() {
            let chord: Vec<Vec3> =
                start.positions.iter().zip(&state.x).map(|(a, b)| a + (b - a) * fraction).collect();
            let carried: Option<Vec<Vec3>> = offsets
                .get(k)
                .map(|offsets| chord.iter().zip(offsets).map(|(x, offset)| x + offset).collect());
            let is_sound = |x: &&Vec<Vec3>| {
                let count = if fraction < 1.0 { crossing(x) } else { 0 };
                count == 0 || count <= crossing(&state.x)
            };
            let between = carried.as_ref().filter(is_sound).or(Some(&chord).filter(is_sound));
            self.show(between.unwrap_or(&state.x), show)?;
            self.next += self.interval;
        }
        Ok(())
    }

    /// The warning that some frames lie far from the simulated mesh; `None` if none does.
    pub(in crate::bake) fn warning(&self) -> Option<Message> {
        let Self { far, shown, max_distance, .. } = *self;
        (far > 0).then(|| {
            let what = format!(
                "the garment's own triangles are too coarse for its folds in {far} of {shown} frames: so that they do not cross, they lie up to \
                 {:.0} mm from the simulated mesh (",
                1e3 * max_distance
            );
            Message::from(what) + Setting::FramesOf.to("simulated") + ")"
        })
    }

    /// Shows one frame.
    pub(in crate::bake) fn show(&mut self, positions: &[Vec3], show: &mut ShowFrame) -> Result<()> {
        let distance = show(positions)?;
        self.shown += 1;
        self.far += u64::from(distance > TUNING.follow.max_distance);
        self.max_distance = self.max_distance.max(distance);
        Ok(())
    }
}
