//! After an accepted step: the cloth remembers.
//!
//! [`Memory::commit`] is the only place that writes a [`RestState`]. Energies and the solver read it; a step that
//! was rejected never reaches this module. The law itself is `fabric::MemoryLaw`; here it is applied to every hinge
//! (condition: angle beyond the rest angle, measured against the reference length on fine meshes) and, where the
//! fabric has length ratios, to both axes of every triangle (condition: strain beyond the rest stretch).
//!
//! An event changes what is remembered at once, but enters the forces smoothly: energies read [`Memory::effective_rest`], which
//! follows [`Memory::rest`] within a fifth of a second. What is baked and written to files is `shape`.

mod law;
mod rest_smoothing;

pub use law::{Band, BandParams, ElementParams, EventCount, HysteresisState, MemoryLaw};

use crate::fabric::Fabric;
use crate::garment::{Garment, RestState};
use serde::{Deserialize, Serialize};

/// What of a state is not part of the rest shape.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct BandTimer {
    band: Band,
    /// Time in that band [s].
    timer: f64,
    /// Time without load since the last event [s].
    idle: f64,
}

impl BandTimer {
    fn state(self, rest: f64, stiffness: f64) -> HysteresisState {
        HysteresisState { rest, stiffness, band: self.band, timer: self.timer, idle: self.idle }
    }

    fn of(state: &HysteresisState) -> Self {
        Self { band: state.band, timer: state.timer, idle: state.idle }
    }
}

/// The memory of one garment in wear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What is remembered: what comes out of a bake.
    pub rest: RestState,
    /// What the energies read: `shape`, with events of the last moments on their way in.
    pub effective_rest: RestState,
    /// Events so far.
    pub events: EventCount,
    frozen: bool,
    hinge: Vec<BandTimer>,
    warp: Vec<BandTimer>,
    weft: Vec<BandTimer>,
}

/// The fabric's law with the per-element numbers of one garment; nothing in it changes during a run.
#[derive(Debug, Clone)]
pub struct MemoryModel {
    angle: MemoryLaw,
    length: Option<MemoryLaw>,
    /// Per hinge: L / min(w, L).
    gain: Vec<f64>,
    /// Per hinge and per triangle: 0..1, scales what events change.
    hinge_mask: Vec<f64>,
    triangle_mask: Vec<f64>,
}

impl MemoryModel {
    /// The law of `fabric` on `garment` whose hinges stand for `width` [m] of cloth each.
    pub fn new(garment: &Garment, fabric: &Fabric, width: &[f64]) -> Self {
        let memory = &fabric.memory;
        let (angle, length) = (MemoryLaw::for_angles(memory), MemoryLaw::for_lengths(memory));
        let reference = memory.reference_length();
        let least = |points: &mut dyn Iterator<Item = usize>| {
            points.map(|p| garment.memory_mask[p]).fold(1.0, f64::min).clamp(0.0, 1.0)
        };
        Self {
            angle,
            length,
            gain: width.iter().map(|w| reference / w.min(reference)).collect(),
            hinge_mask: garment
                .topology
                .hinges
                .iter()
                .map(|h| least(&mut h.points[..2].iter().map(|p| p.at())))
                .collect(),
            triangle_mask: garment.triangles.iter().map(|t| least(&mut t.iter().map(|p| p.at()))).collect(),
        }
    }

    /// How long a step may be after one with these `events` [s]: the `share` of the time to another; infinite after none.
    /// Where something has worn in, more will, and the cloth must have answered one event before the next is due.
    pub fn max_dt_after_events(&self, events: EventCount, share: f64) -> f64 {
        let laws = [Some(&self.angle), self.length.as_ref()].into_iter().flatten();
        let bands = laws.flat_map(|law| [(events.gradual, law.gradual), (events.critical, law.critical)]);
        let due = bands.filter(|(count, _)| *count > 0).map(|(_, band)| band.duration);
        share * due.fold(f64::INFINITY, f64::min)
    }

    /// Whether lengths are remembered.
    pub fn remembers_length(&self) -> bool {
        self.length.is_some()
    }
}

/// Angles and stretches of an accepted state.
pub struct Strains<'a> {
    /// One per hinge: unwrapped angle [rad].
    pub angle: &'a [f64],
    /// One per triangle: |w_u|, |w_v|, w_u.w_v [-]; may be empty when lengths are not remembered.
    pub stretch: &'a [[f64; 3]],
}

impl Memory {
    /// Memory of new cloth.
    pub fn new(rest: RestState) -> Self {
        let hinges = rest.rest_angle.len();
        let triangles = rest.rest_stretch_warp.len();
        let idle = BandTimer::default();
        Self {
            effective_rest: rest.clone(),
            rest,
            events: EventCount::default(),
            frozen: false,
            hinge: vec![idle; hinges],
            warp: vec![idle; triangles],
            weft: vec![idle; triangles],
        }
    }

    /// Forgets everything: new cloth of the source's own angles, no timer running, no event counted. Stays frozen if
    /// it was.
    pub fn reset(&mut self) {
        let source = std::mem::take(&mut self.rest.source_angle);
        let shape = RestState::new(source, self.rest.rest_stretch_warp.len());
        *self = Self { frozen: self.frozen, ..Self::new(shape) };
    }

