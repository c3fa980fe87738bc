//! Sheets that fall on one another, and a sleeve that is wrung.

use crate::run::{COTTON, Kind, Pattern, Run};
use crease_geometry::math::{Mat3, Vec3};
use crease_solver::energy::TargetSpring;
use crease_solver::sim::{Loads, NewtonOptions, State};
use std::f64::consts::TAU;

const STACKED: Kind = Kind { thickness: 0.5e-3, ..COTTON };

/// `count` sheets of 0.3 m, 1 mm apart and jittered by a third of that, fall on the ground; `points` of them in all.
pub fn stack(count: usize, points: usize, seed: u64, seconds: f64) -> Run {
    let n = ((points as f64 / count as f64).sqrt().round() as usize).max(4) - 1;
    let mut pattern = Pattern::default();
    for k in 0..count {
        pattern.add([n, n], [0.3, 0.3], false, |u, v| {
            Vec3::new((u - 0.5) * 0.3, 1e-3 * (k + 1) as f64, (0.5 - v) * 0.3)
        });
    }
    pattern.jitter(0.15e-3, seed);
    let mut run = Run::new(&pattern, STACKED, 2.0 * count as f64);
    // Parallel edges of sheets that lie point over point keep Newton from its last digits.
    run.stepper.options.newton = NewtonOptions {
        displacement_tol: 1e-6,
        decrement_tol: 0.0,
        rel_decrement_tol: 0.0,
        max_iterations: 12,
    };
    run.go(seconds, &mut |_, _| Loads::gravity_only(Some(0.0)));
    run
}

/// Returns ground reaction over weight, less one; whether every point lies over the same point of the sheet below; smallest gap
/// to it [m].
pub fn judge(run: &Run, count: usize) -> (f64, bool, f64) {
    let per_sheet = run.state.x.len() / count;
    let below = |k: usize| run.state.x[k + per_sheet].y - run.state.x[k].y;
    let least = (0..run.state.x.len() - per_sheet).map(below).fold(f64::INFINITY, f64::min);
    let reaction = run.plane_force().y;
    (reaction / run.weight() - 1.0, least > 0.0, least)
}

/// Requirement: 5 and 10 sheets stay in order, weigh what they weigh within 1e-3 and come to rest below 1e-8 J within 2 s.
#[test]
fn stacked_sheets_keep_their_order_and_their_weight() {
    for count in [5, 10] {
        let run = stack(count, 16 * count, 1, 2.0);
        let (reaction, in_order, least) = judge(&run, count);
        println!(
            "{}; reaction off by {reaction:.1e}, least gap {:.3} mm, kinetic energy {:.1e} J",
            run.line(&format!("{count} sheets")),
            1e3 * least,
            run.kinetic_energy()
        );
        assert_eq!(run.worst, 0);
        assert!(in_order && reaction.abs() < 1e-3 && run.kinetic_energy() < 1e-8);
    }
}

