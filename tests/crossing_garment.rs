//! Garments whose layers cross in their file: a sleeve through the side, the front of the collar through its back. Their folds are made as
//! without crossings.

#[path = "common/shirt.rs"]
mod shirt;

use crease::internal::bake::{Bake, BakeOptions, BakeProgress, BakeResult, Observer};
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::Garment;
use shirt::shirt;
use test_attributes::long;

fn crossings(garment: &Garment, x: &[Vec3]) -> usize {
    self_intersections(x, &garment.triangles).len()
}

/// The last frame.
#[derive(Default)]
struct LastFrame(Vec<Vec3>);

impl Observer for LastFrame {
    fn progress(&mut self, _: &BakeProgress) {}

    fn frame(&mut self, points: &[Vec3]) -> crease::Result<()> {
        self.0 = points.to_vec();
        Ok(())
    }
}

/// The result of a fold, and the last of its frames.
fn folded(garment: &Garment, rate: f64) -> (BakeResult, Vec<Vec3>) {
    let script = r#"{"format": "crease-wear/1", "actions": [
        {"lay": {"facing": "front"}},
        {"fold": {"line": [[0.0, 0.5], [1.0, 0.5]], "side": "lower", "hold": 1.0}},
        {"settle": {"for": 1.0}}]}"#;
    let script = WearScript::parse("folds.json", script).expect("is a script");
    let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
    let options = BakeOptions { finest_edge: Some(0.04), ..BakeOptions::default() };
    let mut last = LastFrame::default();
    let bake = Bake::new(garment, &fabric, &script).options(options).frames_per_second(rate);
    (bake.run_with(&mut last).expect("runs"), last.0)
}

#[long(33)]
#[test]
fn folds_are_made_whatever_crosses_in_the_file() {
    let garment = shirt(1.7, true);
    let before = crossings(&garment, &garment.points);
    assert!((60..100).contains(&before), "{before} pairs");
    let (result, last_frame) = folded(&garment, 5.0);
    let moved = garment.points.iter().zip(&result.worn.displacement);
    let worn: Vec<Vec3> = moved.map(|(x, d)| x + d).collect();
    let [at_end, in_result] = [crossings(&garment, &last_frame), crossings(&garment, &worn)];
    println!(
        "{before} pairs: {at_end} in the last frame, {in_result} in the result; {} steps",
        result.report.steps
    );
    assert!(at_end <= before && in_result <= before, "{before}, {at_end}, {in_result}");
    // They are told, the fold is made, and the result is at rest.
    let told = |what: &str| result.report.warnings.iter().any(|warning| warning.contains(what));
    assert!(told(&format!("{before} pairs of triangles cross at the start")), "{:?}", result.report.warnings);
    let mesh = result.report.decisions.iter().find(|decision| decision.name == "simulation mesh");
    assert!(mesh.is_some_and(|mesh| mesh.on), "edges along the fold lines all the same: {mesh:?}");
    assert!(result.report.not_performed.is_none(), "{:?}", result.report.not_performed);
    assert_eq!(result.report.unconverged_reason, None);
    // One start differs from the next by up to a fifth: means of three whose sleeves are moved by up to 50 micrometres.
    let others = [1e-4, 2e-4].map(|more| mean_at_fold(&folded(&shirt(1.7 + more, true), 0.0).0));
    let with = (mean_at_fold(&result) + others.iter().sum::<f64>()) / 3.0;
    let without: f64 =
        [0.0, 1e-4, 2e-4].iter().map(|bend| mean_at_fold(&folded(&shirt(*bend, false), 0.0).0)).sum::<f64>()
            / 3.0;
    println!("hinges at the fold remember {with:.3} rad, without crossings {without:.3}");
    assert!(with > 0.85 * without && without > 0.1);
}

/// Mean change of the angles of the 40 hinges that remember most [rad].
fn mean_at_fold(result: &BakeResult) -> f64 {
    let memory = &result.worn.memory;
    let change = memory.rest_angle.iter().zip(&memory.source_angle).map(|(r, s)| (r - s).abs());
    let mut strongest: Vec<f64> = change.collect();
    strongest.sort_by(|a, b| b.total_cmp(a));
    strongest[..40].iter().sum::<f64>() / 40.0
}
