//! Only the end decides whether the result of a bake is an equilibrium: its last step and the relaxation, not a step between.

use crease::internal::bake::{Bake, BakeOptions, BakeReport, relax};
use crease::internal::wear::WearScript;
use crease_io::{ReadOptions, read_asset};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::sim::StepOptions;
use std::fmt::Write;

/// A level sheet of 8 x 8 squares of 20 mm.
fn sheet() -> Garment {
    let mut text = String::new();
    for k in 0..81 {
        writeln!(text, "v {} 0 {}", 0.02 * f64::from(k % 9), 0.02 * f64::from(k / 9)).expect("text grows");
    }
    for k in (0..72).filter(|k| k % 9 < 8) {
        let (a, b) = (k + 1, k + 10);
        writeln!(text, "f {a} {b} {}\nf {} {b} {}", a + 1, a + 1, b + 1).expect("text grows");
    }
    let read = ReadOptions::default();
    let (asset, _) =
        read_asset("sheet.obj", text.as_bytes(), &read, &mut |_| Ok(Vec::new())).expect("is a mesh");
    Garment::from_asset(&asset).expect("is a garment").0
}

fn fabric() -> Fabric {
    Fabric::preset("cotton-poplin").expect("exists")
}

/// A bake without memory, so that the relaxation has nothing to do, with at most `iterations` of Newton a step.
fn worn(actions: &str, iterations: usize, slack: f64) -> BakeReport {
    let text = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
    let script = WearScript::parse("wear.json", &text).expect("is valid");
    let mut step = StepOptions::default();
    step.newton.max_iterations = iterations;
    if slack == 0.0 {
        step.newton.displacement_tol = 0.0;
    }
    let options =
        BakeOptions { memory: false, step: Some(step), energy_tol_m: Some(slack), ..BakeOptions::default() };
    Bake::new(&sheet(), &fabric(), &script).options(options).run().expect("bakes").report
}

const CRUMPLE: &str = r#"{"crumple": {"to": 0.4, "over": 0.5}}"#;

#[test]
fn a_last_step_that_did_not_converge_is_no_equilibrium() {
    let report = worn(r#"{"settle": {"for": 0.1}}"#, 1, 0.0);
    let why = report.unconverged_reason.expect("nothing converges in one iteration without tolerance");
    assert!(
        why.starts_with(&format!("last step (t = {:.3} s) stopped unconverged", report.simulated)),
        "{why}"
    );
}

#[test]
fn unconverged_steps_before_the_last_are_only_a_warning() {
    let report = worn(&format!(r#"{CRUMPLE}, {{"release": {{}}}}, {{"settle": {{"for": 5.0}}}}"#), 3, 3e-6);
    assert!(
        report.warnings.iter().any(|w| w.contains("before Newton had converged")),
        "{:?}",
        report.warnings
    );
    assert_eq!(report.unconverged_reason, None);
}

/// A memory that no shape can carry: every third edge a sharp crease, neighbours of a quarter and of four times their length.
#[test]
fn a_relaxation_that_did_not_converge_is_no_equilibrium() {
    let garment = sheet();
    let (hinges, triangles) = (garment.topology.hinges.len(), garment.triangles.len());
    let mut memory = RestState::flat(hinges, triangles);
    assert_eq!(relax(&garment, &fabric(), &memory).unconverged_reason, None);
    (0..hinges).for_each(|h| memory.rest_angle[h] = [3.0, -3.0, 2.0][h % 3]);
    (0..triangles).for_each(|t| {
        memory.rest_stretch_warp[t] = [0.25, 4.0][t % 2];
        memory.rest_stretch_weft[t] = [4.0, 0.25][t / 2 % 2];
    });
    let relaxed = relax(&garment, &fabric(), &memory);
    let why = relaxed.unconverged_reason.expect("no equilibrium within sixty iterations");
    assert!(why.starts_with("relaxation: the equilibrium did not converge"), "{why}");
    assert!(relaxed.warnings.contains(&why));
}
