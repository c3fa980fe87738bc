//! Steps in which springs guide the cloth.

use crease::GarmentFile;
use crease_geometry::math::{Vec3, bounds};
use crease_model::fabric::Fabric;
use crease_model::garment::RestState;
use crease_solver::contact::Contact;
use crease_solver::energy::TargetSpring;
use crease_solver::sim::{Cloth, Loads, State, StepOptions, StepRelaxation, StepReport, Stepper};

/// Length by which the free end of a sheet is drawn out per second, over the length of the sheet [1/s].
const RATE: f64 = 5.0;
/// Length of the step that is asked for [s]: the sheet is half as long again after it.
const STEP: f64 = 0.1;

/// The first step of a sheet that is held at one end and drawn out by springs at the other, which guide it or do not.
fn first_step(guided: bool) -> StepReport {
    let sheet = GarmentFile::sheet([0.2, 0.1], [4, 2]).expect("is a sheet").garment;
    let fabric = Fabric::preset("cotton-jersey").expect("is a preset");
    let options = StepOptions {
        local_error_tol: 1.0,
        min_dt: 0.1 * STEP,
        max_dt: STEP,
        relaxation: StepRelaxation::OFF,
        ..StepOptions::default()
    };
    let cloth = Cloth::new(&sheet, &fabric);
    let x = sheet.points.clone();
    let angle = cloth.bending.angles(&x, &[]);
    let mut stepper = Stepper::new(cloth, Contact::none(x.len()), options);
    let rest = RestState::new(angle.clone(), sheet.triangles.len());
    let mut state = State::at_rest(x.clone(), angle);
    let (low, high) = (bounds(&x).0.x, bounds(&x).1.x);
    let fixed: Vec<bool> = x.iter().map(|p| p.x < low + 1e-6).collect();
    assert!(fixed.contains(&true) && fixed.contains(&false));
    let mut loads = |t: f64, _: &State| {
        let drawn = |p: &Vec3| Vec3::new(low + (p.x - low) * (1.0 + RATE * t), p.y, p.z);
        let ends = x.iter().zip(0..).filter(|(p, _)| p.x > high - 1e-6);
        Loads {
            gravity: Vec3::zeros(),
            springs: ends.map(|(p, k)| TargetSpring::isotropic(k, drawn(p), 1e5)).collect(),
            guided,
            fixed: fixed.clone(),
            ..Loads::gravity_only(None)
        }
    };
    stepper.advance(&mut state, &rest, &mut loads, STEP)
}

#[test]
fn a_guided_step_that_overstretches_the_cloth_is_made_again_with_half_its_length() {
    let [guided, free] = [first_step(true), first_step(false)];
    println!("guided: {} s, {:?}; free: {} s, {:?}", guided.dt, guided.violations, free.dt, free.violations);
    assert!(guided.rejected == 1 && (guided.dt - 0.5 * STEP).abs() < 1e-12 && guided.violations.is_none());
    assert!(free.rejected == 0 && free.dt == STEP && free.violations.stretched.is_some());
}
