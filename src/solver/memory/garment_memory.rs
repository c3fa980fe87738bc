//! [`Memory`]: the rest state of one garment in wear, with the timers of the memory law.

use crate::memory::{Band, EventCount, HysteresisState, MemoryLaw, MemoryModel, Strains, rest_smoothing};
use crease_model::garment::RestState;
use serde::{Deserialize, Serialize};

/// The part of a [`HysteresisState`] that is not in the [`RestState`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct BandTimer {
    band: Band,
    /// Time in that band [s].
    timer: f64,
    /// Time without load since the last event [s].
    idle: f64,
}

impl BandTimer {
    fn with_rest(self, rest: f64, stiffness_ratio: f64) -> HysteresisState {
        HysteresisState { rest, stiffness_ratio, band: self.band, timer: self.timer, idle: self.idle }
    }

    fn from_state(state: &HysteresisState) -> Self {
        Self { band: state.band, timer: state.timer, idle: state.idle }
    }
}

/// The memory of one garment in wear.
///
/// ```
/// use crease_model::garment::RestState;
/// use crease_solver::memory::Memory;
/// let memory = Memory::new(RestState::flat(3, 2));
/// assert!(memory.fits(3, 2) && memory.rest.stiffness_ratio == [1.0; 3]);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// The rest state that was earned: the result of a bake.
    pub rest: RestState,
    /// The rest state in the energies: `rest` with a first-order lag behind its last events.
    pub effective_rest: RestState,
    /// The rest state that it began with, where that was not the one of new cloth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<RestState>,
    /// Number of events so far.
    pub events: EventCount,
    hinge: Vec<BandTimer>,
    warp: Vec<BandTimer>,
    weft: Vec<BandTimer>,
}

impl Memory {
    /// The memory of new cloth with the rest state `rest`.
    pub fn new(rest: RestState) -> Self {
        let hinges = rest.rest_angle.len();
        let triangles = rest.rest_stretch_warp.len();
        let idle = BandTimer::default();
        Self {
            effective_rest: rest.clone(),
            rest,
            start: None,
            events: EventCount::default(),
            hinge: vec![idle; hinges],
            warp: vec![idle; triangles],
            weft: vec![idle; triangles],
        }
    }

    /// The memory of cloth that was worn before and begins with the rest state `rest`; its timers are at zero.
    pub fn of_worn(rest: RestState) -> Self {
        Self { start: Some(rest.clone()), ..Self::new(rest) }
    }

    /// Resets to new cloth with the initial angles, timers at zero and no events.
    pub fn reset(&mut self) {
        let source = std::mem::take(&mut self.rest.source_angle);
        *self = Self::new(RestState::new(source, self.rest.rest_stretch_warp.len()));
    }

    /// Whether it belongs to cloth with so many hinges and triangles.
    pub fn fits(&self, hinge_count: usize, triangle_count: usize) -> bool {
        let start = self.start.as_ref().is_none_or(|start| start.fits(hinge_count, triangle_count));
        start
            && self.rest.fits(hinge_count, triangle_count)
            && self.hinge.len() == hinge_count
            && [&self.warp, &self.weft].iter().all(|timers| timers.len() == triangle_count)
    }

    /// The memory on a finer mesh whose hinges and triangles are parts of these: per hinge of it the hinge here (`None` for one
    /// that is flat and new), per triangle the triangle here.
    ///
    /// # Panics
    /// If a number is not one of a hinge or triangle here.
    pub fn on_refined(&self, hinges: &[Option<u32>], triangles: &[u32]) -> Self {
        let angles =
            |of: &[f64], new: f64| hinges.iter().map(|h| h.map_or(new, |h| of[h as usize])).collect();
        let stretches = |of: &[f64]| triangles.iter().map(|f| of[*f as usize]).collect();
        let rest = |of: &RestState| RestState {
            source_angle: angles(&of.source_angle, 0.0),
            rest_angle: angles(&of.rest_angle, 0.0),
            stiffness_ratio: angles(&of.stiffness_ratio, 1.0),
            rest_stretch_warp: stretches(&of.rest_stretch_warp),
            rest_stretch_weft: stretches(&of.rest_stretch_weft),
        };
        let timers = |of: &[BandTimer]| triangles.iter().map(|f| of[*f as usize]).collect();
        Self {
            rest: rest(&self.rest),
            effective_rest: rest(&self.effective_rest),
            start: self.start.as_ref().map(rest),
            events: self.events,
            hinge: hinges
                .iter()
                .map(|h| h.map_or(BandTimer::default(), |h| self.hinge[h as usize]))
                .collect(),
            warp: timers(&self.warp),
            weft: timers(&self.weft),
        }
    }

    /// Applies the law of `model` to a step of `duration` [s] with the strains `before` and `after` it, and lets
    /// `effective_rest` follow. Returns the events of the step.
    ///
    /// # Panics
    /// If the lists of `model` or of the strains are shorter than those of the rest state.
    pub fn commit(
        &mut self,
        model: &MemoryModel,
        before: &Strains,
        after: &Strains,
        duration: f64,
    ) -> EventCount {
        let mut count = self.commit_angles(model, before, after, duration);
        if let Some(law) = &model.length {
            count += self.commit_stretches(model, law, before, after, duration);
        }
        self.events += count;
        rest_smoothing::follow(&mut self.effective_rest, &self.rest, duration);
        count
    }

