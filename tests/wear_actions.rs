//! What `iron`, `wash`, `pack`, `roll` and `hang` do to the memory of a handkerchief, and the error of an action that did not take
//! place: physical expectations, each with the figure that it reached:
//!
//! ```text
//! cargo test --test wear_actions NAME -- --nocapture
//! ```

use crease::internal::bake::{Bake, BakeOptions, BakeResult};
use crease::internal::wear::WearScript;
use crease::{Error, Result};
use crease_geometry::math::Vec3;

use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, MeshOptions, SheetArrays, sheet_arrays};

/// Points along a side of the handkerchief.
const POINTS: u32 = 13;
/// Length of its sides [m].
const SIDE: f64 = 0.24;

/// A level sheet of `SIDE` with the height `height` [m] as a function of the place in it, from 0 to 1.
fn sheet(height: impl Fn(f64, f64) -> f64) -> Garment {
    let SheetArrays { mut positions, triangles } =
        sheet_arrays([SIDE; 2], [POINTS - 1; 2]).expect("is a sheet");
    positions.iter_mut().for_each(|[x, y, z]| *y = height(*x / SIDE, *z / SIDE));
    Garment::from_mesh(&positions, &triangles, MeshOptions::default()).expect("is a garment")
}

fn fabric() -> Fabric {
    Fabric::preset("cotton-jersey").expect("exists")
}

fn bake(garment: &Garment, fabric: &Fabric, actions: &str) -> Result<BakeResult> {
    let text = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
    let script = WearScript::parse("wear.json", &text).expect("parses");
    Bake::new(garment, fabric, &script).script_name("wear.json").options(BakeOptions::default()).run()
}

/// The bake of a level handkerchief.
fn worn(actions: &str) -> BakeResult {
    bake(&sheet(|_, _| 0.0), &fabric(), actions).expect("bakes")
}

/// A fold from left to right, held for ten seconds.
const FOLD: &str = r#"{"lay": {"facing": "up", "over": 0.2}},
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 1, "hold": 10}}"#;
const UNFOLD: &str = r#"{"unfold": {"all": true, "over": 1}}"#;

/// Change of rest angle times length, summed over the simulated hinges whose middle `counts` in the garment's file [rad m].
fn memory_where(baked: &BakeResult, counts: impl Fn(&Vec3) -> bool) -> f64 {
    let (garment, memory) = (&baked.simulated.garment, &baked.simulated.worn.memory);
    let mut sum = 0.0;
    for (h, hinge) in garment.topology.hinges.iter().enumerate() {
        let [a, b] = [0, 1].map(|k| garment.points[hinge.points[k].at()]);
        if counts(&((a + b) * 0.5)) {
            sum += (memory.rest_angle[h] - memory.source_angle[h]).abs() * (b - a).norm();
        }
    }
    sum
}

/// The same with its sign, so that what is bent to both sides cancels: the fold.
fn fold_of(baked: &BakeResult) -> f64 {
    let (garment, memory) = (&baked.simulated.garment, &baked.simulated.worn.memory);
    let change = |(h, hinge): (usize, &crease_geometry::mesh::Hinge)| {
        let [a, b] = [0, 1].map(|k| garment.points[hinge.points[k].at()]);
        let counts = near_fold(&((a + b) * 0.5));
        if counts { (memory.rest_angle[h] - memory.source_angle[h]) * (b - a).norm() } else { 0.0 }
    };
    garment.topology.hinges.iter().enumerate().map(change).sum::<f64>().abs()
}

fn near_fold(p: &Vec3) -> bool {
    (p.x - 0.5 * SIDE).abs() < 0.02
}

