//! Cloth at rest on a body.

use crate::run::{COTTON, Pattern, Run};
use crate::shapes::Shape;
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, BodyMotion, BodyPose, PosedBody};
use crease_solver::sim::Loads;
use std::sync::Arc;

/// Requirement: cloth at rest on a sphere: the sphere carries its weight within 1e-3 and pushes nowhere else, nothing moves any
/// more (1e-8 J), and a start of fourfold symmetry stays so to 1e-6 m for 0.2 s.
#[test]
fn cloth_over_a_sphere_comes_to_rest_in_balance() {
    const N: usize = 16;
    let shape = Shape::sphere(Vec3::zeros(), 0.1, 24);
    let pattern = Pattern::square((N + 1) * (N + 1), 0.3, Vec3::new(0.0, 0.1015, 0.0));
    let mut run = Run::new(&pattern, COTTON, 4.0);
    run.precisely();
    run.put_on(&shape);
    let triangles: Vec<[u32; 3]> = shape.triangles.iter().map(|t| t.map(|p| p.0)).collect();
    let still = AnimatedBody::new("sphere", "", BodyMotion::Still, &shape.points, &triangles);
    let at = PosedBody::new(&Arc::new(still), BodyPose::Still);
    let mut drive = |_: f64, _: &crease_solver::sim::State| Loads {
        body: Some(at.clone()),
        drag: 3.0,
        ..Loads::gravity_only(None)
    };
    run.go(0.2, &mut drive);
    // A quarter turn takes the point (i, j) to (N - j, i).
    let turned = |p: usize| (p % (N + 1)) * (N + 1) + N - p / (N + 1);
    let quarter = |x: &Vec3| Vec3::new(x.z, x.y, -x.x);
    let off = |x: &[Vec3]| (0..x.len()).map(|p| (quarter(&x[p]) - x[turned(p)]).norm()).fold(0.0, f64::max);
    assert!(off(&pattern.x) < 1e-15, "the start is symmetric");
    let asymmetry = off(&run.state.x);
    run.stepper.options.newton.max_iterations = 20;
    run.go(3.0, &mut drive);
    let force = run.body_force() / run.weight();
    println!(
        "{}; asymmetry {asymmetry:.1e} m at 0.2 s, reaction off by {:.1e}, sideways {:.1e}, kinetic energy {:.1e} J",
        run.line("sphere, at rest"),
        force.y - 1.0,
        force.x.hypot(force.z),
        run.kinetic_energy()
    );
    assert_eq!(run.worst, 0);
    assert!(asymmetry < 1e-6);
    assert!((force.y - 1.0).abs() < 1e-3 && force.x.hypot(force.z) < 1e-3 && run.kinetic_energy() < 1e-8);
}
