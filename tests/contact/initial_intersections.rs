//! Intersections that exist at the start: never more of them, no explosion, gone once they come apart, and guarded then.

use crate::run::{COTTON, Pattern, Run};
use crease_geometry::math::Vec3;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::{Loads, State};

/// Two sheets 2 mm apart, the lower pushed through the upper around the middle.
pub fn pierced(points: usize, seed: u64) -> Pattern {
    let n = ((points as f64 / 2.0).sqrt().round() as usize).max(4) - 1;
    let mut pattern = Pattern::default();
    for lower in [true, false] {
        pattern.add([n, n], [0.2, 0.2], false, |u, v| {
            let (x, z) = ((u - 0.5) * 0.2, (0.5 - v) * 0.2);
            let bump = if lower { 12e-3 * (-(x * x + z * z) / 4e-4).exp() } else { 2e-3 };
            Vec3::new(x + 1.3e-3 * f64::from(u8::from(lower)), 2e-3 + bump, z + 0.7e-3)
        });
    }
    pattern.jitter(0.2e-3, seed);
    pattern
}

/// Requirement: lying on the ground, intersections never become more and nothing flies away.
#[test]
fn initial_intersections_never_become_more() {
    let mut run = Run::new(&pierced(400, 1), COTTON, 4.0);
    let start = run.crossings();
    let mut last = start;
    run.watch(1.0, &mut |_, _| Loads::gravity_only(Some(0.0)), &mut |run, _| {
        let now = run.crossings();
        assert!(now <= start, "{now} after {last}");
        last = now;
        true
    });
    println!(
        "{}; {start} at the start, {last} at the end, fastest {:.3} m/s",
        run.line("pierced sheets"),
        run.fastest
    );
    assert!(start > 10 && run.fastest < 1.0);
}

/// Requirement: pulled apart, the sheets come apart; pressed together again, they stay apart.
#[test]
fn separated_sheets_are_guarded() {
    let pattern = pierced(400, 2);
    let half = pattern.x.len() / 2;
    let mut run = Run::new(&pattern, COTTON, 4.0);
    let start = run.crossings();
    // A spring at every point: the lower sheet goes down and comes back up, the upper stays.
    let guides = |shift: f64| -> Vec<TargetSpring> {
        let target = |p: usize, x: &Vec3| {
            if p < half { Vec3::new(x.x, -shift, x.z) } else { Vec3::new(x.x, 4e-3, x.z) }
        };
        pattern
            .x
            .iter()
            .enumerate()
            .map(|(p, x)| TargetSpring::isotropic(p as u32, target(p, x), 0.05))
            .collect()
    };
    let drive = |shift: f64| Loads {
        springs: guides(shift),
        gravity: Vec3::zeros(),
        drag: 5.0,
        max_dt: 1.0 / 60.0,
        ..Loads::gravity_only(None)
    };
    run.go(2.0, &mut |t, _: &State| drive(0.03 * t.min(1.0)));
    let apart = run.crossings();
    let mut worst = 0;
    run.watch(2.0, &mut |t, _: &State| drive(0.03 - 0.06 * (t - 2.0).min(1.0)), &mut |run, _| {
        worst = worst.max(run.crossings());
        true
    });
    println!(
        "{}; {start} at the start, {apart} pulled apart, {worst} pressed together; fastest {:.2} m/s",
        run.line("parted sheets"),
        run.fastest
    );
    assert!(start > 10 && apart == 0 && worst == 0 && run.fastest < 1.0);
}

/// Requirement: where a point lies exactly in a triangle, contact lets nothing pass; a step in which nothing moves says so, with the place.
#[test]
fn cloth_that_contact_holds_fast_is_stuck() {
    let centre = Vec3::new(0.0, 0.05, 0.0);
    let mut run = Run::new(&Pattern::square(121, 0.1, centre), COTTON, 4.0);
    // Put there after the cloth was made, as an action does that lays a garment out.
    let middle = run.state.x.len() / 2;
    run.state.x[middle] += Vec3::new(0.018, 0.0, 0.003);
    let place = run.state.x[middle];
    for _ in 0..3 {
        let report = run.step(&mut |_, _: &State| Loads::gravity_only(Some(0.0)), 0.01);
        let stuck = report.violations.stuck.expect("nothing moves");
        assert!(!report.converged && stuck.size < 1e-6, "{report:?}");
        assert!((stuck.position - place).norm() < 0.02, "{stuck:?}");
    }
    let mut free = Run::new(&Pattern::square(121, 0.1, centre), COTTON, 4.0);
    let report = free.step(&mut |_, _: &State| Loads::gravity_only(Some(0.0)), 0.01);
    assert_eq!(report.violations.stuck, None);
}