/// The half towards the viewer is ironed, and loses its memory of the fold; the other half keeps it.
#[test]
fn ironed_cloth_loses_its_memory_and_the_rest_keeps_it() {
    let settle = r#"{"settle": {"for": 1}}"#;
    let plain = worn(&format!("{FOLD}, {UNFOLD}, {settle}"));
    let ironed =
        worn(&format!(r#"{FOLD}, {UNFOLD}, {{"iron": {{"box": [[0, 0], [1, 0.5]], "for": 8}}}}, {settle}"#));
    let half = |baked: &BakeResult, lower: bool| {
        memory_where(baked, |p| if lower { p.z > 0.5 * SIDE + 0.015 } else { p.z < 0.5 * SIDE - 0.015 })
    };
    let [lower, upper] = [true, false].map(|lower| half(&ironed, lower) / half(&plain, lower));
    println!("ironed half keeps {lower:.3} of its memory, the other {upper:.3}");
    assert!(half(&plain, true) > 0.05 && half(&plain, false) > 0.05);
    assert!(lower < 0.2, "{lower}");
    assert!(upper > 0.85 && upper < 1.15, "{upper}");
}

/// A fold that is ironed along its line is a crease, sharper than one that was pressed as hard and as long without heat.
#[test]
fn a_fold_that_is_ironed_along_its_line_is_set() {
    let pressed = worn(&format!(r#"{FOLD}, {{"press": {{"pressure": 4000, "for": 8}}}}, {UNFOLD}"#));
    let line = r#"{"iron": {"line": [[0.5, 0], [0.5, 1]], "for": 8}}"#;
    let ironed = worn(&format!("{FOLD}, {line}, {UNFOLD}"));
    let [pressed, ironed] = [&pressed, &ironed].map(|baked| memory_where(baked, near_fold) / SIDE);
    println!("near the line: pressed {pressed:.3} rad, ironed {ironed:.3} rad");
    assert!(pressed > 0.3);
    assert!(ironed > 1.2 * pressed && ironed < 3.3, "{ironed}");
}

/// The longer it lies under the weight the more it remembers, and hours take few steps.
#[test]
fn a_packed_garment_remembers_more_the_longer_it_lies() {
    let packed = |hold: f64| {
        let pack = format!(r#"{{"pack": {{"to": [0.5, 1], "over": 1, "pressure": 500, "for": {hold}}}}}"#);
        worn(&format!(r#"{{"lay": {{"facing": "up", "over": 0.2}}}}, {pack}, {UNFOLD}"#))
    };
    let times = [10.0, 300.0, 14_400.0];
    let baked = times.map(packed);
    let memory = [0, 1, 2].map(|k| memory_where(&baked[k], |_| true));
    let steps = [0, 1, 2].map(|k| baked[k].report.steps);
    println!("{times:?} s: {memory:.3?} rad m, {steps:?} steps");
    assert!(memory[1] > 1.1 * memory[0] && memory[2] > 1.02 * memory[1], "{memory:?}");
    assert!(steps[2] < 2 * steps[1], "four hours take {steps:?}");
}

/// Cloth that was rolled up remembers a gentle bend all over and no crease: the more the longer it lay, and the more the tighter it was
/// rolled.
#[test]
fn a_rolled_garment_remembers_its_curl_and_no_crease() {
    let rolled = |radius: f64, hold: f64| {
        let roll =
            format!(r#"{{"roll": {{"from": "left", "radius": {radius}, "over": 2, "hold": {hold}}}}}"#);
        worn(&format!(r#"{{"lay": {{"facing": "up", "over": 0.2}}}}, {roll}, {UNFOLD}"#))
    };
    let folded = worn(&format!(r#"{FOLD}, {{"hold": {{"for": 14400}}}}, {UNFOLD}"#));
    let baked = [rolled(0.012, 10.0), rolled(0.012, 14_400.0), rolled(0.04, 14_400.0), folded];
    let sharpest = [0, 1, 2, 3].map(|k| {
        let memory = &baked[k].simulated.worn.memory;
        let changes =
            memory.rest_angle.iter().zip(&memory.source_angle).map(|(rest, source)| (rest - source).abs());
        changes.fold(0.0, f64::max).to_degrees()
    });
    let memory = [0, 1, 2, 3].map(|k| memory_where(&baked[k], |_| true));
    println!("short, long, wide, folded: {memory:.3?} rad m, at most {sharpest:.1?} degrees");
    assert!(memory[1] > 0.005 && memory[1] > 1.2 * memory[0] && memory[1] > 2.0 * memory[2], "{memory:?}");
    assert!(sharpest[1] < 0.5 * sharpest[3], "{sharpest:?} degrees");
}

/// A hung garment has no fold, and overnight it loses a part of what it remembered.
#[test]
fn a_garment_that_hangs_overnight_has_no_fold_and_recovers() {
    let hung =
        |hold: f64| worn(&format!(r#"{FOLD}, {UNFOLD}, {{"hang": {{"by": "hanger", "for": {hold}}}}}"#));
    let [moment, night] = [2.0, 28_800.0].map(hung);
    let [before, after] = [&moment, &night].map(|baked| memory_where(baked, near_fold));
    let (hinges, x) = (sheet(|_, _| 0.0).topology.hinges, &night.end);
    let bends = hinges.iter().map(|h| crease_geometry::mesh::hinge_angle(&h.points.map(|p| x[p.at()])).abs());
    let sharpest = bends.fold(0.0, f64::max).to_degrees();
    println!(
        "memory of the fold {before:.3}, after a night {after:.3} rad m; sharpest bend {sharpest:.0} degrees; {} steps, {} in a moment",
        night.report.steps, moment.report.steps
    );
    assert!(before > 0.05);
    assert!(after < 0.9 * before, "{after} of {before}");
    assert!(sharpest < 60.0, "{sharpest}");
    assert!(night.report.steps < 1000, "{} steps", night.report.steps);
}

/// A washed garment has lost most of its fold and earned a soft memory to both sides.
#[test]
fn a_washed_garment_loses_its_folds_and_earns_soft_memory() {
    let before = worn(&format!("{FOLD}, {UNFOLD}"));
    let after = worn(&format!(r#"{FOLD}, {UNFOLD}, {{"wash": {{"spin": 5, "dry": 600}}}}"#));
    let [fold, left] = [&before, &after].map(fold_of);
    let away = |p: &Vec3| (p.x - 0.5 * SIDE).abs() > 0.03;
    let [none, soft] = [&before, &after].map(|baked| memory_where(baked, away));
    let memory = &after.simulated.worn.memory;
    let changes: Vec<f64> =
        memory.rest_angle.iter().zip(&memory.source_angle).map(|(a, s)| (a - s).to_degrees()).collect();
    let mean = changes.iter().map(|c| c.abs()).sum::<f64>() / changes.len() as f64;
    let upward = changes.iter().filter(|c| **c > 0.0).count() as f64 / changes.len() as f64;
    println!(
        "the fold {fold:.3} then {left:.3} rad m, away from it {none:.3} then {soft:.3}; mean change {mean:.1} degrees, {upward:.2} upward"
    );
    assert!(left < 0.5 * fold, "{left} of {fold}");
    assert!(soft > 2.0 * none, "{soft} after {none}");
    assert!(mean > 0.5 && mean < 20.0, "{mean}");
    assert!(upward > 0.25 && upward < 0.75, "{upward}");
}

fn board() -> Fabric {
    let mut board = fabric();
    (board.bend_warp_un_m, board.bend_weft_un_m) = (2e6, 2e6);
    board
}

/// A garment that is only opened at the end of a script is opened where frames show it, and remembers nothing of it.
#[test]
fn the_opening_at_the_end_leaves_no_memory() {
    let opened = |rate: f64| {
        let script = format!(
            r#"{{"format": "crease-wear/1", "actions": [{FOLD}, {UNFOLD}, {{"settle": {{"for": 1}}}}]}}"#
        );
        let script = WearScript::parse("wear.json", &script).expect("is a script");
        let (garment, fabric) = (sheet(|_, _| 0.0), fabric());
        Bake::new(&garment, &fabric, &script).frames_per_second(rate).run().expect("runs")
    };
    let [skipped, shown] = [0.0, 10.0].map(opened);
    assert_eq!(skipped.simulated.worn.memory, shown.simulated.worn.memory);
    let width =
        |x: &[Vec3]| x.iter().map(|p| p.x).fold(0.0, f64::max) - x.iter().map(|p| p.x).fold(SIDE, f64::min);
    assert!(
        width(&skipped.end) < 0.6 * SIDE && width(&shown.end) > 0.9 * SIDE,
        "{} {}",
        width(&skipped.end),
        width(&shown.end)
    );
    let told =
        |baked: &BakeResult| baked.report.decisions.iter().any(|d| d.name == "opening at the end" && !d.on);
    assert!(told(&skipped) && !told(&shown));
}

/// The message of an action that did not take place.
fn failure(baked: Result<BakeResult>) -> String {
    match baked {
        Err(other) => panic!("{other}"),
        Ok(baked) => {
            Error::NotPerformed(Box::new(baked.report.not_performed.expect("did not take place"))).to_string()
        }
    }
}

#[test]
fn a_flap_that_does_not_turn_over_is_an_error() {
    let message = failure(bake(&sheet(|_, _| 0.0), &board(), &format!("{FOLD}, {UNFOLD}")));
    println!("{message}");
    let start = "did not take place: wear.json: actions[1] (fold): the flap did not turn over";
    assert!(message.starts_with(start), "{message}");
    assert!(message.contains("choose a softer fabric"), "{message}");
}

#[test]
fn a_garment_that_does_not_lie_is_an_error() {
    // Hands press the roof flat, and it springs back.
    let roof = sheet(|x, _| SIDE * (0.5 - (x - 0.5).abs()));
    let message = failure(bake(&roof, &board(), r#"{"lay": {"facing": "up"}}"#));
    println!("{message}");
    let start = "did not take place: wear.json: actions[0] (lay): the garment does not lie";
    assert!(message.starts_with(start), "{message}");
}
