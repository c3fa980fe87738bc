//! Demands that cannot be met: cloth pinched thinner than it is, a body moved into itself, pins pulled apart. Nothing
//! explodes, what is unmet is told with its place, and when the demand ends all is well again.

use crate::run::{COTTON, Pattern, Run};
use crate::shapes::Shape;
use crease::energy::Guide;
use crease::math::Vec3;
use crease::sim::Drive;
use crease::sim::State;
use std::sync::Arc;

/// What was seen while two halves of a body closed on cloth and opened again.
pub struct Pinch {
    pub run: Run,
    /// Largest lag of the body [m], where, and when it was first and last seen [s].
    pub lag: f64,
    pub place: Vec3,
    pub seen: [f64; 2],
    /// Time at which there is room again [s].
    pub room_again: f64,
}

/// Time before anything closes [s].
const CALM: f64 = 0.3;
/// Closing speed of each half [m/s].
pub const SPEED: f64 = 0.1;

/// The first `half` points of `shape` come down and the others up by `way` [m], wait for 0.2 s and go back, with a
/// square of 0.2 m and about `points` points between them.
pub fn pinch(shape: &Shape, half: usize, way: f64, points: usize, seed: u64) -> Pinch {
    let mut pattern = Pattern::square(points, 0.2, Vec3::zeros());
    pattern.jitter(0.5e-3, seed);
    let mut run = Run::new(&pattern, COTTON, 4.0);
    run.stepper.contact.set_body(Some(shape.body()));
    let closing = way / SPEED;
    let closed = |t: f64| {
        let t = (t - CALM).max(0.0);
        let shut = (t.min(closing) - (t - closing - 0.2).clamp(0.0, closing)) * SPEED;
        shut.max(0.0)
    };
    let at = |t: f64| -> Arc<[Vec3]> {
        let shift = |k: usize| if k < half { -closed(t) } else { closed(t) };
        shape.points.iter().enumerate().map(|(k, p)| p + Vec3::y() * shift(k)).collect()
    };
    let corner: Vec<Guide> = pattern
        .x
        .iter()
        .enumerate()
        .filter(|(_, x)| x.x.abs().min(x.z.abs()) > 0.098)
        .map(|(p, x)| Guide::round(p as u32, *x, 5.0))
        .collect();
    let (mut lag, mut place, mut seen) = (0.0, Vec3::zeros(), [f64::INFINITY, 0.0]);
    let mut drive = |t: f64, _: &State| Drive {
        body: Some(at(t)),
        guides: corner.clone(),
        gravity: Vec3::zeros(),
        drag: 2.0,
        longest_step: 1.0 / 60.0,
        ..Drive::at_rest(None)
    };
    // The jitter relaxes first.
    run.go(CALM, &mut drive);
    run.fastest = 0.0;
    run.watch(2.0 * closing + 0.4, &mut drive, &mut |run, step| {
        if let Some(held) = step.unmet.body_held_up {
            seen = [run.state.time.min(seen[0]), run.state.time];
            if held.size > lag {
                (lag, place) = (held.size, held.place);
            }
        }
        true
    });
    Pinch { run, lag, place, seen, room_again: CALM + closing + 0.2 + closing }
}

/// Two spheres of 5 cm, 2 cm apart.
pub fn spheres() -> (Shape, usize) {
    let upper = Shape::sphere(Vec3::new(0.0, 0.06, 0.0), 0.05, 14);
    let half = upper.points.len();
    (upper.and(Shape::sphere(Vec3::new(0.0, -0.06, 0.0), 0.05, 14)), half)
}

/// Two plates of 8 cm, 2 cm apart: they can pass through each other, which is a body moved into itself.
pub fn plates() -> (Shape, usize) {
    let plate = |y: f64| Shape::plate(Vec3::new(-0.04, y, -0.04), Vec3::x() * 0.08, Vec3::z() * 0.08, [8, 8]);
    let half = plate(0.01).points.len();
    (plate(0.01).and(plate(-0.01)), half)
}

