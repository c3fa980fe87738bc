//! Properties of the solver and the memory together.

use crate::hinge::{Watched, folded, pair};
use crease::internal::bake::{Bake, BakeOptions};
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;

use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::contact::Contact;
use crease_solver::memory::{Memory, Strains};
use crease_solver::sim::{Cloth, Loads, Method, NewtonOptions, State, StepOptions, StepRelaxation, Stepper};

fn stepper(garment: &Garment, fabric: &Fabric, step: f64) -> Stepper {
    let newton = NewtonOptions {
        displacement_tol: 1e-9,
        decrement_tol: 0.0,
        rel_decrement_tol: 0.0,
        max_iterations: 30,
    };
    let options = StepOptions {
        method: Method::BackwardEuler,
        newton,
        local_error_tol: 1.0,
        min_dt: step,
        max_dt: step,
        relaxation: StepRelaxation::OFF,
    };
    Stepper::new(Cloth::new(garment, fabric), Contact::none(garment.points.len()), options)
}

/// Nothing acts from outside.
fn free() -> Loads {
    Loads { gravity: Vec3::zeros(), drag: 0.0, ..Loads::gravity_only(None) }
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
        stepper.advance(&mut state, &watched.memory.effective_rest, &mut |_: f64, _: &_| free(), step);
        if remember {
            let seen = |angle| Strains { angle, stretch: &[] };
            watched.memory.commit(&watched.law, &seen(&before), &seen(&state.angle), step);
        }
        course.push(state.x.clone());
        events.push(watched.memory.events.gradual + watched.memory.events.critical);
    }
    (course, events, watched.memory)
}

/// Property: an event does not act like a blow. A free hinge swings, an event happens meanwhile: the largest acceleration of any point
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

/// Property: memory that is off costs no bit: a run that remembers nothing, a run whose thresholds are out of reach, and
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
        let rest = RestState::new(flat, garment.triangles.len());
        let mut state = State::at_rest(start.clone(), angle);
        let mut course = vec![start];
        for _ in 0..200 {
            stepper.advance(&mut state, &rest, &mut |_: f64, _: &_| free(), 0.01);
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

/// A handkerchief of 24 cm, 13 x 13 points.
fn handkerchief() -> Garment {
    Garment::sheet([0.24; 2], [12; 2]).expect("is a sheet")
}

/// The same of a whole bake, with contact, friction and the way initial_rest: after a fold, with memory off and with thresholds
/// out of reach, every point is at the same place to the last bit; with the fabric's own it is not.
#[test]
fn a_bake_with_memory_off_is_elastic_to_the_last_bit() {
    let garment = handkerchief();
    let script = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "up", "over": 0.2}},
        {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "angle": 180, "over": 1, "hold": 2}},
        {"unfold": {"all": true, "over": 1}}]}"#;
    let script = WearScript::parse("wear.json", script).expect("parses");
    let run = |fabric: &Fabric, memory: bool| {
        let options = BakeOptions { memory, ..BakeOptions::default() };
        let baked = Bake::new(&garment, fabric, &script).options(options).run().expect("bakes");
        let places = baked.end.iter().chain(&baked.worn.displacement);
        let bits: Vec<[u64; 3]> = places.map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect();
        (bits, baked.report.events.gradual + baked.report.events.critical)
    };
    let own = Fabric::preset("kow-tshirt").expect("exists");
    let mut unreached = own.clone();
    unreached.memory.gradual_threshold_percent = 10_000.0;
    unreached.memory.critical_threshold_percent = 10_000.0;
    unreached.memory.gradual_stretch_threshold_percent = 10_000.0;
    unreached.memory.critical_stretch_threshold_percent = 10_000.0;
    let ((off, _), (never, none), (worn, some)) = (run(&own, false), run(&unreached, true), run(&own, true));
    println!("events {none} and {some}");
    assert_eq!(none, 0);
    assert!(some > 0);
    assert!(off == never, "memory that is off, or never used, costs bits");
    assert!(off != worn, "the scene asks nothing of memory");
}
