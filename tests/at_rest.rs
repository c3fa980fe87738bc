//! Only the end decides whether a bake came to rest: its last step and the way home, not a bad step on the way.

use crease::bake::{BakeOptions, BakeReport, bake, settle};
use crease::fabric::Fabric;
use crease::garment::{Garment, RestState};
use crease::io::{ReadOptions, read_asset};
use crease::wear::WearScript;
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

/// Without memory, so that the way home is no question; `iterations` of Newton a step.
fn worn(actions: &str, iterations: usize, slack: f64) -> BakeReport {
    let text = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
    let script = WearScript::parse("wear.json", &text).expect("is valid");
    let mut options = BakeOptions { memory: false, energy_tol_m: slack, ..BakeOptions::default() };
    options.step.newton.max_iterations = iterations;
    if slack == 0.0 {
        options.step.newton.displacement_tol = 0.0;
    }
    bake(&sheet(), &fabric(), &script, "wear.json", &options, &mut ()).expect("bakes").report
}

const CRUMPLE: &str = r#"{"crumple": {"to": 0.4, "over": 0.5}}"#;

#[test]
fn a_last_step_that_did_not_converge_is_no_rest() {
    let report = worn(r#"{"settle": {"for": 0.1}}"#, 1, 0.0);
    let why = report.unconverged_reason.expect("nothing converges in one iteration without tolerance");
    assert!(why.starts_with(&format!("the last step, at {:.3} s", report.simulated)), "{why}");
}

#[test]
fn bad_steps_on_the_way_are_only_a_warning() {
    let report = worn(&format!(r#"{CRUMPLE}, {{"release": {{}}}}, {{"settle": {{"for": 3.0}}}}"#), 3, 3e-6);
    assert!(
        report.warnings.iter().any(|w| w.contains("before Newton had converged")),
        "{:?}",
        report.warnings
    );
    assert_eq!(report.unconverged_reason, None);
}

/// A memory that no shape can carry: every third edge a sharp crease, neighbours of a quarter and of four times their length.
#[test]
fn a_way_home_that_did_not_converge_is_no_rest() {
    let garment = sheet();
    let (hinges, triangles) = (garment.topology.hinges.len(), garment.triangles.len());
    let mut memory = RestState::flat(hinges, triangles);
    assert_eq!(settle(&garment, &fabric(), &memory).unconverged_reason, None);
    (0..hinges).for_each(|h| memory.rest_angle[h] = [3.0, -3.0, 2.0][h % 3]);
    (0..triangles).for_each(|t| {
        memory.rest_stretch_warp[t] = [0.25, 4.0][t % 2];
        memory.rest_stretch_weft[t] = [4.0, 0.25][t / 2 % 2];
    });
    let settled = settle(&garment, &fabric(), &memory);
    let why = settled.unconverged_reason.expect("no equilibrium within sixty iterations");
    assert!(why.starts_with("home: the equilibrium did not converge"), "{why}");
    assert!(settled.warnings.contains(&why));
}