impl Pinch {
    pub fn line(&self, name: &str) -> String {
        format!(
            "{}; lag {:.2} mm at ({:.3}, {:.3}, {:.3}), {:.3} to {:.3} s, all open at {:.3} s; fastest {:.3} m/s",
            self.run.line(name),
            1e3 * self.lag,
            self.place.x,
            self.place.y,
            self.place.z,
            self.seen[0],
            self.seen[1],
            self.room_again,
            self.run.fastest
        )
    }

    /// Promise: no crossing, no point faster than twice the speed at which the halves close, the lag told with its place, and gone within a frame
    /// of the halves being two contact distances apart again.
    pub fn holds(&self) -> bool {
        let there = self.place.x.abs() < 0.05 && self.place.y.abs() < 0.01;
        let open = self.room_again - (0.01 - COTTON.thickness) / SPEED;
        self.run.worst == [0, 0]
            && self.lag > 1e-3
            && there
            && self.run.fastest < 2.0 * (2.0 * SPEED)
            && self.seen[1] < open + 1.0 / 60.0
            && self.run.stepper.contact.body().is_some_and(|body| body.lag().0 == 0.0)
    }
}

#[test]
fn what_is_pinched_is_held_told_and_let_go() {
    for (name, (shape, half)) in [("pinched by spheres", spheres()), ("pinched by plates", plates())] {
        let found = pinch(&shape, half, 0.013, 300, 1);
        println!("{}", found.line(name));
        assert!(found.holds());
    }
}

/// Promise: pins pulled apart to twice the cloth's length stretch it and say so; back again it is as before.
#[test]
fn pins_pulled_apart_are_told_and_forgiven() {
    let mut pattern = Pattern::square(200, 0.2, Vec3::zeros());
    pattern.jitter(0.5e-3, 2);
    let mut run = Run::new(&pattern, COTTON, 4.0);
    let pulled = |t: f64| 0.2 * (t.min(1.0) - (t - 1.2).clamp(0.0, 1.0));
    let ends: Vec<(u32, Vec3)> = pattern
        .x
        .iter()
        .enumerate()
        .filter(|(_, x)| x.x.abs() > 0.098)
        .map(|(p, x)| (p as u32, *x))
        .collect();
    let mut told: Vec<(f64, crease::sim::StepReport)> = Vec::new();
    run.watch(
        3.0,
        &mut |t, _: &State| {
            let guide = |(p, x): &(u32, Vec3)| {
                Guide::round(*p, x + Vec3::x() * (x.x.signum() * 0.5 * pulled(t)), 2000.0)
            };
            Drive {
                guides: ends.iter().map(guide).collect(),
                longest_step: 1.0 / 60.0,
                ..Drive::at_rest(None)
            }
        },
        &mut |run, step| {
            if !step.unmet.is_none() {
                told.push((run.state.time, *step));
            }
            true
        },
    );
    let most = told.iter().filter_map(|(_, step)| step.unmet.stretched).map(|s| s.size).fold(0.0, f64::max);
    let (first, last) = (told.first().map_or(0.0, |t| t.0), told.last().map_or(0.0, |t| t.0));
    let strain = |run: &Run| {
        let stretch = run.stepper.cloth.membrane.measure(&run.state.x);
        stretch.iter().map(|m| m[0].max(m[1]) - 1.0).fold(0.0, f64::max)
    };
    println!(
        "{}; strain {most:.2}, told from {first:.2} to {last:.2} s, {:.4} left, fastest {:.2} m/s",
        run.line("pins pulled apart"),
        strain(&run),
        run.fastest
    );
    assert_eq!(run.worst, [0, 0]);
    assert!(most > 0.5 && first > 0.2 && last < 2.0);
    assert!(strain(&run) < 0.05 && run.fastest < 0.5);
}
