//! Checkpoints: a bake that is resumed from any of them ends with the bytes of one that was never interrupted.

#[path = "common/tool.rs"]
mod tool;

use crease::internal::bake::{Bake, BakeOptions, BakeResult, Checkpoint, Observer};
use crease::internal::wear::WearScript;
use crease::{Error, Result};
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, read_asset, read_body};
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;
use crease_solver::sim::{Method, StepOptions};
use test_attributes::long;
use tool::{Pose, wavy_sheet};

/// Every action whose runner has a state of its own: `unfold` the fold it opens.
const SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [
    {"lay": {"facing": "front", "over": 0.3}},
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.6, "hold": 0.3}},
    {"fold": {"line": [[0, 0.5], [1, 0.5]], "side": "lower", "over": 0.6}},
    {"press": {"pressure": 300, "for": 2}},
    {"unfold": {"all": true, "over": 1.0}},
    {"repeat": {"times": 2, "actions": [{"settle": {"for": 0.3}}]}},
    {"crumple": {"to": 0.5, "over": 0.5}},
    {"release": {}},
    {"hang": {"for": 0.5}}]}"#;

/// A slightly wavy sheet that hangs.
fn sheet(cells: usize) -> String {
    wavy_sheet(cells, 0.004, Pose::Hanging)
}

struct Scene {
    garment: Garment,
    fabric: Fabric,
    script: WearScript,
    options: BakeOptions,
}

impl Scene {
    fn new(method: Method) -> Self {
        let text = sheet(9);
        let read = ReadOptions::default();
        let (asset, _) = read_asset("sheet.obj", text.as_bytes(), &read, &mut |_| Ok(Vec::new())).unwrap();
        let mut options =
            BakeOptions { frames_per_second: 5.0, checkpoint_steps: 8, ..BakeOptions::default() };
        options.step = Some(StepOptions { method, ..options.step() });
        options.finest_edge = Some(0.02);
        // One method on a mesh of its own, which is refined during the run; the others on the sheet's few triangles.
        options.own_triangles = method != Method::BackwardEuler;
        Self {
            garment: Garment::from_asset(&asset).unwrap().0,
            fabric: Fabric::preset("cotton-poplin").unwrap(),
            script: WearScript::parse("wear.json", SCRIPT).unwrap(),
            options,
        }
    }

    fn job(&self) -> Bake<'_> {
        Bake::new(&self.garment, &self.fabric, &self.script).options(self.options.clone())
    }

    fn bake(&self, observer: &mut dyn Observer) -> Result<BakeResult> {
        self.job().run_with(observer)
    }

    fn resume(&self, from: &Checkpoint, observer: &mut dyn Observer) -> Result<BakeResult> {
        // Through the file, as a killed process would.
        let read = Checkpoint::parse("x.checkpoint", &from.to_bytes())?;
        assert!(&read == from, "a checkpoint does not read back as it was");
        self.job().resume("x.checkpoint", read).run_with(observer)
    }
}

/// Keeps every checkpoint and every frame; stops after `max_steps` steps.
struct Keeper {
    checkpoints: Vec<Checkpoint>,
    frames: Vec<Vec<Vec3>>,
    max_steps: u64,
}

impl Keeper {
    fn new(max_steps: u64) -> Self {
        Self { checkpoints: Vec::new(), frames: Vec::new(), max_steps }
    }
}

impl Observer for Keeper {
    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        self.frames.push(x.to_vec());
        Ok(())
    }

    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        self.checkpoints.push(now);
        Ok(())
    }

    fn should_stop(&mut self) -> bool {
        self.max_steps -= 1;
        self.max_steps == 0
    }
}

fn assert_same(one: &BakeResult, other: &BakeResult, what: &str) {
    assert_eq!(one.worn.displacement, other.worn.displacement, "{what}: displacement");
    assert_eq!(one.worn.memory, other.worn.memory, "{what}: memory");
    assert_eq!(one.end, other.end, "{what}: end");
    let counts =
        |b: &BakeResult| (b.report.steps, b.report.rejected, b.report.solves, b.report.warnings.clone());
    assert_eq!(counts(one), counts(other), "{what}: counts");
    assert_eq!(one.report.not_performed, other.report.not_performed, "{what}: what did not take place");
}

