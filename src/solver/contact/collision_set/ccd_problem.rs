//! A displacement to be limited by continuous collision detection.

use crate::contact::barrier;
use crate::contact::broad_phase::PrimitivePair;
use crate::contact::collision_set::candidate_pair::CandidatePair;
use crate::contact::impact_zones::zone_displacement;
use crate::contact::step_bounds::{StepFractions, local_step_fractions, stay_apart, swept_boxes};
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use rayon::prelude::*;

/// Mode of limiting a displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CcdMode {
    /// Whether every point has a step size of its own; otherwise all have the same.
    pub per_point: bool,
    /// Whether cloth is carried: no layer is pressed below the inner part of its activation distance.
    pub carry: bool,
    /// Whether pairs that intersect since the start may pass.
    pub allow_initial: bool,
}

/// Pairs with their minimum distances, positions and displacements.
pub(super) struct CcdProblem<'a> {
    pairs: Vec<PrimitivePair>,
    /// Minimum distances [m], one per pair.
    min_distances: Vec<f64>,
    /// Positions [m], one per point.
    x: &'a [Vec3],
    /// Displacements [m], one per point.
    d: &'a [Vec3],
}

impl<'a> CcdProblem<'a> {
    /// The displacement `d` from `x` [m] with those of the `candidates` that may come to their minimum distance.
    pub fn new(candidates: &[CandidatePair], x: &'a [Vec3], d: &'a [Vec3], mode: CcdMode) -> Self {
        let tuning = &TUNING.step;
        let boxes = swept_boxes(x, d);
        let (pairs, min_distances) = candidates
            .par_iter()
            .filter(|pair| !mode.allow_initial || !pair.ignored)
            .filter_map(|pair| {
                let primitives = pair.primitives();
                // Most pairs stay farther apart than any minimum distance, and their boxes say so.
                if stay_apart(&primitives, &boxes, barrier::MAX_MIN_DISTANCE_FRACTION * pair.dhat) {
                    return None;
                }
                let distance = pair.closest_points(x).distance;
                let mut min_distance = barrier::min_distance(distance, pair.dhat);
                if mode.carry {
                    let kept = (tuning.carry_min_gap * pair.dhat).min(tuning.max_carry_gap_kept * distance);
                    min_distance = min_distance.max(kept);
                }
                Some((primitives, min_distance))
            })
            .unzip();
        Self { pairs, min_distances, x, d }
    }

    /// Returns the largest step size that all points may take [-].
    pub fn uniform_step_size(&self) -> f64 {
        let pairs = self.pairs.par_iter().zip(&self.min_distances);
        let step_size = |(pair, min_distance): (&PrimitivePair, &f64)| {
            pair.collision_free_step_size(self.x, self.d, *min_distance)
        };
        let safe: Vec<f64> = pairs.map(step_size).collect();
        safe.into_iter().fold(1.0, f64::min)
    }

    /// Returns step sizes of single points for a displacement that is at most that of the problem.
    pub fn local_step_sizes(&self, d: &[Vec3]) -> StepFractions {
        local_step_fractions(&self.pairs, &self.min_distances, self.x, d)
    }

    /// Returns the displacement in which points that would hit one another move as zones [m]; see
    /// [`crate::contact::impact_zones`].
    pub fn zone_displacement(&self, fixed: &[bool]) -> Option<Vec<Vec3>> {
        zone_displacement(&self.pairs, &self.min_distances, self.x, self.d, fixed)
    }
}
