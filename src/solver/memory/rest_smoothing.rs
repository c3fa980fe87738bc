//! First-order lag of the effective rest state behind the rest state.
//!
//! An event changes a rest angle by up to a right angle at once, which would accelerate the cloth like a blow. The rest
//! state that the energies read therefore follows the remembered one with the time constant T,
//!
//! ```text
//! x <- x + (1 - exp(-h / T)) (remembered - x)      x: rest angle, rest stretch, 1 / sqrt(stiffness ratio)
//! ```
//!
//! with the same result for one step or many. Along this path strain over the root of compliance is a ratio of two linear
//! functions, so the stored energy stays between its values at both ends: that an event never raises the stored energy, as
//! the law guarantees, holds all along it.

use crate::memory::tuning::TUNING;
use crease_model::garment::RestState;

/// Moves `effective` towards `rest` over `duration` [s].
pub(super) fn follow(effective: &mut RestState, rest: &RestState, duration: f64) {
    let fraction = 1.0 - (-duration / TUNING.smoothing_time).exp();
    let linear = |effective: &mut [f64], rest: &[f64]| {
        for (effective, &goal) in effective.iter_mut().zip(rest).filter(|(now, goal)| *now != *goal) {
            let gap = goal - *effective;
            *effective = if gap.abs() <= TUNING.smoothing_tol { goal } else { *effective + fraction * gap };
        }
    };
    linear(&mut effective.rest_angle, &rest.rest_angle);
    linear(&mut effective.rest_stretch_warp, &rest.rest_stretch_warp);
    linear(&mut effective.rest_stretch_weft, &rest.rest_stretch_weft);
    let ratios = effective.stiffness_ratio.iter_mut().zip(&rest.stiffness_ratio);
    for (effective, &goal) in ratios.filter(|(now, goal)| *now != *goal) {
        let (now, end) = (effective.sqrt().recip(), goal.sqrt().recip());
        let gap = end - now;
        *effective = if gap.abs() <= TUNING.smoothing_tol { goal } else { (now + fraction * gap).powi(-2) };
    }
}
