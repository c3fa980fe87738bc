//! The barrier between two primitives: a spring within the activation distance r that becomes a steep wall in its inner half.
//!
//! With u = 2 d / r:
//!
//! ```text
//! b(d) = 2 k / (3 r) (r - d)³                          r/2 <= d <= r
//! b(d) = k r²/4 (u^-3 / 6 - u / 2 + 2/3)               0 < d < r/2
//! ```
//!
//! b is twice continuously differentiable. `k` is the mean stiffness of the spring. The loads determine it, so Newton sees a
//! well-conditioned system; the wall acts on what was not foreseen.
//!
//! The joint at r/2 follows Chen et al. 2025 ("Offset Geometric Contact", eq. 18); the rest does not. Their spring has its full
//! stiffness from the start: in a pile most contacts bear almost nothing and switch on and off, and each changes the linear system by
//! its full stiffness (`docs/adr/0011-contact-barrier.md`). Their wall is a logarithm, which is so flat that a decrease of energy
//! elsewhere presses single pairs to nanometres, where any sliding jams them.

use crate::contact::tuning::TUNING;

/// Returns b(d) \[J\] for distance `d`, activation distance `r` \[m\] and stiffness `k` \[N/m\].
#[inline]
pub fn value(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        let depth = r - d;
        2.0 / 3.0 * k / r * depth * depth * depth
    } else {
        let u = 2.0 * d / r;
        0.25 * k * r * r * (1.0 / (6.0 * u * u * u) - 0.5 * u + 2.0 / 3.0)
    }
}

/// Returns b'(d) \[N\], which is never positive.
#[inline]
pub fn derivative(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        -2.0 * k / r * (r - d) * (r - d)
    } else {
        let u = 2.0 * d / r;
        -0.25 * k * r * (1.0 / (u * u * u * u) + 1.0)
    }
}

/// Returns b''(d) \[N/m\], which is never negative.
#[inline]
pub fn second_derivative(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        4.0 * k / r * (r - d)
    } else {
        let u = 2.0 * d / r;
        2.0 * k / (u * u * u * u * u)
    }
}

/// Returns the smallest distance \[m\] that one displacement may leave between two primitives that are `distance` apart.
///
/// An inactive pair may become active but no more: the next direction takes it into account. An active pair keeps a fraction of its
/// distance, because the barrier must act before layers come really near.
pub fn min_distance(distance: f64, dhat: f64) -> f64 {
    let tuning = &TUNING.step;
    if distance > dhat { tuning.new_contact_gap_fraction * dhat } else { tuning.kept_gap_fraction * distance }
}

/// Largest value of [`min_distance`] over the activation distance.
pub const MAX_MIN_DISTANCE_FRACTION: f64 = TUNING.step.new_contact_gap_fraction;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_differences_and_join_smoothly() {
        let (r, k) = (1e-3, 50.0);
        for d in [1e-5, 1e-4, 4e-4, 6e-4, 9e-4] {
            let e = 1e-4 * d;
            let s = (value(d + e, r, k) - value(d - e, r, k)) / (2.0 * e);
            let c = (derivative(d + e, r, k) - derivative(d - e, r, k)) / (2.0 * e);
            assert!((s / derivative(d, r, k) - 1.0).abs() < 1e-6);
            assert!((c / second_derivative(d, r, k) - 1.0).abs() < 1e-6);
        }
        let half = 0.5 * r;
        for f in [value, derivative, second_derivative] {
            let (below, above) = (f(half * (1.0 - 1e-9), r, k), f(half, r, k));
            assert!((below / above - 1.0).abs() < 1e-6);
            assert!(
                f(r * (1.0 - 1e-9), r, k).abs() < 1e-6 * f(half, r, k).abs(),
                "zero at the activation distance"
            );
        }
    }
}
