//! The memory law: how one hinge, or one axis of a triangle, changes its rest value and stiffness with use.
//!
//! Equations 6 and 7 of Kim, Oh, Wohn (KOW), "Persistent Wrinkles and Folds of Clothes", in the reading of
//! `docs/theory/memory.md`. Pure scalar functions; [`crate::memory::Memory`] applies them to a garment.
//!
//! ```text
//! C = g (theta - rest)                    band: critical if |C| > C^b, gradual if C^a < |C| <= C^b, else none
//! after tau in one band, one event:       rest <- rest + sign(C) rho_t C^ / g
//!                                         s <- min( s (1 + rho_k C^), max(s, s (C / C')²) ), s <= max_stiffness_ratio
//! ```
//!
//! with the condition C, the angle theta [rad], the gain g of the hinge (the bend of the cloth within the reference length over
//! that of the hinge), the threshold C^ and the duration tau [s] of the band, the stiffness ratio s [-], and the condition C'
//! after the event.
//!
//! Additions to KOW: an event that leads away from the initial rest value is scaled by the fraction of `max_rest_change` that
//! is left, so that bagging levels off over cycles of wear. The second bound on s guarantees that an event never raises the
//! stored energy s C²/2. Within a step the angle moves linearly, and entry into a band, events and exit are found at their
//! own times, so that a step of half a second has the same events as thirty of a sixtieth. A rest value recovers after
//! release by an equal fraction per decade of time, as measured on creased sheets and woven fabric (Benusiglio et al. 2012,
//! "The anatomy of a crease"); off by default.

use crate::memory::tuning::TUNING;
use crease_model::fabric::{EventGuard, FabricMemory};
use serde::{Deserialize, Serialize};

/// Parameters of a band: its threshold, its duration, and the change by one event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandParams {
    /// Condition beyond which the timer of the band runs ([rad] for hinges, strain [-] for lengths).
    pub threshold: f64,
    /// Time in the band until an event, KOW's tau [s].
    pub duration: f64,
    /// rho_k: relative growth of stiffness per unit of threshold [-].
    pub stiffness_rate: f64,
    /// rho_t or rho_l: change of the rest value as a fraction of the threshold [-].
    pub rest_rate: f64,
}

/// The memory law for angles or for lengths of one fabric.
///
/// ```
/// use crease_model::fabric::Fabric;
/// use crease_solver::memory::{ElementParams, HysteresisState, MemoryLaw};
/// let law = MemoryLaw::for_angles(&Fabric::preset("kow-tshirt")?.memory);
/// let mut state = HysteresisState::new(0.0);
/// // One second to fold a flat hinge to 2.5 rad, then held for five seconds.
/// law.advance(&mut state, 0.0, 2.5, 1.0, &ElementParams::FLAT);
/// let events = law.advance(&mut state, 2.5, 2.5, 5.0, &ElementParams::FLAT);
/// assert!(events.critical > 0);
/// assert!(state.rest > 1.0 && state.stiffness_ratio > 1.0);
/// # Ok::<(), crease_model::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryLaw {
    /// The lower, slow band (KOW's alpha).
    pub gradual: BandParams,
    /// The upper, fast band (KOW's beta).
    pub critical: BandParams,
    /// Largest stiffness ratio that events lead to [-].
    pub max_stiffness_ratio: f64,
    /// Distance from the initial rest value that events approach and do not reach ([rad] or strain [-]); infinite for no limit.
    pub max_rest_change: f64,
    /// Fraction of a remembered change that recovers per decade of time after release [-]; 0 for no recovery.
    pub recovery_per_decade: f64,
    /// What an event must not raise.
    pub guard: EventGuard,
}

/// Constant parameters of one element: a hinge, or one axis of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementParams {
    /// Rest value of new cloth (angle [rad] or stretch [-]).
    pub initial_rest: f64,
    /// Bend of the cloth within the reference length over the angle of the hinge; 1 for lengths [-].
    pub gain: f64,
    /// Factor on the changes by events [-], from 0 to 1.
    pub mask: f64,
}

