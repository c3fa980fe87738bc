//! Cloth dropped over bodies: a sphere, one with spikes, a closed one that is not convex.

use crate::run::{COTTON, Pattern, Run};
use crate::shapes::Shape;
use crease::math::Vec3;
use crease::wear::Drive;
use std::sync::Arc;

/// A square of 0.3 m and about `points` points, jittered, falls on `shape`.
pub fn drop(shape: &Shape, points: usize, seed: u64, seconds: f64) -> Run {
    let top = shape.points.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    let mut pattern = Pattern::square(points, 0.3, Vec3::new(0.0, top + 5e-3, 0.0));
    pattern.jitter(1e-3, seed);
    let mut run = Run::new(&pattern, COTTON, 4.0);
    run.stepper.contact.set_body(Some(shape.body()));
    let at: Arc<[Vec3]> = shape.points.clone().into();
    run.go(seconds, &mut |_, _| Drive { body: Some(at.clone()), drag: 2.0, ..Drive::at_rest(Some(-0.3)) });
    run
}

pub fn sphere() -> Shape {
    Shape::sphere(Vec3::zeros(), 0.1, 24)
}

pub fn spiked() -> Shape {
    Shape::spiked(Vec3::zeros(), 0.08, 0.03, 18)
}

pub fn torus() -> Shape {
    Shape::torus(Vec3::zeros(), [0.08, 0.03], [32, 16])
}

#[test]
fn cloth_dropped_over_bodies_never_crosses() {
    for (name, shape) in [("sphere", sphere()), ("spiked", spiked()), ("torus", torus())] {
        let run = drop(&shape, 400, 1, 0.6);
        println!("{}", run.line(name));
        assert_eq!(run.worst, [0, 0]);
    }
}