/// A sleeve of 0.1 m across and 0.3 m long, one end fixed, the other turned `turns` times in a second each and free to
/// come nearer; then it is released for a second.
pub fn wring(points: usize, turns: f64, seed: u64) -> Run {
    const RADIUS: f64 = 0.05;
    const LENGTH: f64 = 0.3;
    /// [s].
    const STEP: f64 = 1.0 / 30.0;
    let around = (points as f64 * TAU * RADIUS / LENGTH).sqrt().round() as usize;
    let around = 2 * around.div_ceil(2);
    let along = points / around;
    let mut pattern = Pattern::default();
    pattern.add([around, along], [TAU * RADIUS, LENGTH], true, |u, v| {
        let (s, c) = (TAU * u).sin_cos();
        Vec3::new(RADIUS * c, LENGTH * v, RADIUS * s)
    });
    pattern.jitter(0.5e-3, seed);
    let mut run = Run::new(&pattern, COTTON, 4.0);
    // A rope of pressed layers: what a step leaves unsolved the next goes on with, as in a bake, and as many iterations.
    run.stepper.options.min_dt = STEP;
    run.stepper.options.newton.max_iterations = NewtonOptions::default().max_iterations;
    let rings: Vec<(u32, Vec3, bool)> = (0..around)
        .map(|i| (i as u32, false))
        .chain((0..around).map(|i| ((along * around + i) as u32, true)))
        .map(|(p, turned)| (p, pattern.x[p as usize], turned))
        .collect();
    run.go(turns + 1.0, &mut |t, _: &State| {
        let angle = TAU * t.min(turns);
        let (s, c) = angle.sin_cos();
        let turn = Mat3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
        let guide = |&(point, home, turned): &(u32, Vec3, bool)| {
            if turned {
                // Free along the axis.
                TargetSpring {
                    point,
                    target: turn * home,
                    normal: Vec3::y(),
                    stiffness: 0.0,
                    tangential_stiffness: 200.0,
                }
            } else {
                TargetSpring::isotropic(point, home, 200.0)
            }
        };
        let guides = if t < turns + 0.3 { rings.iter().map(guide).collect() } else { Vec::new() };
        Loads {
            springs: guides,
            gravity: Vec3::zeros(),
            drag: 2.0,
            max_dt: STEP,
            ..Loads::gravity_only(None)
        }
    });
    run
}

#[test]
fn a_wrung_sleeve_never_crosses() {
    let run = wring(160, 1.0, 1);
    println!("{}", run.line("sleeve, 1 turn"));
    assert_eq!(run.worst, 0);
}

/// Requirement: cloth that is carried against an obstacle is limited there and around it, and no point is drawn out of the others: step
/// sizes of neighbours differ by a tenth.
#[test]
fn cloth_carried_against_a_wall_stays_together() {
    const DISTANCE: f64 = 0.02;
    let mut pattern = Pattern::square(441, 0.3, Vec3::zeros());
    let led = pattern.x.len();
    pattern.add([2, 2], [0.04, 0.04], false, |u, v| {
        Vec3::new(0.155, 0.04 * (u - 0.5) + 1e-3, 0.04 * (v - 0.5) + 2e-3)
    });
    let mut run = Run::new(&pattern, STACKED, 2.0);
    let topology = crease_geometry::mesh::Topology::new(pattern.x.len(), &pattern.triangles);
    let lead: Vec<Vec3> =
        (0..pattern.x.len()).map(|p| if p < led { Vec3::x() * DISTANCE } else { Vec3::zeros() }).collect();
    let mut x = pattern.x.clone();
    let contact = &mut run.stepper.contact;
    contact.begin_step(&x, 0.03, 0.0, &vec![false; x.len()]);
    contact.carry(&mut x, &lead);
    assert!(crease_geometry::mesh::intersections::self_intersections(&x, &pattern.triangles).is_empty());
    let went = |p: usize| (x[p] - pattern.x[p]).x / DISTANCE;
    let apart = topology.edges.iter().map(|e| (went(e[0].at()) - went(e[1].at())).abs()).fold(0.0, f64::max);
    let (least, most) =
        (0..led).map(went).fold((f64::INFINITY, 0.0f64), |(a, b), went| (a.min(went), b.max(went)));
    println!("step sizes: {least:.2} to {most:.2}, {apart:.3} at most from point to point");
    assert!(least > 0.1 && least < 0.26 && most > 0.999 && apart < 0.11);
}

