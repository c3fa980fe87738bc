//! Levenberg-Marquardt damping of Newton's directions (Levenberg 1944, Marquardt 1963).
//!
//! Where cloth is crowded, an undamped direction moves points by metres through layers whose contacts are not in the
//! system; limited by the first contact, it decreases the energy by next to nothing, time after time. Damping adds a
//! multiple of the inertia to the system, not to the energy, so that directions stay within the range of the contacts
//! in the system. The problem is unchanged: a solve converges by undamped directions only. The gain ratio is the actual
//! decrease of the energy over the predicted one.

use crate::sim::newton::tuning::TUNING;
use crease_linear::BlockMatrix;

/// Damping of a solve, adapted to the gain ratios of its directions.
#[derive(Debug, Default)]
pub(super) struct LevenbergMarquardt {
    /// Added inertia as a multiple of the inertia of the problem [-]; 0 while directions are undamped.
    damping: f64,
    /// Number of undamped directions in a row with a small gain ratio.
    rejects: usize,
}

impl LevenbergMarquardt {
    /// Whether directions are damped.
    pub fn is_active(&self) -> bool {
        self.damping > 0.0
    }

    /// Adds the damping to the `system` of points with `mass` [kg] and effective time step `effective_dt` [s].
    pub fn add_to(&self, system: &mut BlockMatrix, mass: &[f64], effective_dt: f64) {
        for (p, m) in mass.iter().enumerate() {
            system.add_diagonal(p, self.damping * m / (effective_dt * effective_dt));
        }
    }

    /// Updates the damping after a direction with `gain_ratio` [-] and largest deviation `max_deviation` [m].
    pub fn update(&mut self, gain_ratio: f64, max_deviation: f64) {
        let tuning = &TUNING.damping;
        if self.is_active() {
            if gain_ratio < tuning.increase_below_gain_ratio {
                self.damping *= tuning.increase_factor;
            } else if gain_ratio > tuning.decrease_above_gain_ratio {
                self.divide_by(tuning.decrease_factor);
            }
        } else {
            self.rejects = if gain_ratio < tuning.min_gain_ratio { self.rejects + 1 } else { 0 };
            if self.rejects >= tuning.rejects_before_damping {
                self.rejects = 0;
                self.damping = (max_deviation / tuning.initial_step).max(1.0);
            }
        }
    }

    /// Increases the damping after a direction along which no step was accepted. Whether a shorter direction may help.
    pub fn increase(&mut self) -> bool {
        let may_help = self.is_active() && self.damping < TUNING.damping.max_damping;
        self.damping *= TUNING.damping.increase_factor;
        may_help
    }

    /// Decreases the damping once damped iterations have converged.
    pub fn decrease(&mut self) {
        self.divide_by(TUNING.damping.decrease_at_convergence);
    }

    fn divide_by(&mut self, factor: f64) {
        self.damping /= factor;
        if self.damping < TUNING.damping.min_damping {
            self.damping = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_starts_after_three_rejected_directions_and_ends_after_convergence() {
        let mut damping = LevenbergMarquardt::default();
        for gain_ratio in [0.0, 0.01, 0.3, 0.0, 0.0] {
            damping.update(gain_ratio, 1.0);
            assert!(!damping.is_active());
        }
        assert!(!damping.increase());
        damping.update(0.0, 1.0);
        assert!((damping.damping - 200.0).abs() < 1e-9);
        damping.update(0.1, 1.0);
        damping.update(0.4, 1.0);
        assert!((damping.damping - 800.0).abs() < 1e-9);
        damping.decrease();
        assert!(damping.is_active() && damping.increase());
        damping.decrease();
        assert!(!damping.is_active());
    }
}
