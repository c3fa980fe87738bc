//! Profile of motions in time.

/// Largest rate of [`smoothstep`] relative to its mean rate.
pub(crate) const PEAK_RATE: f64 = 1.5;

/// The cubic from 0 to 1 over `u` in 0..1 with zero rate at both ends; constant outside.
pub(crate) fn smoothstep(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}
