//! Promises about the solver and the memory together.

use crate::hinge::{Watched, folded, pair};
use crease::contact::Contact;
use crease::fabric::Fabric;
use crease::garment::{Garment, RestShape};
use crease::math::Vec3;
use crease::memory::{Memory, Observed};
use crease::solve::{Cloth, Method, NewtonOptions, State, StepOptions, Stepper};
use crease::wear::Drive;

fn stepper(garment: &Garment, fabric: &Fabric, step: f64) -> Stepper {
    let newton = NewtonOptions { tolerance: 1e-9, energy: 0.0, most_iterations: 30 };
    let options =
        StepOptions { method: Method::BackwardEuler, newton, error: 1.0, shortest: step, longest: step };
    Stepper::new(Cloth::new(garment, fabric), Contact::none(garment.points.len()), options)
}

/// Nothing acts from outside.
fn free() -> Drive {
    Drive { gravity: Vec3::zeros(), drag: 0.0, ..Drive::at_rest(None) }
}

/// Moves a free hinge from rest at `angle` [rad] and returns positions after every step; `remember` may be no one.
fn swing(
    garment: &Garment,
    fabric: &Fabric,
    angle: f64,
    steps: usize,
    step: f64,
    remember: bool,
) -> (Vec<Vec<Vec3>>, Vec<u64>, Memory) {
    let mut watched = Watched::new(garment, fabric);
    let start = folded(garment, angle);
    watched.angle = watched.bending.angles(&start, &watched.angle);
    let mut stepper = stepper(garment, fabric, step);
    let mut state = State::at_rest(start.clone(), watched.angle.clone());
    let (mut course, mut events) = (vec![start], vec![0]);
    for _ in 0..steps {
        let before = state.angle.clone();
        stepper.advance(&mut state, &watched.memory.felt, &mut |_, _| free(), step);
        if remember {
            let seen = |angle| Observed { angle, stretch: &[] };
            watched.memory.commit(&watched.law, &seen(&before), &seen(&state.angle), step);
        }
        course.push(state.x.clone());
        events.push(watched.memory.events.gradual + watched.memory.events.critical);
    }
    (course, events, watched.memory)
}

/// Promise: an event is no blow. A free hinge swings, an event happens under way: the largest acceleration of any point
/// within 0.1 s after it stays below twice the largest before it.
#[test]
fn events_enter_smoothly() {
    let garment = pair(0.1);
    let step = 0.002;
    let mut worst: f64 = 0.0;
    for (density, duration) in
        [(2000.0, 0.1), (2000.0, 0.3), (10_000.0, 0.1), (10_000.0, 0.3), (10_000.0, 0.6)]
    {
        for angle in [1.6, 2.0, 2.57, 3.0] {
            let mut fabric = Fabric::preset("kow-tshirt").expect("exists");
            fabric.area_density_g_m2 = density;
            fabric.memory.critical_duration_s = duration;
            let (course, events, memory) = swing(&garment, &fabric, angle, 500, step, true);
            let Some(at) = events.iter().position(|e| *e > 0).filter(|_| memory.events.critical > 0) else {
                continue;
            };
            let acceleration = |k: usize| -> f64 {
                let bend = |p: usize| (course[k + 1][p] - course[k][p] * 2.0 + course[k - 1][p]).norm();
                (0..4).map(bend).fold(0.0, f64::max) / (step * step)
            };
            // The hinge is let go at once: the first steps are a blow of their own and do not count.
            let before = (5..at).map(acceleration).fold(0.0, f64::max);
            let after = (at..at + 50).map(acceleration).fold(0.0, f64::max);
            println!(
                "{density:>6} g/m2, event after {duration} s at {angle} rad: {before:.3} then {after:.3} m/s2, {:.2} times",
                after / before
            );
            worst = worst.max(after / before);
        }
    }
    println!("largest ratio {worst:.2}");
    assert!(worst > 0.0, "no event happened");
    assert!(worst < 2.0, "{worst}");
}

/// Promise: memory that is off costs no bit: a run that remembers nothing, a run whose thresholds are out of reach, and
/// a run that never heard of memory end with equal bits.
#[test]
fn memory_off_is_the_elastic_run_to_the_last_bit() {
    let garment = pair(0.1);
    let mut fabric = Fabric::preset("kow-tshirt").expect("exists");
    let off = swing(&garment, &fabric, 2.5, 200, 0.01, false).0;
    fabric.memory.gradual_threshold_percent = 10_000.0;
    fabric.memory.critical_threshold_percent = 10_000.0;
    let (unreached, _, memory) = swing(&garment, &fabric, 2.5, 200, 0.01, true);
    assert_eq!(memory.events.gradual + memory.events.critical, 0);
    let plain = {
        let mut stepper = stepper(&garment, &fabric, 0.01);
        let start = folded(&garment, 2.5);
        let flat = stepper.cloth.bending.angles(&garment.points, &[]);
        let angle = stepper.cloth.bending.angles(&start, &flat);
        let rest = RestShape::new(flat, garment.triangles.len());
        let mut state = State::at_rest(start.clone(), angle);
        let mut course = vec![start];
        for _ in 0..200 {
            stepper.advance(&mut state, &rest, &mut |_, _| free(), 0.01);
            course.push(state.x.clone());
        }
        course
    };
    let bits = |course: &[Vec<Vec3>]| -> Vec<u64> {
        course.iter().flatten().flat_map(|p| p.iter().map(|c| c.to_bits()).collect::<Vec<_>>()).collect()
    };
    assert_eq!(bits(&off), bits(&plain));
    assert_eq!(bits(&unreached), bits(&plain));
    let remembered = swing(&garment, &Fabric::preset("kow-tshirt").expect("exists"), 2.5, 200, 0.01, true);
    println!("events with memory: {:?}", remembered.2.events);
}
