//! What the search for contacts and the bound on motion cost: their fraction of a step for 0, 1, 2, 4 and 8 layers, and how it
//! grows with the number of points.
//!
//! ```text
//! cargo run --release --example contact_cost
//! ```

// Every module serves the tests too, and this program uses a part of each.
#![allow(dead_code)]

#[path = "run.rs"]
mod run;
#[path = "shapes.rs"]
mod shapes;

use crease_geometry::math::Vec3;
use crease_solver::sim::Loads;
use run::{COTTON, Kind, Pattern, Run};
use std::time::Instant;

/// Length of an element [m].
const EDGE: f64 = 5e-3;

/// `layers` sheets of `points` points in all, a contact distance apart over the ground (0: one, far from it), jittered.
fn pile(layers: usize, points: usize) -> Run {
    let kind = Kind { thickness: 0.5e-3, ..COTTON };
    let sheets = layers.max(1);
    let n = ((points as f64 / sheets as f64).sqrt().round() as usize).max(4) - 1;
    let size = EDGE * n as f64;
    let mut pattern = Pattern::default();
    for k in 0..sheets {
        let height = if layers == 0 { 1.0 } else { 0.6e-3 * (k + 1) as f64 };
        pattern.add([n, n], [size, size], false, |u, v| {
            Vec3::new((u - 0.5) * size, height, (0.5 - v) * size + 0.3 * EDGE * k as f64)
        });
    }
    pattern.jitter(0.1e-3, 1);
    Run::new(&pattern, kind, 2.0 * sheets as f64)
}

/// Milliseconds of a step and of contact in it, linear solves in it: mean over `steps` steps of 1/100 s.
fn measure(layers: usize, points: usize, steps: usize) -> (usize, [f64; 3]) {
    let mut run = pile(layers, points);
    let mut drive = |_: f64, _: &crease_solver::sim::State| Loads::gravity_only(Some(0.0));
    run.stepper.options.max_dt = 0.01;
    run.stepper.options.min_dt = 0.01;
    let mut advance = |run: &mut Run| {
        let report = run.stepper.advance(&mut run.state, &run.memory, &mut drive, 0.01);
        (report.newton.global_iterations, report.newton.seconds.contact)
    };
    // The first two build patterns.
    (0..2).for_each(|_| {
        advance(&mut run);
    });
    let clock = Instant::now();
    let (mut solves, mut contact) = (0, 0.0);
    for _ in 0..steps {
        let (more, seconds) = advance(&mut run);
        solves += more;
        contact += seconds;
    }
    let whole = clock.elapsed().as_secs_f64();
    let count = steps as f64;
    (run.state.x.len(), [1e3 * whole / count, 1e3 * contact / count, solves as f64 / count])
}

fn main() {
    let count = |k: usize, or: usize| std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (points, most) = (count(1, 8000), count(2, 60_000));
    println!("layers, points, step [ms], contact [ms], fraction [%], linear solves a step");
    for layers in [0, 1, 2, 4, 8] {
        let (n, [whole, contact, solves]) = measure(layers, points, 8);
        println!("{layers}, {n}, {whole:.1}, {contact:.1}, {:.1}, {solves:.1}", 100.0 * contact / whole);
    }
    println!("points, contact [ms] a step, contact [ms] a solve: 4 layers");
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for n in [2000, 6000, 20_000, 60_000].into_iter().filter(|n| *n <= most) {
        let (n, [_, contact, solves]) = measure(4, n, 5);
        println!("{n}, {contact:.1}, {:.2}", contact / solves);
        rows.push((n as f64, contact / solves));
    }
    if let [first, .., last] = rows[..] {
        println!("exponent per solve {:.2}", (last.1 / first.1).ln() / (last.0 / first.0).ln());
    }
}
