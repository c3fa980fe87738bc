//! Promises of the law itself: scalar paths of one hinge.

use crease_model::fabric::FabricMemory;
use crease_solver::memory::{ElementParams, EventCount, HysteresisState, MemoryLaw};
use std::f64::consts::PI;

/// Paths of a hinge: times [s] and angles [rad] that it passes in straight lines.
pub const PATHS: [(&str, &[(f64, f64)]); 5] = [
    ("fold, hold, release", &[(0.0, 0.0), (2.0, 3.0), (32.0, 3.0), (33.0, 0.5), (40.0, 0.5)]),
    ("gentle bend for long", &[(0.0, 0.0), (1.0, 0.7), (61.0, 0.7), (62.0, 0.0)]),
    ("there and back", &[(0.0, 0.0), (3.0, 2.5), (6.0, 2.5), (12.0, -2.5), (15.0, -2.5), (18.0, 0.0)]),
    ("through half a turn", &[(0.0, 0.0), (4.0, 3.6), (9.0, 3.6), (15.0, -3.6), (20.0, -3.6)]),
    ("short knocks", &[(0.0, 0.0), (0.5, 2.0), (1.0, 0.0), (1.5, 2.0), (2.0, 0.0), (2.5, 2.0), (9.0, 2.0)]),
];