#[test]
fn another_strength_needs_no_other_run() {
    let mut scene = Scene::new(Method::BackwardEuler);
    let mut keeper = Keeper::new(u64::MAX);
    let whole = scene.bake(&mut keeper).unwrap();
    let last = keeper.checkpoints.pop().expect("there is one at the end");
    scene.options.strength = 0.5;
    let half = scene.resume(&last, &mut ()).unwrap();
    assert_eq!(half.end, whole.end);
    let [of_whole, of_half] = [&whole, &half].map(|baked| &baked.simulated.worn.memory);
    let largest = |rest: &crease::RestState| rest.angle_changes().map(f64::abs).fold(0.0, f64::max);
    assert!(largest(of_whole) > 0.1, "{}", largest(of_whole));
    assert_eq!(*of_half, of_whole.strengthened(0.5));
    scene.options.strength = -1.0;
    let refused = scene.bake(&mut ()).unwrap_err().to_string();
    assert!(refused.contains("strength"), "{refused}");
}

fn resumed_anywhere(method: Method) {
    let scene = Scene::new(method);
    let plain = scene.bake(&mut ()).unwrap();
    let mut keeper = Keeper::new(u64::MAX);
    let watched = scene.bake(&mut keeper).unwrap();
    // Keeping checkpoints changes nothing.
    assert_same(&plain, &watched, "watched");
    assert!(plain.report.events.gradual + plain.report.events.critical > 0, "the scene earns memory");
    let between = keeper.checkpoints.iter().filter(|c| !c.position.is_before_action()).count();
    assert!(between >= 20, "{between} checkpoints lie within actions");
    let actions: Vec<usize> = keeper
        .checkpoints
        .iter()
        .filter(|c| c.position.is_before_action())
        .map(|c| c.position.action)
        .collect();
    assert_eq!(actions, (0..=scene.script.flatten().count()).collect::<Vec<_>>(), "one after every action");
    // An odd stride meets beginnings of actions and positions within them.
    let refined = keeper.checkpoints.iter().any(|c| !c.splits.is_empty());
    assert_eq!(refined, !scene.options.own_triangles, "the mesh is refined during the run");
    let resumed = if refined { 4 } else { 9 };
    for checkpoint in keeper.checkpoints.iter().step_by(keeper.checkpoints.len() / resumed) {
        let mut later = Keeper::new(u64::MAX);
        let what = format!("from action {}, {:.2} s", checkpoint.position.action, checkpoint.state.time);
        let resumed = scene.resume(checkpoint, &mut later).unwrap();
        assert_same(&plain, &resumed, &what);
        let frames = &keeper.frames[checkpoint.counts.frames.shown as usize..];
        assert!(frames == later.frames, "{what}: frames");
    }
}

#[long(100)]
#[test]
fn backward_euler_goes_on_as_if_nothing_had_been() {
    resumed_anywhere(Method::BackwardEuler);
}

#[long(45)]
#[test]
fn bdf2_goes_on_as_if_nothing_had_been() {
    resumed_anywhere(Method::Bdf2);
}

