//! Active pairs: candidates within their activation distance.

use crate::contact::broad_phase::PairKind;
use crate::contact::collision_set::candidate_pair::CandidatePair;
use crease_geometry::math::Vec3;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Smallest distance that a barrier is evaluated at [m].
const MIN_DISTANCE: f64 = 1e-12;

/// A pair within its activation distance.
#[derive(Debug, Clone, Copy)]
pub(in crate::contact) struct ActivePair {
    pub kind: PairKind,
    pub points: [u32; 4],
    /// Signed weights: distance vector = sum w_i x_i.
    pub weights: [f64; 4],
    /// Unit vector along the distance vector.
    pub normal: Vec3,
    /// Distance [m].
    pub distance: f64,
    /// Activation distance of this pair [m].
    pub dhat: f64,
    /// Stiffness [N/m].
    pub stiffness: f64,
}

/// Returns the pairs within `margin` times their activation distance at `x` [m], in the order of `pairs`. `stiffness` is per area [N/m³].
pub(super) fn active_pairs_within(
    pairs: &[CandidatePair],
    stiffness: f64,
    x: &[Vec3],
    margin: f64,
) -> Vec<ActivePair> {
    pairs
        .par_iter()
        .filter(|pair| !pair.ignored)
        .filter_map(|pair| {
            let four = pair.gather(x);
            // Most candidates are not near, and their boxes say so.
            if pair.kind.apart_on_an_axis(&four, margin * pair.dhat) {
                return None;
            }
            let closest = pair.kind.closest_points(&four);
            (closest.distance < margin * pair.dhat).then(|| ActivePair {
                kind: pair.kind,
                points: pair.points,
                weights: closest.weights,
                normal: if closest.distance > 0.0 { closest.vector / closest.distance } else { Vec3::y() },
                distance: closest.distance.max(MIN_DISTANCE),
                dhat: pair.dhat,
                stiffness: stiffness * pair.area,
            })
        })
        .collect()
}

/// Active pairs at the positions last asked for: value, gradient and Hessian at one position are asked for one by one.
#[derive(Default)]
pub(super) struct ActivePairCache(Mutex<Option<CachedPairs>>);

/// Active pairs and the positions [m] they belong to.
struct CachedPairs {
    x: Vec<Vec3>,
    active: Arc<Vec<ActivePair>>,
}

impl ActivePairCache {
    /// Returns the active pairs at `x` [m]; `compute` makes them if they are not in the cache.
    pub fn get(&self, x: &[Vec3], compute: impl FnOnce() -> Vec<ActivePair>) -> Arc<Vec<ActivePair>> {
        let cached = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = cached().as_ref().filter(|known| known.x == x) {
            return Arc::clone(&known.active);
        }
        // Not under the lock: a thread that waits for others here may be given work that wants it, too.
        let active = Arc::new(compute());
        *cached() = Some(CachedPairs { x: x.to_vec(), active: Arc::clone(&active) });
        active
    }

    /// Drops what is cached: it is of other pairs or other activation distances.
    pub fn clear(&mut self) {
        *self.0.get_mut().unwrap_or_else(PoisonError::into_inner) = None;
    }
}
