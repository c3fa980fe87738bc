//! The smooth entry of events into the forces.
//!
//! An event moves a rest angle by up to a right angle in no time. Given to the solver like that it would be a blow. So
//! the shape the energies read follows the remembered one,
//!
//! ```text
//! x <- x + (1 - exp(-h / ENTRY)) (remembered - x)      x: rest angle, rest stretch, 1 / sqrt(stiffness ratio)
//! ```
//!
//! exactly the same for one step or many. Along this way strain over root of compliance is a ratio of two linear
//! functions, so the stored energy stays between its values at both ends: the guard of the law, which says that an
//! event never raises it, holds on the whole way.

use crate::garment::RestState;

/// Time in which all but a third of a change has entered [s].
const ENTRY: f64 = 0.2;
/// A difference below this has entered [rad, -].
const ENTERED: f64 = 1e-9;

/// Lets `felt` follow `remembered` for `duration` [s].
pub(super) fn follow(felt: &mut RestState, remembered: &RestState, duration: f64) {
    let share = 1.0 - (-duration / ENTRY).exp();
    let plain = |felt: &mut [f64], remembered: &[f64]| {
        for (felt, &goal) in felt.iter_mut().zip(remembered).filter(|(felt, goal)| *felt != *goal) {
            let gap = goal - *felt;
            *felt = if gap.abs() <= ENTERED { goal } else { *felt + share * gap };
        }
    };
    plain(&mut felt.rest_angle, &remembered.rest_angle);
    plain(&mut felt.rest_stretch_warp, &remembered.rest_stretch_warp);
    plain(&mut felt.rest_stretch_weft, &remembered.rest_stretch_weft);
    let ratios = felt.stiffness_ratio.iter_mut().zip(&remembered.stiffness_ratio);
    for (felt, &goal) in ratios.filter(|(felt, goal)| *felt != *goal) {
        let (now, end) = (felt.sqrt().recip(), goal.sqrt().recip());
        let gap = end - now;
        *felt = if gap.abs() <= ENTERED { goal } else { (now + share * gap).powi(-2) };
    }
}
