//! A garment in the shape of a body that is laid out: it rests in the cut that lies flat, and ends in the shape of its file.

#[path = "common/shirt.rs"]
mod shirt;

use crease::Result;
use crease::internal::bake::{Bake, BakeOptions, BakeResult, Checkpoint, Observer};
use crease::internal::wear::WearScript;
use crease_geometry::math::{Vec3, bounds};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use shirt::shirt;

/// Checkpoints of a run.
#[derive(Default)]
struct Keeper(Vec<Checkpoint>);

impl Observer for Keeper {
    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        self.0.push(now);
        Ok(())
    }
}

fn worn(actions: &str, from: Option<&Checkpoint>, observer: &mut dyn Observer) -> BakeResult {
    let script = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
    let script = WearScript::parse("wear.json", &script).expect("is a script");
    let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
    let options = BakeOptions { finest_edge: Some(0.04), checkpoint_steps: 8, ..BakeOptions::default() };
    let garment = shirt(0.0, false);
    let mut bake = Bake::new(&garment, &fabric, &script).options(options);
    if let Some(checkpoint) = from {
        // Through the file, as a killed process would.
        let read = Checkpoint::parse("kept", &checkpoint.to_bytes()).expect("is a checkpoint");
        bake = bake.resume("kept", read);
    }
    bake.run_with(observer).expect("runs")
}

fn size(x: &[Vec3]) -> Vec3 {
    let (low, high) = bounds(x);
    high - low
}

#[test]
fn it_lies_flat_and_ends_in_the_shape_of_its_file() {
    let result = worn(r#"{"lay": {"facing": "front"}}"#, None, &mut ());
    let note = result.report.decisions.iter().find(|decision| decision.name == "laid out flat");
    println!("{} mm high; {note:?}", 1e3 * size(&result.end).y);
    assert!(note.is_some_and(|note| note.why.contains("rms strain")), "{note:?}");
    // It is 0.2 m deep in its file.
    assert!(size(&result.end).y < 0.01, "{}", size(&result.end));
    let longest = result.worn.displacement.iter().map(|d| d.norm()).fold(0.0, f64::max);
    println!("{} mm from its shape in the file", 1e3 * longest);
    assert!(longest < 2e-3, "nothing is remembered of the cut: {longest} m");
}

#[test]
fn a_resumed_run_has_the_same_cut() {
    let actions = r#"{"lay": {"facing": "front", "over": 0.5}},
        {"fold": {"line": [[0.0, 0.5], [1.0, 0.5]], "side": "lower", "over": 0.5}}"#;
    let mut keeper = Keeper::default();
    let whole = worn(actions, None, &mut keeper);
    let within: Vec<&Checkpoint> =
        keeper.0.iter().filter(|checkpoint| !checkpoint.position.is_before_action()).collect();
    assert!(within.iter().any(|checkpoint| checkpoint.position.action == 1), "{}", within.len());
    for checkpoint in [within[0], within[within.len() - 1]] {
        let resumed = worn(actions, Some(checkpoint), &mut ());
        let what = format!("from action {}, {:.2} s", checkpoint.position.action, checkpoint.state.time);
        assert_eq!(resumed.end, whole.end, "{what}");
        assert_eq!(resumed.worn.memory, whole.worn.memory, "{what}");
    }
}
