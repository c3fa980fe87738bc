//! Properties of strips that are folded between plates or bent to and fro, as the charts have them.

use crate::hessian_shift::HessianShift;
use crease_chart::kes_loop::{bend, read};
use crease_chart::press_between_plates::PlatePress;
use crease_geometry::math::Vec3;
use crease_model::fabric::Fabric;
use crease_solver::contact::Contact;
use crease_solver::energy::{Bending, Energy, Membrane};
use crease_solver::sim::{NewtonOptions, Problem, Workspace};

fn press(gap: f64, element: f64, offset: f64) -> PlatePress {
    PlatePress { length: 0.2, width: 0.02, gap, element, offset }
}

/// Property: longer holds leave no less, in every fabric, and in the end more.
#[test]
fn longer_holds_leave_more() {
    for name in Fabric::preset_names() {
        let fabric = Fabric::preset(name).expect(name);
        let angles = [1.0, 5.0, 30.0, 120.0].map(|hold| {
            press(fabric.thickness(), 0.005, 0.0).hold(&fabric, hold).crease_angle().to_degrees()
        });
        println!("{name:<22} {angles:.1?} degrees left after 1, 5, 30, 120 s");
        assert!(angles.is_sorted_by(|a, b| a <= b), "{name}: {angles:?}");
        assert!(angles[3] > angles[0], "{name}: {angles:?}");
    }
}

/// Property: let go, cloth springs back partly: the crease left lies between flat and folded.
#[test]
fn what_is_let_go_springs_back() {
    for name in Fabric::preset_names() {
        let fabric = Fabric::preset(name).expect(name);
        let left = press(fabric.thickness(), 0.005, 0.0).hold(&fabric, 30.0).crease_angle().to_degrees();
        println!("{name:<22} {left:.1} degrees of 180 left");
        assert!((1.0..179.0).contains(&left), "{name}: {left}");
    }
}

/// The solver agrees that a strip which was let go lies at its rest angles.
#[test]
fn the_solver_opens_the_strip_to_its_rest_angles() {
    let fabric = Fabric::preset("cotton-poplin").expect("exists");
    let strip = PlatePress { length: 0.04, ..press(1e-3, 0.005, 0.0) }.hold(&fabric, 300.0);
    let garment = strip.garment();
    let bending = Bending::new(garment, &fabric);
    let membrane = Membrane::new(garment, &fabric);
    // One limb is clamped, the other starts a little beside its place.
    let held: Vec<bool> = garment.points.iter().map(|p| p.x < -0.001).collect();
    let mut x: Vec<Vec3> = garment.points.iter().map(|p| p + Vec3::y() * 0.1 * p.x.max(0.0)).collect();
    let mut angle = bending.angles(&garment.points, &[]);
    let goal = &strip.memory.rest;
    // The rest angles are let in by degrees, as a bake does: a fold is not one Newton step away.
    for part in 1..=40 {
        let mut memory = goal.clone();
        memory.rest_angle.iter_mut().for_each(|r| *r *= f64::from(part) / 40.0);
        let membrane = membrane.term(&memory, &[], f64::INFINITY);
        let term = bending.term(&memory, &angle, f64::INFINITY);
        let terms: [&dyn Energy; 3] = [&membrane, &term, &HessianShift(1e-9)];
        let problem = Problem { inertia: None, terms: &terms, fixed: &held, predicted_positions: None };
        let newton = NewtonOptions {
            displacement_tol: 1e-10,
            decrement_tol: 0.0,
            rel_decrement_tol: 0.0,
            max_iterations: 60,
        };
        let mut contact = Contact::none(x.len());
        problem.solve(&mut x, &mut contact, &newton, &mut Workspace::default());
        angle = bending.angles(&x, &angle);
    }
    let (tip, before) =
        garment.points.iter().zip(&x).fold((Vec3::zeros(), Vec3::zeros()), |sum, (rest, now)| {
            if rest.x > 0.019 {
                (sum.0 + now, sum.1)
            } else if (rest.x - 0.005).abs() < 1e-6 {
                (sum.0, sum.1 + now)
            } else {
                sum
            }
        });
    let limb = tip - before;
    let opened = limb.y.abs().atan2(limb.x).to_degrees();
    let read = strip.crease_angle().to_degrees();
    println!("limbs {opened:.3} degrees apart, rest angles {read:.3}");
    assert!((opened - read).abs() < 0.5);
}

/// Property: the mesh matters little. The T-shirt held for 30 s between plates 1, 3 and 6 mm apart: 5 and 2.5 mm within
/// 5 %, all four within 10 %, on the mean of four places of the fold between two lines of the mesh. Single places
/// are printed.
#[test]
fn mesh_widths_of_20_10_5_and_2_5_mm_crease_alike() {
    let fabric = Fabric::preset("kow-tshirt").expect("exists");
    let places = [0.0, 0.25, 0.5, 0.75];
    let spread = |angles: &[f64]| {
        let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
        angles.iter().copied().fold(0.0, f64::max) / low - 1.0
    };
    for gap in [1e-3, 3e-3, 6e-3] {
        let mean = [0.02, 0.01, 0.005, 0.0025].map(|w| {
            let left =
                places.map(|place| press(gap, w, place).hold(&fabric, 30.0).crease_angle().to_degrees());
            println!("gap {:.0} mm, element {:>4} mm: {left:.1?} degrees left", 1e3 * gap, 1e3 * w);
            left.iter().sum::<f64>() / places.len() as f64
        });
        let (all, finest) = (spread(&mean), spread(&mean[2..]));
        println!("  mean {mean:.1?}: {:.1} %, the finest two {:.1} %", 100.0 * all, 100.0 * finest);
        assert!(all <= 0.10 && finest <= 0.05, "gap {gap}: {mean:?}");
    }
}

/// Property: flexing does not ratchet: after 50 cycles of a KES loop the stiffness is within its ceiling, and from the
/// thirtieth cycle on every loop is the same to a thousandth. The hinges next to the jaws have fewer others around them, so that
/// they reach the ceiling last.
#[test]
fn fifty_flex_cycles_do_not_ratchet() {
    for name in ["kow-tshirt", "linen", "wool-summer-suiting"] {
        let fabric = Fabric::preset(name).expect(name);
        let (cycles, rate) = (50, 20);
        let samples = bend(&fabric, cycles, rate);
        let period = 20 * rate;
        let areas: Vec<f64> =
            (0..cycles).map(|k| read(&samples[k * period..=(k + 1) * period]).area).collect();
        let scale = areas[29].abs().max(1e-6);
        let drift = areas[29..].iter().map(|a| (a - areas[29]).abs() / scale).fold(0.0, f64::max);
        let stiffest = samples.iter().map(|s| s.stiffness_ratio).fold(0.0, f64::max);
        println!("{name:<22} ratio at most {stiffest:.2}, loops 30 to 50 differ by {drift:.1e}");
        // The mean over the hinges of a strip is rounded.
        assert!(stiffest <= fabric.memory.stiffness_ceiling * (1.0 + 1e-12));
        assert!(drift <= 1e-3 && areas.iter().all(|a| *a >= -1e-12), "{name}: {:?}", &areas[..4]);
    }
}
