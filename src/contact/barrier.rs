//! How two pieces of cloth push apart: a spring within the contact distance, without any stiffness where it begins, that
//! becomes a steep wall in the inner half of it. Where the two join follows Chen et al. 2025 ("Offset Geometric Contact",
//! eq. 18); the rest does not. Their spring has its full stiffness from the start: in a pile most contacts bear next to
//! nothing and come and go there, and each changed what Newton solves by that much (`docs/adr/0011-contact-barrier.md`). Their wall is a
//! logarithm, which is so flat that a gain elsewhere squeezed single pairs to nanometres, where any sliding jams them. With
//! u = 2 d / r:
//!
//! ```text
//! b(d) = 2 k / (3 r) (r - d)³                          r/2 <= d <= r
//! b(d) = k r²/4 (u^-3 / 6 - u / 2 + 2/3)               0 < d < r/2
//! ```
//!
//! Twice continuously differentiable. `k` is the mean stiffness of the spring, which is no more than the loads ask for, so
//! Newton sees a well-conditioned system; the wall is there for what was not foreseen.

/// Energy \[J\] at distance `d` for contact distance `r` \[m\] and stiffness `k` \[N/m\].
#[inline]
pub fn value(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        let way = r - d;
        2.0 / 3.0 * k / r * way * way * way
    } else {
        let u = 2.0 * d / r;
        0.25 * k * r * r * (1.0 / (6.0 * u * u * u) - 0.5 * u + 2.0 / 3.0)
    }
}

/// Derivative by `d` \[N\]: never positive.
#[inline]
pub fn slope(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        -2.0 * k / r * (r - d) * (r - d)
    } else {
        let u = 2.0 * d / r;
        -0.25 * k * r * (1.0 / (u * u * u * u) + 1.0)
    }
}

/// Second derivative by `d` \[N/m\]: never negative.
#[inline]
pub fn curvature(d: f64, r: f64, k: f64) -> f64 {
    if d >= r {
        0.0
    } else if d >= 0.5 * r {
        4.0 * k / r * (r - d)
    } else {
        let u = 2.0 * d / r;
        2.0 * k / (u * u * u * u * u)
    }
}

/// The gap [m] that one move leaves at least between what is `gap` apart [m].
///
/// What is not in contact yet comes into contact, no more: the next direction knows of it. What is in contact keeps a
/// share of its gap, for the wall must have a say before layers come really near.
pub fn floor(gap: f64, reach: f64) -> f64 {
    if gap > reach { FIRST_TOUCH * reach } else { KEPT_GAP * gap }
}

/// Share of the contact distance at which a new contact stops first.
const FIRST_TOUCH: f64 = 0.5;
/// No floor is higher than this share of the contact distance.
pub const HIGHEST_FLOOR: f64 = FIRST_TOUCH;
/// Share of its gap that a contact keeps at least.
const KEPT_GAP: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_differences_and_join_smoothly() {
        let (r, k) = (1e-3, 50.0);
        for d in [1e-5, 1e-4, 4e-4, 6e-4, 9e-4] {
            let e = 1e-4 * d;
            let s = (value(d + e, r, k) - value(d - e, r, k)) / (2.0 * e);
            let c = (slope(d + e, r, k) - slope(d - e, r, k)) / (2.0 * e);
            assert!((s / slope(d, r, k) - 1.0).abs() < 1e-6);
            assert!((c / curvature(d, r, k) - 1.0).abs() < 1e-6);
        }
        let half = 0.5 * r;
        for f in [value, slope, curvature] {
            let (below, above) = (f(half * (1.0 - 1e-9), r, k), f(half, r, k));
            assert!((below / above - 1.0).abs() < 1e-6);
            assert!(f(r * (1.0 - 1e-9), r, k).abs() < 1e-6 * f(half, r, k).abs(), "it begins with nothing");
        }
    }
}