/// Cloth as stiff as board: a flap that does not turn over, and a sheet too wavy to lie.
#[test]
fn what_did_not_take_place_is_still_known_after_it_goes_on() {
    let mut board = Fabric::preset("cotton-poplin").unwrap();
    (board.bend_warp_un_m, board.bend_weft_un_m) = (2e6, 2e6);
    let fold = r#"{"lay": {"facing": "front", "over": 0.3}}, {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left"}}"#;
    for (name, actions, amplitude) in [("fold", fold, 0.0), ("lay", r#"{"lay": {"facing": "front"}}"#, 0.06)]
    {
        let text = wavy_sheet(9, amplitude, Pose::Hanging);
        let read = ReadOptions::default();
        let (asset, _) = read_asset("sheet.obj", text.as_bytes(), &read, &mut |_| Ok(Vec::new())).unwrap();
        let text =
            format!(r#"{{"format": "crease-wear/1", "actions": [{actions}, {{"settle": {{"for": 0.2}}}}]}}"#);
        let scene = Scene {
            garment: Garment::from_asset(&asset).unwrap().0,
            fabric: board.clone(),
            script: WearScript::parse("wear.json", &text).unwrap(),
            options: BakeOptions { own_triangles: true, ..BakeOptions::default() },
        };
        let mut keeper = Keeper::new(u64::MAX);
        let plain = scene.bake(&mut keeper).unwrap();
        let failure = plain.report.not_performed.as_ref().expect("did not take place");
        assert!(failure.location.contains(name), "{failure}");
        let later = keeper.checkpoints.iter().rev().take(2);
        for checkpoint in later {
            assert_same(&plain, &scene.resume(checkpoint, &mut ()).unwrap(), name);
        }
    }
}

/// On a body: how it is bent, where it is, what it has lifted and pinched go on, too.
#[test]
fn on_a_body_it_goes_on_as_if_nothing_had_been() {
    let path =
        std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/sleeve.glb");
    let read = ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() };
    let bytes = std::fs::read(path).unwrap();
    let (asset, _) = read_asset("sleeve.glb", &bytes, &read, &mut |_| Ok(Vec::new())).unwrap();
    let arm: Vec<_> = asset.pieces.iter().filter(|piece| piece.name == "arm").collect();
    let script = r#"{"format": "crease-wear/1", "actions": [
        {"bend": {"joint": "elbow", "axis": "z", "angle": 30, "over": 0.2, "hold": 0.1}},
        {"settle": {"for": 0.1}}]}"#;
    let scene = Scene {
        garment: Garment::from_asset(&asset).unwrap().0,
        fabric: Fabric::preset("cotton-jersey").unwrap(),
        script: WearScript::parse("wear.json", script).unwrap(),
        options: BakeOptions {
            body: Some(std::sync::Arc::new(read_body(&asset, &arm).unwrap())),
            checkpoint_steps: 8,
            ..BakeOptions::default()
        },
    };
    let mut keeper = Keeper::new(u64::MAX);
    let plain = scene.bake(&mut keeper).unwrap();
    let between: Vec<&Checkpoint> =
        keeper.checkpoints.iter().filter(|c| !c.position.is_before_action()).collect();
    assert!(between.len() >= 3, "{} checkpoints lie within actions", between.len());
    for checkpoint in
        [between[0], between[between.len() / 2], &keeper.checkpoints[keeper.checkpoints.len() - 2]]
    {
        let what = format!("from action {}, {:.2} s", checkpoint.position.action, checkpoint.state.time);
        let resumed = scene.resume(checkpoint, &mut ()).unwrap();
        assert_same(&plain, &resumed, &what);
    }
    let mut other = between[0].clone();
    other.body = None;
    let refused = scene.resume(&other, &mut ()).unwrap_err().to_string();
    assert!(refused.contains("does not fit"), "{refused}");
}

/// The places of the points in a roll go on.
#[test]
fn a_roll_goes_on_as_if_nothing_had_been() {
    let script = r#"{"format": "crease-wear/1", "actions": [
        {"lay": {"facing": "front", "over": 0.2}},
        {"roll": {"from": "left", "radius": 0.02, "over": 0.5, "hold": 0.1}},
        {"unfold": {"over": 0.5}}]}"#;
    let scene = Scene {
        script: WearScript::parse("wear.json", script).unwrap(),
        ..Scene::new(Method::BackwardEuler)
    };
    let mut keeper = Keeper::new(u64::MAX);
    let plain = scene.bake(&mut keeper).unwrap();
    assert!(plain.report.not_performed.is_none());
    let rolled = |c: &&Checkpoint| c.position.action > 0 && !c.position.is_before_action();
    let between: Vec<&Checkpoint> = keeper.checkpoints.iter().filter(rolled).collect();
    for checkpoint in [between[0], between[between.len() / 2], between[between.len() - 1]] {
        let what = format!("from action {}, {:.2} s", checkpoint.position.action, checkpoint.state.time);
        assert_same(&plain, &scene.resume(checkpoint, &mut ()).unwrap(), &what);
    }
}

#[test]
fn interrupted_again_and_again_it_still_ends_the_same() {
    let scene = Scene::new(Method::Bdf2);
    let plain = scene.bake(&mut ()).unwrap();
    let mut latest: Option<Checkpoint> = None;
    for turn in 0.. {
        assert!(turn < 100, "it gets on");
        let mut keeper = Keeper::new(23 + turn);
        let outcome = match &latest {
            Some(checkpoint) => scene.resume(checkpoint, &mut keeper),
            None => scene.bake(&mut keeper),
        };
        latest = keeper.checkpoints.pop().or(latest);
        match outcome {
            Ok(baked) => {
                assert!(turn > 2, "it was interrupted: {turn}");
                return assert_same(&plain, &baked, "at last");
            }
            Err(error) => assert!(matches!(error, Error::Interrupted), "{error}"),
        }
    }
}