    /// Whether the cloth keeps what it has and remembers nothing new. Timers start anew after a freeze.
    pub fn freeze(&mut self, frozen: bool) {
        self.frozen = frozen;
        for running in [&mut self.hinge, &mut self.warp, &mut self.weft] {
            running.iter_mut().for_each(|r| *r = BandTimer { idle: r.idle, ..BandTimer::default() });
        }
    }

    /// Whether it is frozen.
    pub fn is_frozen(&self) -> bool {
        self.frozen
    }

    /// Whether it is of cloth with so many hinges and triangles.
    pub fn fits(&self, hinge_count: usize, triangle_count: usize) -> bool {
        let shape = &self.rest;
        let hinges =
            [shape.source_angle.len(), shape.rest_angle.len(), shape.stiffness_ratio.len(), self.hinge.len()];
        let triangles =
            [shape.rest_stretch_warp.len(), shape.rest_stretch_weft.len(), self.warp.len(), self.weft.len()];
        hinges.iter().all(|n| *n == hinge_count) && triangles.iter().all(|n| *n == triangle_count)
    }

    /// Writes what a step of `duration` [s] from `before` to `after` leaves in the cloth.
    pub fn commit(
        &mut self,
        law: &MemoryModel,
        before: &Strains,
        after: &Strains,
        duration: f64,
    ) -> EventCount {
        let mut count = EventCount::default();
        if self.frozen {
            rest_smoothing::follow(&mut self.effective_rest, &self.rest, duration);
            return count;
        }
        let shape = &mut self.rest;
        for (h, running) in self.hinge.iter_mut().enumerate() {
            let mut state = running.state(shape.rest_angle[h], shape.stiffness_ratio[h]);
            let element = ElementParams {
                initial_rest: shape.source_angle[h],
                gain: law.gain[h],
                mask: law.hinge_mask[h],
            };
            count += law.angle.advance(&mut state, before.angle[h], after.angle[h], duration, &element);
            shape.rest_angle[h] = state.rest;
            shape.stiffness_ratio[h] = state.stiffness;
            *running = BandTimer::of(&state);
        }
        if let Some(length) = &law.length {
            let axes = [
                (&mut shape.rest_stretch_warp, &mut self.warp, 0),
                (&mut shape.rest_stretch_weft, &mut self.weft, 1),
            ];
            for (rest, timers, axis) in axes {
                for (f, running) in timers.iter_mut().enumerate() {
                    let mut state = running.state(rest[f], 1.0);
                    // Compressed cloth buckles, it does not shorten: strain below rest counts as none.
                    let at = |stretch: &[[f64; 3]]| stretch[f][axis].max(rest[f]);
                    let (from, to) = (at(before.stretch), at(after.stretch));
                    let element = ElementParams { initial_rest: 1.0, gain: 1.0, mask: law.triangle_mask[f] };
                    count += length.advance(&mut state, from, to, duration, &element);
                    rest[f] = state.rest;
                    *running = BandTimer::of(&state);
                }
            }
        }
        self.events += count;
        rest_smoothing::follow(&mut self.effective_rest, &self.rest, duration);
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabric::Fabric;

    fn law(hinges: usize, gain: f64) -> MemoryModel {
        let fabric = Fabric::preset("kow-tshirt").unwrap();
        MemoryModel {
            angle: MemoryLaw::for_angles(&fabric.memory),
            length: None,
            gain: vec![gain; hinges],
            hinge_mask: vec![1.0, 0.0],
            triangle_mask: Vec::new(),
        }
    }

    #[test]
    fn a_masked_hinge_keeps_its_rest_angle_and_its_neighbour_does_not() {
        let mut memory = Memory::new(RestState::flat(2, 0));
        let angle = [2.5, 2.5];
        let seen = Strains { angle: &angle, stretch: &[] };
        let count = memory.commit(&law(2, 1.0), &seen, &seen, 5.0);
        assert!(count.critical >= 1);
        assert!(memory.rest.rest_angle[0] > 1.0);
        assert_eq!(memory.rest.rest_angle[1], 0.0);
    }

    #[test]
    fn a_fine_hinge_earns_the_same_curvature_at_a_smaller_angle() {
        // Half the width, half the angle: the same condition, half the change of angle.
        let (mut coarse, mut fine) = (Memory::new(RestState::flat(2, 0)), Memory::new(RestState::flat(2, 0)));
        let (wide, narrow) = ([1.6, 0.0], [0.8, 0.0]);
        for (memory, angle, gain) in [(&mut coarse, &wide, 1.0), (&mut fine, &narrow, 2.0)] {
            let seen = Strains { angle, stretch: &[] };
            memory.commit(&law(2, gain), &seen, &seen, 30.0);
        }
        assert!(coarse.rest.rest_angle[0] > 0.5);
        assert!((coarse.rest.rest_angle[0] - 2.0 * fine.rest.rest_angle[0]).abs() < 1e-12);
        assert!((coarse.rest.stiffness_ratio[0] - fine.rest.stiffness_ratio[0]).abs() < 1e-12);
    }
}