impl ElementParams {
    /// A flat hinge, at least as wide as the reference length, unmasked.
    pub const FLAT: Self = Self { initial_rest: 0.0, gain: 1.0, mask: 1.0 };
}

/// Band of a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Band {
    /// Below both thresholds.
    #[default]
    Rest,
    /// Above the gradual, up to the critical threshold.
    Gradual,
    /// Above the critical threshold.
    Critical,
}

/// State of one element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HysteresisState {
    /// Rest value (angle [rad] or stretch [-]).
    pub rest: f64,
    /// Stiffness ratio [-].
    pub stiffness_ratio: f64,
    /// Band at the end of the last step.
    pub band: Band,
    /// Time spent in that band [s].
    pub timer: f64,
    /// Time without load since the last event [s], from which recovery is counted.
    pub idle: f64,
}

impl HysteresisState {
    /// The state of new cloth with the given rest value.
    pub fn new(rest: f64) -> Self {
        Self { rest, stiffness_ratio: 1.0, band: Band::Rest, timer: 0.0, idle: 0.0 }
    }
}

/// Number of memory events.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct EventCount {
    /// Events of the gradual band (alpha).
    pub gradual: u64,
    /// Events of the critical band (beta).
    pub critical: u64,
}

impl std::ops::AddAssign for EventCount {
    fn add_assign(&mut self, other: Self) {
        self.gradual += other.gradual;
        self.critical += other.critical;
    }
}

impl MemoryLaw {
    /// The law for the angles of hinges.
    pub fn for_angles(memory: &FabricMemory) -> Self {
        Self {
            gradual: BandParams {
                threshold: memory.gradual_threshold(),
                duration: memory.gradual_duration_s,
                stiffness_rate: memory.gradual_stiffness_ratio,
                rest_rate: memory.gradual_angle_ratio,
            },
            critical: BandParams {
                threshold: memory.critical_threshold(),
                duration: memory.critical_duration_s,
                stiffness_rate: memory.critical_stiffness_ratio,
                rest_rate: memory.critical_angle_ratio,
            },
            max_stiffness_ratio: memory.stiffness_ceiling,
            max_rest_change: f64::INFINITY,
            recovery_per_decade: memory.reopening_percent_per_decade * 0.01,
            guard: memory.guard,
        }
    }

    /// The law for rest lengths; `None` if the fabric has none. Stretching does not stiffen the membrane and bagging does
    /// not recover: only the rest length changes, and it only grows.
    pub fn for_lengths(memory: &FabricMemory) -> Option<Self> {
        let band = |threshold, duration, rest_rate| BandParams {
            threshold,
            duration,
            stiffness_rate: 0.0,
            rest_rate,
        };
        (memory.gradual_length_ratio > 0.0 || memory.critical_length_ratio > 0.0).then(|| Self {
            gradual: band(
                memory.gradual_stretch_threshold(),
                memory.gradual_duration_s,
                memory.gradual_length_ratio,
            ),
            critical: band(
                memory.critical_stretch_threshold(),
                memory.critical_duration_s,
                memory.critical_length_ratio,
            ),
            max_stiffness_ratio: 1.0,
            max_rest_change: memory.rest_stretch_ceiling_percent * 0.01,
            recovery_per_decade: 0.0,
            guard: memory.guard,
        })
    }

    fn band_of(&self, size: f64) -> Band {
        if size > self.critical.threshold {
            Band::Critical
        } else if size > self.gradual.threshold {
            Band::Gradual
        } else {
            Band::Rest
        }
    }

    fn params(&self, band: Band) -> Option<&BandParams> {
        match band {
            Band::Rest => None,
            Band::Gradual => Some(&self.gradual),
            Band::Critical => Some(&self.critical),
        }
    }