/// The T-shirt's numbers with other durations, or its own.
fn laws() -> [(&'static str, MemoryLaw); 4] {
    let with = |gradual_duration_s, critical_duration_s| {
        MemoryLaw::for_angles(&FabricMemory {
            gradual_duration_s,
            critical_duration_s,
            ..FabricMemory::default()
        })
    };
    let reopening =
        MemoryLaw::for_angles(&FabricMemory { reopening_percent_per_decade: 5.0, ..FabricMemory::default() });
    [
        ("t-shirt", MemoryLaw::for_angles(&FabricMemory::default())),
        ("quick", with(0.7, 0.3)),
        ("slow", with(11.0, 3.1)),
        ("reopening", reopening),
    ]
}

/// Angle of a path at a time.
fn angle_at(path: &[(f64, f64)], time: f64) -> f64 {
    for ends in path.windows(2) {
        let ((t0, a0), (t1, a1)) = (ends[0], ends[1]);
        if time <= t1 {
            return a0 + (a1 - a0) * (time - t0) / (t1 - t0);
        }
    }
    path.last().map_or(0.0, |p| p.1)
}

/// Goes along a path in steps of `step` seconds; `change` is added to every angle but the first.
fn walk(
    law: &MemoryLaw,
    path: &[(f64, f64)],
    step: f64,
    sign: f64,
    change: f64,
) -> (HysteresisState, EventCount) {
    let (mut state, mut count) = (HysteresisState::new(0.0), EventCount::default());
    let steps = (path.last().map_or(0.0, |p| p.0) / step).round() as usize;
    let angle = |k: usize| sign * (angle_at(path, k as f64 * step) + if k > 0 { change } else { 0.0 });
    for k in 0..steps {
        count += law.advance(&mut state, angle(k), angle(k + 1), step, &ElementParams::FLAT);
    }
    (state, count)
}

/// Property: what is left does not depend on the step.
#[test]
fn step_sizes_from_a_240th_to_half_a_second_leave_the_same() {
    for (law_name, law) in laws() {
        for (path_name, path) in PATHS {
            let (reference, events) = walk(&law, path, 1.0 / 240.0, 1.0, 0.0);
            for step in [1.0 / 60.0, 1.0 / 24.0, 0.1, 0.25, 0.5] {
                let (state, count) = walk(&law, path, step, 1.0, 0.0);
                let off = (state.rest - reference.rest).abs();
                assert_eq!(count, events, "{law_name}, {path_name}, step {step}");
                // Reopening starts with the first whole step that is let go.
                let bar = if law.recovery_per_decade > 0.0 { 0.01 * reference.rest.abs() } else { 1e-9 };
                assert!(off <= bar, "{law_name}, {path_name}, step {step}: off by {off}");
                assert!((state.stiffness_ratio / reference.stiffness_ratio - 1.0).abs() < 1e-9);
            }
        }
    }
}

/// Property: left and right are alike, to the last bit.
#[test]
fn reversal_leaves_the_mirror_image() {
    for (law_name, law) in laws() {
        for (path_name, path) in PATHS {
            let (a, b) =
                (walk(&law, path, 1.0 / 60.0, 1.0, 0.0).0, walk(&law, path, 1.0 / 60.0, -1.0, 0.0).0);
            assert_eq!(a.rest, -b.rest, "{law_name}, {path_name}");
            assert_eq!(a.stiffness_ratio.to_bits(), b.stiffness_ratio.to_bits(), "{law_name}, {path_name}");
        }
    }
}

/// Property: folded the other way for as long, the crease turns over.
#[test]
fn reversal_turns_the_crease_over() {
    let law = MemoryLaw::for_angles(&FabricMemory::default());
    let mut state = HysteresisState::new(0.0);
    law.advance(&mut state, 0.0, 2.5, 1.0, &ElementParams::FLAT);
    law.advance(&mut state, 2.5, 2.5, 30.0, &ElementParams::FLAT);
    let there = state.rest;
    law.advance(&mut state, 2.5, -2.5, 2.0, &ElementParams::FLAT);
    law.advance(&mut state, -2.5, -2.5, 30.0, &ElementParams::FLAT);
    println!("{there:.3} rad, then {:.3} rad", state.rest);
    assert!(there > 2.0 && state.rest < -2.0);
    assert!(state.rest.abs() <= 2.5, "an event never goes beyond where the hinge is held");
}

/// Property: 1e-9 rad in gives less than 1e-6 rad out, and less than 1e-6 of stiffness, away from an event.
#[test]
fn small_changes_stay_small() {
    let mut largest: f64 = 0.0;
    for (law_name, law) in laws() {
        for (path_name, path) in PATHS {
            let (reference, events) = walk(&law, path, 1.0 / 60.0, 1.0, 0.0);
            for change in [1e-9, -1e-9] {
                let (state, count) = walk(&law, path, 1.0 / 60.0, 1.0, change);
                assert_eq!(count, events, "{law_name}, {path_name}: these paths keep away from events");
                let off = (state.rest - reference.rest)
                    .abs()
                    .max((state.stiffness_ratio - reference.stiffness_ratio).abs());
                largest = largest.max(off);
                assert!(off < 1e-6, "{law_name}, {path_name}: {off}");
            }
        }
    }
    println!("1e-9 in, at most {largest:.1e} out");
}

/// Numbers from 0 to 1, always the same.
pub fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// Property: memory never does work. Moved at once and held, a hinge changes its stored energy by events alone.
#[test]
fn dissipation_is_never_negative() {
    let mut seed = 7;
    let mut events = EventCount::default();
    for (law_name, law) in laws().into_iter().filter(|(_, law)| law.recovery_per_decade == 0.0) {
        for gain in [1.0, 2.0, 4.0] {
            let element = ElementParams { gain, ..ElementParams::FLAT };
            let mut state = HysteresisState::new(0.0);
            for _ in 0..3000 {
                let angle = (2.0 * random(&mut seed) - 1.0) * 1.1 * PI;
                let stored = |t: &HysteresisState| 0.5 * t.stiffness_ratio * (angle - t.rest).powi(2);
                let before = stored(&state);
                events += law.advance(&mut state, angle, angle, 6.0 * random(&mut seed), &element);
                let after = stored(&state);
                assert!(after <= before * (1.0 + 1e-12), "{law_name}, gain {gain}: {before} to {after}");
                assert!(state.stiffness_ratio <= law.max_stiffness_ratio);
            }
        }
    }
    println!("{events:?} without one that gives energy");
    assert!(events.gradual > 1000 && events.critical > 1000);
}

/// Property: thresholds of zero and infinity are legal; unreachable ones remember nothing.
#[test]
fn zero_and_infinite_thresholds_do_no_harm() {
    for (low, high) in
        [(0.0, 0.0), (0.0, f64::INFINITY), (f64::INFINITY, f64::INFINITY), (0.3, f64::INFINITY)]
    {
        for (path_name, path) in PATHS {
            let mut law = MemoryLaw::for_angles(&FabricMemory::default());
            (law.gradual.threshold, law.critical.threshold) = (low, high);
            let (state, count) = walk(&law, path, 1.0 / 60.0, 1.0, 0.0);
            assert!(state.rest.is_finite() && state.stiffness_ratio.is_finite(), "{path_name}: {state:?}");
            assert_eq!(count.critical > 0, high == 0.0, "{path_name}");
            assert_eq!(count.gradual > 0, low.is_finite() && high > 0.0, "{path_name}");
            // Events of a band without a threshold move nothing.
            assert_eq!(
                (state.rest, state.stiffness_ratio) != (0.0, 1.0),
                low == 0.3,
                "{path_name}: {state:?}"
            );
        }
    }
}
