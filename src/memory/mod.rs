//! After an accepted step: the cloth remembers.
//!
//! [`Memory::commit`] is the only place that writes a [`RestShape`]. Energies and the solver read it; a step that
//! was rejected never reaches this module. The law itself is `fabric::Law`; here it is applied to every hinge
//! (condition: angle beyond the rest angle, measured against the reference length on fine meshes) and, where the
//! fabric has length ratios, to both axes of every triangle (condition: strain beyond the rest stretch).

use crate::fabric::{Band, EventCount, Fabric, Law, Trace, Zone};
use crate::garment::{Garment, RestShape};
use serde::{Deserialize, Serialize};

/// Band and time spent in it, of one element.
type Running = (Zone, f64);

/// The memory of one garment in wear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What the energies read.
    pub shape: RestShape,
    /// Events so far.
    pub events: EventCount,
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
        let band = |threshold, duration, stiffness_rate, rest_rate| Band {
            threshold,
            duration,
            stiffness_rate,
            rest_rate,
        };
        let angle = Law {
            gradual: band(
                fabric.memory.gradual_threshold(),
                memory.gradual_duration_s,
                memory.gradual_stiffness_ratio,
                memory.gradual_angle_ratio,
            ),
            critical: band(
                fabric.memory.critical_threshold(),
                memory.critical_duration_s,
                memory.critical_stiffness_ratio,
                memory.critical_angle_ratio,
            ),
            ceiling: memory.stiffness_ceiling,
        };
        let length = (memory.gradual_length_ratio > 0.0 || memory.critical_length_ratio > 0.0).then(|| Law {
            // Stretching does not stiffen the membrane: only the rest length moves.
            gradual: band(
                fabric.memory.gradual_stretch_threshold(),
                memory.gradual_duration_s,
                0.0,
                memory.gradual_length_ratio,
            ),
            critical: band(
                fabric.memory.critical_stretch_threshold(),
                memory.critical_duration_s,
                0.0,
                memory.critical_length_ratio,
            ),
            ceiling: 1.0,
        });
        let reference = fabric.memory.reference_length();
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
        let idle = (Zone::Rest, 0.0);
        Self {
            shape,
            events: EventCount::default(),
            hinge: vec![idle; hinges],
            warp: vec![idle; triangles],
            weft: vec![idle; triangles],
        }
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
        let shape = &mut self.shape;
        for (h, running) in self.hinge.iter_mut().enumerate() {
            let mut trace = Trace {
                rest: shape.rest_angle[h],
                stiffness: shape.stiffness_ratio[h],
                zone: running.0,
                timer: running.1,
            };
            let (from, to) = (before.angle[h], after.angle[h]);
            count += law.angle.advance(&mut trace, from, to, duration, law.gain[h], law.hinge_mask[h]);
            shape.rest_angle[h] = trace.rest;
            shape.stiffness_ratio[h] = trace.stiffness;
            *running = (trace.zone, trace.timer);
        }
        if let Some(length) = &law.length {
            let axes = [
                (&mut shape.rest_stretch_warp, &mut self.warp, 0),
                (&mut shape.rest_stretch_weft, &mut self.weft, 1),
            ];
            for (rest, timers, axis) in axes {
                for (f, running) in timers.iter_mut().enumerate() {
                    let mut trace =
                        Trace { rest: rest[f], stiffness: 1.0, zone: running.0, timer: running.1 };
                    // Compressed cloth buckles, it does not shorten: strain below rest counts as none.
                    let at = |stretch: &[[f64; 3]]| stretch[f][axis].max(rest[f]);
                    let (from, to) = (at(before.stretch), at(after.stretch));
                    count += length.advance(&mut trace, from, to, duration, 1.0, law.triangle_mask[f]);
                    rest[f] = trace.rest;
                    *running = (trace.zone, trace.timer);
                }
            }
        }
        self.events += count;
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabric::Fabric;

    fn law(hinges: usize, gain: f64) -> Remembering {
        let fabric = Fabric::preset("kow-tshirt").unwrap();
        let right = std::f64::consts::FRAC_PI_2;
        assert!((fabric.memory.gradual_threshold() - 0.27 * right).abs() < 1e-12);
        let band = |threshold, duration, stiffness_rate, rest_rate| Band {
            threshold,
            duration,
            stiffness_rate,
            rest_rate,
        };
        Remembering {
            angle: Law {
                gradual: band(0.27 * right, 4.3, 1.1, 0.4),
                critical: band(0.85 * right, 1.0, 2.5, 1.0),
                ceiling: 30.0,
            },
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