    /// Advances `state` over a step of `duration` [s] during which the angle [rad] or stretch [-] goes linearly from `from`
    /// to `to`. Returns the events in it. A value that is not finite changes nothing.
    pub fn advance(
        &self,
        state: &mut HysteresisState,
        from: f64,
        to: f64,
        duration: f64,
        element: &ElementParams,
    ) -> EventCount {
        let mut count = EventCount::default();
        let ElementParams { initial_rest, gain, mask } = *element;
        // Every finite condition that stays below the gradual threshold leaves at once: nearly all hinges.
        let largest = (from - state.rest).abs().max((to - state.rest).abs()) * gain;
        if largest <= self.gradual.threshold || !largest.is_finite() || mask <= 0.0 {
            state.band = Band::Rest;
            state.timer = 0.0;
            if self.recovery_per_decade > 0.0 && state.rest != initial_rest && largest.is_finite() {
                self.recover(state, from, to, duration, element);
            }
            return count;
        }
        let rate = if duration > 0.0 { (to - from) / duration } else { 0.0 };
        let mut now = 0.0;
        for _ in 0..TUNING.max_events_per_step {
            let condition = (from + rate * now - state.rest) * gain;
            let slope = rate * gain;
            // On a threshold the direction of motion decides the band.
            let band = self.band_ahead(condition, slope);
            if band != state.band {
                state.band = band;
                state.timer = 0.0;
            }
            let leave = now + self.time_in_band(condition, slope, band);
            let event =
                self.params(band).map_or(f64::INFINITY, |b| now + (b.duration - state.timer).max(0.0));
            if event <= duration && event <= leave {
                let params = *self.params(band).unwrap_or(&self.gradual);
                now = event;
                state.timer = 0.0;
                state.idle = 0.0;
                let condition = (from + rate * now - state.rest) * gain;
                self.apply_event(state, &params, condition, element);
                match band {
                    Band::Critical => count.critical += 1,
                    _ => count.gradual += 1,
                }
            } else {
                let end = leave.min(duration);
                state.timer += end - now;
                if band == Band::Rest && self.recovery_per_decade > 0.0 && state.rest != initial_rest {
                    self.recover(state, from + rate * now, from + rate * end, end - now, element);
                }
                now = end;
                if leave >= duration {
                    break;
                }
            }
        }
        count
    }

    /// The band of the next instant: on a threshold (to rounding), the direction of motion decides.
    fn band_ahead(&self, condition: f64, slope: f64) -> Band {
        let growing = slope * condition > 0.0;
        let size = condition.abs();
        for threshold in [self.critical.threshold, self.gradual.threshold] {
            // No condition meets an infinite threshold.
            let met = threshold.is_finite() && (size - threshold).abs() <= 1e-12 * threshold.max(1e-300);
            if met && slope != 0.0 {
                let nudge = if growing { 2e-12 } else { -2e-12 };
                return self.band_of(threshold * (1.0 + nudge));
            }
        }
        self.band_of(size)
    }

    /// Time until a linearly moving condition leaves `band` [s].
    fn time_in_band(&self, condition: f64, slope: f64, band: Band) -> f64 {
        if slope == 0.0 {
            return f64::INFINITY;
        }
        let bounds = match band {
            Band::Rest => [self.gradual.threshold, f64::NAN],
            Band::Gradual => [self.gradual.threshold, self.critical.threshold],
            Band::Critical => [self.critical.threshold, f64::NAN],
        };
        let mut first = f64::INFINITY;
        for bound in bounds.into_iter().filter(|b| b.is_finite()) {
            for crossing in [bound, -bound] {
                let time = (crossing - condition) / slope;
                // The crossing just passed (to rounding) is not one ahead.
                if time > 1e-12 * (bound / slope).abs() && time < first {
                    first = time;
                }
            }
        }
        first
    }

    /// Recovers the rest value over the part of an event-free step in which the element is not held, and no farther than to
    /// where it is held.
    fn recover(
        &self,
        state: &mut HysteresisState,
        from: f64,
        to: f64,
        duration: f64,
        element: &ElementParams,
    ) {
        let side = (state.rest - element.initial_rest).signum();
        let held = TUNING.held_fraction * self.gradual.threshold / element.gain;
        // Distance beyond the rest value at which the element is held, at both ends of the step.
        let (first, last) = (side * (from - state.rest) - held, side * (to - state.rest) - held);
        let free_fraction = match (first < 0.0, last < 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => first / (first - last),
            (false, true) => last / (last - first),
        };
        let left = |idle: f64| {
            (1.0 - self.recovery_per_decade * (1.0 + idle / TUNING.recovery_start).log10()).max(0.0)
        };
        let before = left(state.idle);
        state.idle += free_fraction * duration;
        let ratio = if before > 0.0 { left(state.idle) / before } else { 0.0 };
        let recovered = element.initial_rest + (state.rest - element.initial_rest) * ratio;
        let limit = side * to - held;
        let rest = side * state.rest;
        state.rest = side * (side * recovered).max(limit.min(rest));
    }

