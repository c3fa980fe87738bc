//! Damping of Newton's directions (Levenberg 1944, Marquardt 1963): inertia added to the system, not to the energy, while
//! full directions lead nowhere.
//!
//! Where cloth is crowded a full direction sweeps metres through layers it does not know of; cut short where the first
//! of them touch, it gains next to nothing, time after time. A damped direction goes as far as the layers that are known
//! are the ones that matter. What is solved for stays the same: a solve counts as converged by full directions only.

use crate::sim::BlockMatrix;

/// How much directions are damped, and what is known of their success.
#[derive(Debug, Default)]
pub(super) struct Damping {
    /// Inertia added, as a multiple of what is there.
    share: f64,
    /// Full directions in a row that gained next to nothing.
    idle: usize,
}

/// A full direction that keeps less of the gain it promises has led nowhere.
const NOWHERE: f64 = 0.05;
/// So many of them in a row begin the damping: single ones are often followed by a good one.
const PATIENCE: usize = 3;
/// The first damping brings moves to about this way [m]: that of cloth which only inertia holds.
const FIRST_WAY: f64 = 5e-3;
/// A damped direction that keeps less than this share of its gain was too long,
const TOO_LONG: f64 = 0.2;
/// one that keeps more than this was short.
const SHORT: f64 = 0.6;
/// Factors by which damping grows and shrinks: unequal, so that it does not swing between the same two values.
const GROWTH: f64 = 4.0;
const DECAY: f64 = 3.0;
/// The same where a damped direction has nothing left to gain, and a full one may.
const RELIEF: f64 = 100.0;
/// Below this share of the inertia there is none.
const LEAST: f64 = 0.5;
/// Beyond this multiple of the inertia damping does not help either.
const MOST: f64 = 1e8;

impl Damping {
    /// Whether directions are damped.
    pub fn acts(&self) -> bool {
        self.share > 0.0
    }

    /// Adds to the `system` of points with `mass` [kg] for a step of `span` [s].
    pub fn add_to(&self, system: &mut BlockMatrix, mass: &[f64], span: f64) {
        for (p, m) in mass.iter().enumerate() {
            system.add_diagonal(p, self.share * m / (span * span));
        }
    }

    /// Learns from a direction that took some point `way` [m] farther than all on average, and kept the share `kept` of the gain it
    /// promised.
    pub fn learn(&mut self, kept: f64, way: f64) {
        if self.acts() {
            if kept < TOO_LONG {
                self.share *= GROWTH;
            } else if kept > SHORT {
                self.shrink(DECAY);
            }
        } else {
            self.idle = if kept < NOWHERE { self.idle + 1 } else { 0 };
            if self.idle >= PATIENCE {
                self.idle = 0;
                self.share = (way / FIRST_WAY).max(1.0);
            }
        }
    }

    /// The direction could not be gone at all; whether a shorter one may.
    pub fn tighten(&mut self) -> bool {
        let helps = self.acts() && self.share < MOST;
        self.share *= GROWTH;
        helps
    }

    /// Along the damped direction nothing is left to gain.
    pub fn relieve(&mut self) {
        self.shrink(RELIEF);
    }

    fn shrink(&mut self, by: f64) {
        self.share /= by;
        if self.share < LEAST {
            self.share = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_after_three_directions_that_lead_nowhere_and_ends_when_nothing_is_left() {
        let mut damping = Damping::default();
        for kept in [0.0, 0.01, 0.3, 0.0, 0.0] {
            damping.learn(kept, 1.0);
            assert!(!damping.acts());
        }
        assert!(!damping.tighten());
        damping.learn(0.0, 1.0);
        assert!((damping.share - 200.0).abs() < 1e-9);
        damping.learn(0.1, 1.0);
        damping.learn(0.4, 1.0);
        assert!((damping.share - 800.0).abs() < 1e-9);
        damping.relieve();
        assert!(damping.acts() && damping.tighten());
        damping.relieve();
        assert!(!damping.acts());
    }
}
