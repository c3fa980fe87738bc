//! After an accepted step: the cloth remembers.
//!
//! [`Memory::commit`] is the only place that writes a [`RestShape`]. Energies and the solver read it; a step that
//! was rejected never reaches this module. The law itself is `fabric::Law`; here it is applied to every hinge
//! (condition: angle beyond the rest angle, measured against the reference length on fine meshes) and, where the
//! fabric has length ratios, to both axes of every triangle (condition: strain beyond the rest stretch).
//!
//! An event changes what is remembered at once, but enters the forces smoothly: energies read [`Memory::felt`], which
//! follows [`Memory::shape`] within a fifth of a second. What is baked and written to files is `shape`.

mod rest_smoothing;

use crate::fabric::{Element, EventCount, Fabric, Law, Trace, Zone};
use crate::garment::{Garment, RestShape};
use serde::{Deserialize, Serialize};

/// What of a trace is not part of the rest shape.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Running {
    zone: Zone,
    /// Time in that band [s].
    timer: f64,
    /// Time without load since the last event [s].
    idle: f64,
}

impl Running {
    fn trace(self, rest: f64, stiffness: f64) -> Trace {
        Trace { rest, stiffness, zone: self.zone, timer: self.timer, idle: self.idle }
    }

    fn of(trace: &Trace) -> Self {
        Self { zone: trace.zone, timer: trace.timer, idle: trace.idle }
    }
}

/// The memory of one garment in wear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What is remembered: what comes out of a bake.
    pub shape: RestShape,
    /// What the energies read: `shape`, with events of the last moments on their way in.
    pub felt: RestShape,
    /// Events so far.
    pub events: EventCount,
    frozen: bool,
    hinge: Vec<Running>,
    warp: Vec<Running>,
    weft: Vec<Running>,
}

/// The fabric's law with the per-element numbers of one garment; nothing in it changes during a run.
#[derive(Debug, Clone)]
pub struct Remembering {
    angle: Law,
    length: Option<Law>,
    /// Per hinge: L / min(w, L).
    gain: Vec<f64>,
    /// Per hinge and per triangle: 0..1, scales what events change.
    hinge_mask: Vec<f64>,
    triangle_mask: Vec<f64>,
}