    /// Applies one event of a band at `condition`.
    fn apply_event(
        &self,
        state: &mut HysteresisState,
        band: &BandParams,
        condition: f64,
        element: &ElementParams,
    ) {
        let ElementParams { initial_rest, gain, mask } = *element;
        let outwards = (state.rest - initial_rest) * condition.signum();
        let left = (1.0 - outwards.max(0.0) / self.max_rest_change).max(0.0);
        let moved = condition.signum() * band.rest_rate * band.threshold * mask * left;
        state.rest += moved / gain;
        let after = condition - moved;
        let grown = state.stiffness_ratio * (1.0 + band.stiffness_rate * band.threshold * mask);
        // The stored energy does not grow: s' C'² <= s C²; or the torque does not: s' |C'| <= s |C|.
        let exponent = match self.guard {
            EventGuard::Energy => 2,
            EventGuard::Torque => 1,
        };
        let allowed = if after == 0.0 {
            f64::INFINITY
        } else {
            state.stiffness_ratio.max(state.stiffness_ratio * (condition / after).abs().powi(exponent))
        };
        state.stiffness_ratio = grown.min(allowed).min(self.max_stiffness_ratio.max(state.stiffness_ratio));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper(tau_gradual: f64, tau_critical: f64) -> MemoryLaw {
        let right = std::f64::consts::FRAC_PI_2;
        MemoryLaw {
            gradual: BandParams {
                threshold: 0.27 * right,
                duration: tau_gradual,
                stiffness_rate: 1.1,
                rest_rate: 0.4,
            },
            critical: BandParams {
                threshold: 0.85 * right,
                duration: tau_critical,
                stiffness_rate: 2.5,
                rest_rate: 1.0,
            },
            max_stiffness_ratio: 30.0,
            max_rest_change: f64::INFINITY,
            recovery_per_decade: 0.0,
            guard: EventGuard::Energy,
        }
    }

    /// The fold of KOW's Table 2: a smoothstep to 3.01 rad over 9 s. Returns the last state and the largest torque (k = 1).
    fn fold(law: &MemoryLaw, step: f64) -> (HysteresisState, f64) {
        let angle = |t: f64| {
            let u = (t / 9.0).min(1.0);
            3.01 * u * u * (3.0 - 2.0 * u)
        };
        let mut state = HysteresisState::new(0.0);
        let mut largest: f64 = 0.0;
        let steps = (9.0 / step).round() as usize;
        for k in 0..steps {
            let (a, b) = (angle(k as f64 * step), angle((k + 1) as f64 * step));
            law.advance(&mut state, a, b, step, &ElementParams::FLAT);
            largest = largest.max(state.stiffness_ratio * (b - state.rest));
        }
        (state, largest)
    }

    #[test]
    fn table_two_of_the_paper_is_reproduced_at_every_step_size() {
        // tau_alpha, KOW rest angle, KOW largest torque (memory-law: tau_beta = 1.25 s in this protocol).
        let table = [(1.0, 1.84, 18.67), (2.0, 2.65, 8.81), (3.0, 2.77, 6.87), (4.0, 2.78, 6.57)];
        for step in [1.0 / 24.0, 1.0 / 60.0, 1.0 / 240.0] {
            let mut errors = Vec::new();
            for (tau, rest, torque) in table {
                let (state, largest) = fold(&paper(tau, 1.25), step);
                errors.push((state.rest / rest - 1.0).abs());
                errors.push((largest / torque - 1.0).abs());
            }
            let mean = errors.iter().sum::<f64>() / 8.0;
            let worst = errors.iter().fold(0.0, |a: f64, &b| a.max(b));
            assert!(mean <= 0.052 && worst <= 0.095, "step {step}: mean {mean}, worst {worst}, {errors:?}");
        }
    }

    /// An event may raise the torque of a hinge while its energy falls; the other guard bounds the torque.
    #[test]
    fn the_guard_bounds_the_energy_or_the_torque() {
        for (guard, raises_torque) in [(EventGuard::Energy, true), (EventGuard::Torque, false)] {
            let law = MemoryLaw { guard, ..paper(4.3, 1.0) };
            let mut state = HysteresisState::new(0.0);
            let events = law.advance(&mut state, 2.5, 2.5, 1.0, &ElementParams::FLAT);
            let [torque, energy] = [1, 2]
                .map(|power| state.stiffness_ratio * (2.5 - state.rest).powi(power) / 2.5f64.powi(power));
            assert_eq!(events.critical, 1);
            assert!(
                energy <= 1.0 + 1e-12 && (torque > 1.0 + 1e-12) == raises_torque,
                "{guard:?}: {torque}, {energy}"
            );
        }
    }

    #[test]
    fn a_hold_in_one_step_has_the_events_of_many() {
        let law = paper(1.0, 1.25);
        for angle in [0.6, 1.5, 3.0] {
            let (mut one, mut many) = (HysteresisState::new(0.0), HysteresisState::new(0.0));
            let a = law.advance(&mut one, angle, angle, 30.0, &ElementParams::FLAT);
            let mut b = EventCount::default();
            for _ in 0..1800 {
                b += law.advance(&mut many, angle, angle, 1.0 / 60.0, &ElementParams::FLAT);
            }
            assert_eq!(a, b, "angle {angle}");
            assert!(
                (one.rest - many.rest).abs() < 1e-12
                    && (one.stiffness_ratio - many.stiffness_ratio).abs() < 1e-12
            );
        }
    }

    #[test]
    fn an_event_never_raises_the_stored_energy() {
        let law = paper(0.1, 0.1);
        for k in 1..300 {
            let angle = 0.01 * f64::from(k);
            let mut state = HysteresisState::new(0.0);
            let mut energy = angle * angle;
            for _ in 0..50 {
                law.advance(&mut state, angle, angle, 0.1, &ElementParams::FLAT);
                let now = state.stiffness_ratio * (angle - state.rest).powi(2);
                assert!(now <= energy * (1.0 + 1e-12), "angle {angle}: {now} over {energy}");
                energy = now;
            }
        }
    }

    #[test]
    fn crossing_both_thresholds_in_one_step_starts_the_right_timer() {
        let law = paper(1.0, 1.0);
        let mut state = HysteresisState::new(0.0);
        // From 0 to 3 rad in one step of 3 s: the critical band is entered at C^b / (1 rad/s).
        law.advance(&mut state, 0.0, 2.0, 2.0, &ElementParams::FLAT);
        assert_eq!(state.band, Band::Critical);
        assert!((state.timer - (2.0 - law.critical.threshold)).abs() < 1e-9, "{}", state.timer);
    }

    /// No condition meets an infinite threshold, and a threshold of zero makes no change.
    #[test]
    fn zero_and_infinite_thresholds_do_no_harm() {
        for (gradual, critical) in
            [(0.0, 0.0), (0.0, f64::INFINITY), (f64::INFINITY, f64::INFINITY), (0.4, f64::INFINITY)]
        {
            let mut law = paper(1.0, 1.0);
            law.gradual.threshold = gradual;
            law.critical.threshold = critical;
            let mut state = HysteresisState::new(0.0);
            let mut count = EventCount::default();
            for (from, to, duration) in
                [(0.0, 3.0, 1.0), (3.0, 3.0, 20.0), (3.0, -3.0, 2.0), (-3.0, 0.0, 1.0)]
            {
                count += law.advance(&mut state, from, to, duration, &ElementParams::FLAT);
            }
            assert!(state.rest.is_finite() && (1.0..=30.0).contains(&state.stiffness_ratio), "{state:?}");
            assert_eq!(count.critical > 0, critical == 0.0, "{gradual} {critical}: {count:?}");
            let reached = gradual.is_finite() && critical > 0.0;
            assert_eq!(count.gradual > 0, reached, "{gradual} {critical}: {count:?}");
            assert_eq!(state.rest != 0.0, gradual == 0.4, "{gradual} {critical}: {state:?}");
        }
    }

    /// A cloth pulled repeatedly, always 8 % farther than it is long: without a limit it grows by the same at every pull;
    /// with one each pull adds less, and none leads past it.
    #[test]
    fn repeated_pulls_level_off() {
        let strain =
            |threshold| BandParams { threshold, duration: 0.5, stiffness_rate: 0.0, rest_rate: 0.25 };
        let endless = MemoryLaw { gradual: strain(0.02), critical: strain(0.06), ..paper(1.0, 1.0) };
        let law = MemoryLaw { max_rest_change: 0.05, ..endless };
        let added = |law: &MemoryLaw, element: &ElementParams| -> Vec<f64> {
            let mut state = HysteresisState::new(1.0);
            let pull = |state: &mut HysteresisState| {
                let (before, far) = (state.rest, state.rest + 0.08);
                law.advance(state, far, far, 0.6, element);
                law.advance(state, before, before, 0.1, element);
                state.rest - before
            };
            (0..100).map(|_| pull(&mut state)).collect()
        };
        let new = ElementParams { initial_rest: 1.0, ..ElementParams::FLAT };
        assert!(added(&endless, &new).iter().all(|a| (a - 0.015).abs() < 1e-12));
        let limited = added(&law, &new);
        assert_eq!(limited[0].to_bits(), added(&endless, &new)[0].to_bits());
        assert!(limited.windows(2).all(|a| a[1] <= a[0]), "{limited:?}");
        let whole: f64 = limited.iter().sum();
        assert!((0.0499..=0.05).contains(&whole), "{whole}");
        // A rest value that already lies beyond the limit stays as it is.
        let mut carried = HysteresisState::new(1.2);
        law.advance(&mut carried, 1.3, 1.3, 10.0, &new);
        assert_eq!(carried.rest, 1.2);
    }

    fn recovering() -> MemoryLaw {
        MemoryLaw { recovery_per_decade: 0.1, ..paper(4.3, 1.0) }
    }

    #[test]
    fn recovery_goes_by_decades_of_time_at_every_step_size() {
        let law = recovering();
        let mut set = HysteresisState::new(0.0);
        law.advance(&mut set, 3.0, 3.0, 30.0, &ElementParams::FLAT);
        let before = set.rest;
        // A free hinge follows its rest angle.
        let wait = |state: &mut HysteresisState, duration: f64| {
            let rest = state.rest;
            law.advance(state, rest, rest, duration, &ElementParams::FLAT);
        };
        for steps in [99, 990] {
            let mut state = set;
            (0..steps).for_each(|_| wait(&mut state, 99.0 / f64::from(steps)));
            assert!((state.rest / before - 0.8).abs() < 1e-12, "two decades: {} of {before}", state.rest);
            (0..80).for_each(|k| wait(&mut state, 50.0 * 1.5f64.powi(k)));
            assert_eq!(state.rest, 0.0, "it recovers completely and no further");
        }
    }

    #[test]
    fn a_held_element_does_not_recover() {
        let law = recovering();
        let mut state = HysteresisState::new(0.0);
        law.advance(&mut state, 3.0, 3.0, 30.0, &ElementParams::FLAT);
        let (rest, gap) = (state.rest, 3.0 - state.rest);
        assert!(gap > TUNING.held_fraction * law.gradual.threshold && gap < law.gradual.threshold);
        law.advance(&mut state, 3.0, 3.0, 1000.0, &ElementParams::FLAT);
        assert_eq!(state.rest, rest);
        // Held slightly bent, it recovers until it pulls against the hold, and no farther.
        law.advance(&mut state, rest, rest, 1e9, &ElementParams::FLAT);
        assert!(
            (rest - state.rest - TUNING.held_fraction * law.gradual.threshold).abs() < 1e-12,
            "{state:?}"
        );
    }
}