    /// Restarts the timers of a hinge whose rest angle was set.
    pub(super) fn restart_hinge(&mut self, hinge: usize) {
        self.hinge[hinge] = BandTimer::default();
    }

    fn commit_angles(
        &mut self,
        model: &MemoryModel,
        before: &Strains,
        after: &Strains,
        duration: f64,
    ) -> EventCount {
        let mut count = EventCount::default();
        let rest = &mut self.rest;
        let bend = |h: usize| {
            let source = rest.source_angle[h];
            let [now, kept] = [after.angle[h], rest.rest_angle[h]].map(|angle| angle - source);
            if kept.abs() > now.abs() { kept } else { now }
        };
        let gains: Vec<f64> = (0..self.hinge.len()).map(|h| model.gain(h, bend)).collect();
        for (h, timer) in self.hinge.iter_mut().enumerate() {
            let mut state = timer.with_rest(rest.rest_angle[h], rest.stiffness_ratio[h]);
            let params = model.hinge_params(h, rest.source_angle[h], gains[h]);
            count += model.angle.advance(&mut state, before.angle[h], after.angle[h], duration, &params);
            rest.rest_angle[h] = state.rest;
            rest.stiffness_ratio[h] = state.stiffness_ratio;
            *timer = BandTimer::from_state(&state);
        }
        count
    }

    fn commit_stretches(
        &mut self,
        model: &MemoryModel,
        law: &MemoryLaw,
        before: &Strains,
        after: &Strains,
        duration: f64,
    ) -> EventCount {
        let mut count = EventCount::default();
        // Whoever measures angles only has no lengths to remember.
        if before.stretch.is_empty() || after.stretch.is_empty() {
            return count;
        }
        let axes = [
            (&mut self.rest.rest_stretch_warp, &mut self.warp, 0),
            (&mut self.rest.rest_stretch_weft, &mut self.weft, 1),
        ];
        for (rest, timers, axis) in axes {
            for (f, timer) in timers.iter_mut().enumerate() {
                let mut state = timer.with_rest(rest[f], 1.0);
                // Compressed cloth buckles and does not shorten: strain below rest counts as none.
                let at = |stretch: &[[f64; 3]]| stretch[f][axis].max(rest[f]);
                let (from, to) = (at(before.stretch), at(after.stretch));
                count += law.advance(&mut state, from, to, duration, &model.stretch_params(f));
                rest[f] = state.rest;
                *timer = BandTimer::from_state(&state);
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Vec3;

    use crease_model::fabric::Fabric;
    use crease_model::garment::Garment;

    fn t_shirt() -> Fabric {
        Fabric::preset("kow-tshirt").unwrap()
    }

    /// A strip of triangles with two hinges, of which the second has a masked point.
    fn half_masked() -> Garment {
        let points = (0..5).map(|k| Vec3::new(f64::from(k / 2), 0.0, f64::from(k % 2))).collect();
        let strip = Garment::of_triangles(points, &[[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        let mut memory_mask = vec![1.0; strip.points.len()];
        let hinges = &strip.topology.hinges;
        for p in &hinges[1].points[..2] {
            memory_mask[p.at()] = if hinges[0].points[..2].contains(p) { 1.0 } else { 0.0 };
        }
        Garment { memory_mask, ..strip }
    }

    #[test]
    fn a_masked_hinge_keeps_its_rest_angle_and_its_neighbour_does_not() {
        let garment = half_masked();
        let mut memory = Memory::new(RestState::flat(2, 3));
        let strains = Strains::of_angles(&[2.5, 2.5]);
        let model = MemoryModel::new(&garment, &t_shirt(), &[1.0, 1.0], t_shirt().memory.reference_length());
        let count = memory.commit(&model, &strains, &strains, 5.0);
        assert!(count.critical >= 1);
        assert!(memory.rest.rest_angle[0] > 1.0);
        assert_eq!(memory.rest.rest_angle[1], 0.0);
    }

    #[test]
    fn a_fine_hinge_earns_the_same_curvature_at_a_smaller_angle() {
        // Half the reference length of 10 mm, half the angle: the same condition, half the change of angle.
        let rest = [(1.6, 0.01), (0.8, 0.005)].map(|(angle, width)| {
            let mut memory = Memory::new(RestState::flat(1, 0));
            let angle = [angle];
            let strains = Strains::of_angles(&angle);
            memory.commit(&MemoryModel::for_hinges(&t_shirt(), &[width]), &strains, &strains, 30.0);
            memory.rest
        });
        let [coarse, fine] = rest;
        assert!(coarse.rest_angle[0] > 0.5);
        assert!((coarse.rest_angle[0] - 2.0 * fine.rest_angle[0]).abs() < 1e-12);
        assert!((coarse.stiffness_ratio[0] - fine.stiffness_ratio[0]).abs() < 1e-12);
    }
}