/// Requirement: layers that move along with one another, and press one another on the way, do not stop each other, if they may move as
/// zones; they stay apart, and the ground holds them.
#[test]
fn layers_that_move_along_with_one_another_move_on() {
    let mut run = stack(2, 400, 3, 0.3);
    let x = run.state.x.clone();
    let contact = &mut run.stepper.contact;
    contact.begin_step(&x, 0.01, 1.0, &vec![false; x.len()]);
    let lowest = x.iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
    let height = x.iter().map(|x| x.y).fold(0.0, f64::max);
    let upper = |x: &Vec3| x.y > 0.5 * (lowest + height);
    let mut limited_to = |up: f64, zones: bool| {
        let wished: Vec<Vec3> = x
            .iter()
            .enumerate()
            .map(|(p, x)| Vec3::new(0.02, if upper(x) { up - 2e-3 * (p % 4) as f64 } else { up }, 0.0))
            .collect();
        let gradient: Vec<Vec3> = wished.iter().map(|d| -d).collect();
        contact.set_zones(zones);
        let mut d = wished.clone();
        contact.limit_displacement(&x, &mut d, &gradient);
        let part = d.iter().zip(&wished).map(|(a, b)| a.dot(b)).sum::<f64>()
            / wished.iter().map(Vec3::norm_squared).sum::<f64>();
        let moved: Vec<Vec3> = x.iter().zip(&d).map(|(x, d)| x + d).collect();
        assert!(crease_geometry::mesh::intersections::self_intersections(&moved, &run.triangles).is_empty());
        assert!(moved.iter().all(|x| x.y > 0.0));
        assert!(contact.value(&moved).is_finite());
        part
    };
    let [alone, together, down] =
        [(0.02, false), (0.02, true), (-0.02, true)].map(|(up, z)| limited_to(up, z));
    println!(
        "{alone:.3} of the displacement point by point, {together:.3} in zones, {down:.3} towards the ground"
    );
    assert!(alone < 0.5 && together > 0.9);
}

/// Requirement: where only some points move, their contacts among one another and with the rest are those among all: same forces, same
/// differences of the energy, same limited displacements.
#[test]
fn restricted_contact_is_the_same_for_moving_points() {
    let mut run = stack(4, 400, 3, 0.3);
    let x = run.state.x.clone();
    let contact = &mut run.stepper.contact;
    let moving: Vec<bool> = (0..x.len()).map(|p| p % 9 == 4).collect();
    contact.begin_step(&x, 0.01, 1.0, &vec![false; x.len()]);
    let wished: Vec<Vec3> = moving.iter().map(|m| Vec3::new(4e-5, -4e-4, 2e-5) * f64::from(*m)).collect();
    let no_gradient = vec![Vec3::zeros(); x.len()];
    let mut limited = wished.clone();
    contact.limit_displacement(&x, &mut limited, &no_gradient);
    let moved: Vec<Vec3> = x.iter().zip(&limited).map(|(x, d)| x + d).collect();
    let force = |contact: &crease_solver::contact::Contact, x: &[Vec3]| {
        let mut g = vec![Vec3::zeros(); x.len()];
        contact.add_gradient(x, &mut g);
        g
    };
    let all = contact.value(&moved) - contact.value(&x);
    let forces = [force(contact, &x), force(contact, &moved)];
    contact.restrict_to(&x, &moving);
    let mut bounded = wished;
    contact.limit_displacement(&x, &mut bounded, &no_gradient);
    assert!(limited.iter().any(|d| d.norm() > 0.0 && d.norm() < 4e-4), "some displacements are limited");
    let apart = bounded.iter().zip(&limited).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-15, "limited alike, but for {apart} m");
    let some = contact.value(&moved) - contact.value(&x);
    assert!((all - some).abs() < 1e-9 * all.abs(), "{all} {some}");
    for (x, wanted) in [(&x, &forces[0]), (&moved, &forces[1])] {
        let scale = wanted.iter().map(|g| g.norm()).fold(0.0, f64::max);
        let found = force(contact, x);
        let differs = |p: &usize| (found[*p] - wanted[*p]).norm() > 1e-12 * scale;
        assert_eq!((0..x.len()).filter(|p| moving[*p]).find(differs), None);
    }
    contact.unrestrict();
    assert!((contact.value(&moved) - contact.value(&x) - all).abs() < 1e-9 * all.abs());
    let again = force(contact, &moved);
    let off = again.iter().zip(&forces[1]).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(off < 1e-12 * forces[1].iter().map(|g| g.norm()).fold(0.0, f64::max), "{off}");
}