#[test]
fn a_checkpoint_of_another_run_or_a_damaged_one_is_refused() {
    let scene = Scene::new(Method::Bdf2);
    let mut keeper = Keeper::new(60);
    scene.bake(&mut keeper).unwrap_err();
    let good = keeper.checkpoints.pop().unwrap();
    let refusal = |scene: &Scene, from: &Checkpoint| scene.resume(from, &mut ()).unwrap_err().to_string();

    let other = Scene { fabric: Fabric::preset("linen").unwrap(), ..Scene::new(Method::Bdf2) };
    assert!(refusal(&other, &good).contains("is of another run"));
    assert!(refusal(&Scene::new(Method::BackwardEuler), &good).contains("is of another run"));

    let bytes = good.to_bytes();
    for at in (0..bytes.len()).step_by(997).chain([bytes.len() - 2]) {
        assert!(Checkpoint::parse("x", &bytes[..at]).is_err(), "cut at {at}");
        let mut flipped = bytes.clone();
        flipped[at] ^= 1;
        // A flip that leaves the first line readable is found by the hash of the second, and the other way round.
        if let Ok(read) = Checkpoint::parse("x", &flipped) {
            assert_eq!(read, good, "flipped at {at}");
        }
    }
    let short = |change: &dyn Fn(&mut Checkpoint)| {
        let mut bad = good.clone();
        change(&mut bad);
        refusal(&scene, &bad)
    };
    assert!(short(&|c| assert!(c.state.x.pop().is_some())).contains("does not fit"));
    assert!(short(&|c| assert!(c.state.angle.pop().is_some())).contains("does not fit"));
    assert!(short(&|c| assert!(c.memory.rest.rest_angle.pop().is_some())).contains("does not fit"));
    assert!(short(&|c| c.position.action = 1000).contains("does not fit"));
    assert!(short(&|c| c.state.time = -1.0).contains("does not fit"));
}

/// The tool: killed in the middle or asked to stop, then `--resume`.
#[cfg(unix)]
mod process {
    use super::tool::signal;
    use super::{SCRIPT, sheet};
    use std::path::Path;
    use std::process::{Child, Command, Stdio};
    use std::time::Duration;

    fn bake(folder: &Path, out: &str, resume: bool) -> Child {
        let path = |name: &str| folder.join(name).display().to_string();
        let mut command = Command::new(env!("CARGO_BIN_EXE_crease"));
        command.args(["bake", &path("sheet.obj"), "--wear", &path("wear.json"), "-o", &path(out)]);
        command
            .args(["--quiet", "--no-grading", "--checkpoint-every", "0"])
            .args(resume.then_some("--resume"));
        command.stderr(Stdio::null()).spawn().unwrap()
    }

    #[test]
    fn a_killed_run_ends_with_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("sheet.obj"), sheet(9)).unwrap();
        std::fs::write(folder.path().join("wear.json"), SCRIPT).unwrap();
        for name in ["plain", "killed"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
        }
        assert!(bake(folder.path(), "plain/out.glb", false).wait().unwrap().success());
        let checkpoint = folder.path().join("killed/out.checkpoint");
        let mut codes = Vec::new();
        for (turn, name) in ["-KILL", "-TERM", "-KILL", "-INT", "-KILL"].into_iter().enumerate() {
            let before = std::fs::read(&checkpoint).ok();
            let mut child = bake(folder.path(), "killed/out.glb", true);
            // It gets on by a checkpoint or two, then it is hit wherever it is.
            while std::fs::read(&checkpoint).ok() == before && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(2));
            }
            std::thread::sleep(Duration::from_millis(7 * turn as u64));
            signal(&child, name);
            codes.push(child.wait().unwrap().code());
            assert!(!folder.path().join("killed/out.glb").exists(), "no result of half a run");
        }
        // Who is asked says so; who is killed cannot.
        assert!(codes.contains(&Some(130)) && codes.contains(&None), "{codes:?}");
        assert!(bake(folder.path(), "killed/out.glb", true).wait().unwrap().success());
        assert!(!checkpoint.exists(), "nothing is left over");
        let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
        for name in ["out.glb", "out.crease.json"] {
            assert!(bytes(&format!("plain/{name}")) == bytes(&format!("killed/{name}")), "{name} differs");
        }
    }
}