impl Remembering {
    /// The law of `fabric` on `garment` whose hinges stand for `width` [m] of cloth each.
    pub fn new(garment: &Garment, fabric: &Fabric, width: &[f64]) -> Self {
        let memory = &fabric.memory;
        let (angle, length) = (memory.angle_law(), memory.length_law());
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
    pub fn longest_step_after(&self, events: EventCount, share: f64) -> f64 {
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
pub struct Observed<'a> {
    /// One per hinge: unwrapped angle [rad].
    pub angle: &'a [f64],
    /// One per triangle: |w_u|, |w_v|, w_u.w_v [-]; may be empty when lengths are not remembered.
    pub stretch: &'a [[f64; 3]],
}

impl Memory {
    /// Memory of new cloth.
    pub fn new(shape: RestShape) -> Self {
        let hinges = shape.rest_angle.len();
        let triangles = shape.rest_stretch_warp.len();
        let idle = Running::default();
        Self {
            felt: shape.clone(),
            shape,
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
        let source = std::mem::take(&mut self.shape.source_angle);
        let shape = RestShape::new(source, self.shape.rest_stretch_warp.len());
        *self = Self { frozen: self.frozen, ..Self::new(shape) };
    }

    /// Whether the cloth keeps what it has and remembers nothing new. Timers start anew after a freeze.
    pub fn freeze(&mut self, frozen: bool) {
        self.frozen = frozen;
        for running in [&mut self.hinge, &mut self.warp, &mut self.weft] {
            running.iter_mut().for_each(|r| *r = Running { idle: r.idle, ..Running::default() });
        }
    }

    /// Whether it is frozen.
    pub fn is_frozen(&self) -> bool {
        self.frozen
    }

    /// Whether it is of cloth with so many hinges and triangles.
    pub fn fits(&self, hinge_count: usize, triangle_count: usize) -> bool {
        let shape = &self.shape;
        let hinges =
            [shape.source_angle.len(), shape.rest_angle.len(), shape.stiffness_ratio.len(), self.hinge.len()];
        let triangles =
            [shape.rest_stretch_warp.len(), shape.rest_stretch_weft.len(), self.warp.len(), self.weft.len()];
        hinges.iter().all(|n| *n == hinge_count) && triangles.iter().all(|n| *n == triangle_count)
    }

    /// Writes what a step of `duration` [s] from `before` to `after` leaves in the cloth.
    pub fn commit(
        &mut self,
        law: &Remembering,
        before: &Observed,
        after: &Observed,
        duration: f64,
    ) -> EventCount {
        let mut count = EventCount::default();
        if self.frozen {
            rest_smoothing::follow(&mut self.felt, &self.shape, duration);
            return count;
        }
        let shape = &mut self.shape;
        for (h, running) in self.hinge.iter_mut().enumerate() {
            let mut trace = running.trace(shape.rest_angle[h], shape.stiffness_ratio[h]);
            let element = Element { home: shape.source_angle[h], gain: law.gain[h], mask: law.hinge_mask[h] };
            count += law.angle.advance(&mut trace, before.angle[h], after.angle[h], duration, &element);
            shape.rest_angle[h] = trace.rest;
            shape.stiffness_ratio[h] = trace.stiffness;
            *running = Running::of(&trace);
        }
        if let Some(length) = &law.length {
            let axes = [
                (&mut shape.rest_stretch_warp, &mut self.warp, 0),
                (&mut shape.rest_stretch_weft, &mut self.weft, 1),
            ];
            for (rest, timers, axis) in axes {
                for (f, running) in timers.iter_mut().enumerate() {
                    let mut trace = running.trace(rest[f], 1.0);
                    // Compressed cloth buckles, it does not shorten: strain below rest counts as none.
                    let at = |stretch: &[[f64; 3]]| stretch[f][axis].max(rest[f]);
                    let (from, to) = (at(before.stretch), at(after.stretch));
                    let element = Element { home: 1.0, gain: 1.0, mask: law.triangle_mask[f] };
                    count += length.advance(&mut trace, from, to, duration, &element);
                    rest[f] = trace.rest;
                    *running = Running::of(&trace);
                }
            }
        }
        self.events += count;
        rest_smoothing::follow(&mut self.felt, &self.shape, duration);
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabric::Fabric;

    fn law(hinges: usize, gain: f64) -> Remembering {
        let fabric = Fabric::preset("kow-tshirt").unwrap();
        Remembering {
            angle: fabric.memory.angle_law(),
            length: None,
            gain: vec![gain; hinges],
            hinge_mask: vec![1.0, 0.0],
            triangle_mask: Vec::new(),
        }
    }

    #[test]
    fn a_masked_hinge_keeps_its_rest_angle_and_its_neighbour_does_not() {
        let mut memory = Memory::new(RestShape::flat(2, 0));
        let angle = [2.5, 2.5];
        let seen = Observed { angle: &angle, stretch: &[] };
        let count = memory.commit(&law(2, 1.0), &seen, &seen, 5.0);
        assert!(count.critical >= 1);
        assert!(memory.shape.rest_angle[0] > 1.0);
        assert_eq!(memory.shape.rest_angle[1], 0.0);
    }

    #[test]
    fn a_fine_hinge_earns_the_same_curvature_at_a_smaller_angle() {
        // Half the width, half the angle: the same condition, half the change of angle.
        let (mut coarse, mut fine) = (Memory::new(RestShape::flat(2, 0)), Memory::new(RestShape::flat(2, 0)));
        let (wide, narrow) = ([1.6, 0.0], [0.8, 0.0]);
        for (memory, angle, gain) in [(&mut coarse, &wide, 1.0), (&mut fine, &narrow, 2.0)] {
            let seen = Observed { angle, stretch: &[] };
            memory.commit(&law(2, gain), &seen, &seen, 30.0);
        }
        assert!(coarse.shape.rest_angle[0] > 0.5);
        assert!((coarse.shape.rest_angle[0] - 2.0 * fine.shape.rest_angle[0]).abs() < 1e-12);
        assert!((coarse.shape.stiffness_ratio[0] - fine.shape.stiffness_ratio[0]).abs() < 1e-12);
    }
}
