//! A prescribed motion that cloth cannot follow: pins pulled apart. Nothing explodes, the violation is reported, and when the motion ends all
//! is as before.

use crate::run::{COTTON, Pattern, Run};
use crease_geometry::math::Vec3;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::{Loads, State};

/// Requirement: pins pulled apart to twice the cloth's length stretch it, which is reported; back again it is as before.
#[test]
fn pins_pulled_apart_are_reported() {
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
    let mut reported: Vec<(f64, crease_solver::sim::StepReport)> = Vec::new();
    run.watch(
        3.0,
        &mut |t, _: &State| {
            let guide = |(p, x): &(u32, Vec3)| {
                TargetSpring::isotropic(*p, x + Vec3::x() * (x.x.signum() * 0.5 * pulled(t)), 2000.0)
            };
            Loads {
                springs: ends.iter().map(guide).collect(),
                max_dt: 1.0 / 60.0,
                ..Loads::gravity_only(None)
            }
        },
        &mut |run, step| {
            if !step.violations.is_none() {
                reported.push((run.state.time, *step));
            }
            true
        },
    );
    let most =
        reported.iter().filter_map(|(_, step)| step.violations.stretched).map(|s| s.size).fold(0.0, f64::max);
    let (first, last) = (reported.first().map_or(0.0, |t| t.0), reported.last().map_or(0.0, |t| t.0));
    let strain = |run: &Run| {
        let stretch = run.stepper.cloth.membrane.measure(&run.state.x);
        stretch.iter().map(|m| m[0].max(m[1]) - 1.0).fold(0.0, f64::max)
    };
    println!(
        "{}; strain {most:.2}, reported from {first:.2} to {last:.2} s, {:.4} left, fastest {:.2} m/s",
        run.line("pins pulled apart"),
        strain(&run),
        run.fastest
    );
    assert_eq!(run.worst, 0);
    assert!(most > 0.5 && first > 0.2 && last < 2.0);
    assert!(strain(&run) < 0.05 && run.fastest < 0.5);
}
