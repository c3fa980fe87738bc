//! The T-shirt of 2,000 points, folded thrice and baked at every quality and by every integrator.
//!
//! Step sizes are controlled by error here, as in a bake, so that a setting is a quality (`bake::Quality`). The
//! reference is backward Euler with a sixth of the standard error per step and steps down to 1/240 s. Folds that
//! start in contact are sensitive to their initial condition: results scatter within a band.

use crate::bake::{BakeOptions, Quality};
use crate::chart::accuracy::point::AccuracyPoint;
use crate::chart::fold_thrice::{FOLD_THRICE, FoldThrice, reference_options};
use crate::error::Result;
use crate::sim::Method;

/// Failure by a strain beyond that of any fabric.
const OVERSTRETCHED: &str = "overstretched";

/// Bakes every setting and compares it with the reference; adds remarks to `notes`.
pub(super) fn points(notes: &mut Vec<String>) -> Result<Vec<AccuracyPoint>> {
    let scene = FoldThrice::tshirt_draft()?;
    let reference = scene.run(&reference_options())?;
    notes.push(format!(
        "{FOLD_THRICE}: the reference took {:.0} s, {} steps; rms change of its rest angles {:.2} degrees",
        reference.wall,
        reference.baked.report.steps,
        scene.rest_angle_rms(&reference.baked).to_degrees()
    ));
    let mut all = Vec::new();
    for (name, options) in settings() {
        let run = scene.run(&options)?;
        let overstretched = run.baked.report.warnings.iter().any(|w| w.contains("stretched by"));
        let failed = if scene.has_intersections(&run.baked) {
            Some("layers intersect")
        } else {
            overstretched.then_some(OVERSTRETCHED)
        };
        all.push(AccuracyPoint {
            method: options.step.method,
            setting: name,
            step: options.step.min_dt,
            tolerance: options.step.newton.displacement_tol,
            wall: run.wall,
            linear_solves: run.linear_solves,
            position_error: scene.position_error(&run.baked, &reference.baked),
            angle_error: f64::NAN,
            rest_angle_error: Some(scene.rest_angle_error(&run.baked, &reference.baked)),
            max_strain: f64::NAN,
            failed,
        });
    }
    Ok(all)
}

/// Every quality with its integrator, and every other integrator with the step control of the standard quality.
fn settings() -> Vec<(String, BakeOptions)> {
    let qualities = Quality::ALL.map(|quality| {
        let options = BakeOptions::for_quality(quality);
        (format!("quality {}", quality.name()), options)
    });
    let covered: Vec<Method> = qualities.iter().map(|(_, options)| options.step.method).collect();
    let others = Method::ALL.iter().filter(|method| !covered.contains(method)).map(|&method| {
        let mut options = BakeOptions::for_quality(Quality::Standard);
        options.step.method = method;
        ("steps of quality standard".to_owned(), options)
    });
    qualities.into_iter().chain(others).collect()
}
