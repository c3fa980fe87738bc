//! `crease chart robustness`: outcomes of whole bakes where they get difficult.
//!
//! A sheet is laid, folded twice, pressed and unfolded; a sleeve is bent by an arm. Each map changes one parameter from easy to
//! difficult: shape and noise of the file's triangles, size, fabric, shortest step, speed, pressure, layers. The columns are the
//! standard and the draft quality, with `--full` also the reference and the other integrators at standard quality. An outcome is
//!
//! ```text
//! sound    nothing to say
//! warned   the report warns: overstretched cloth, steps or a relaxation that did not converge
//! failed   a message instead of a result, an action that did not take place, an early end, or layers that cross in the result
//! ```

use crate::comparison::METHODS;
use crate::included_mesh::sleeve_on_arm;
use crate::stability::{named_axis, outcome_panel};
use crate::{Axis, Chart, ChartOptions, Figure, Panel, Table, TestSheet};
use crease::internal::bake::{Bake, BakeOptions, BakeReport, Quality};
use crease::internal::wear::WearScript;
use crease_geometry::math::{Rng, Vec2, Vec3};
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::body::AnimatedBody;
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::Garment;
use crease_solver::sim::{Method, StepOptions};
use std::sync::Arc;
use std::time::Instant;

/// Side of the sheet [m].
const SIDE: f64 = 0.4;
/// Side of the sheet that is folded up to five times [m]: 32 layers of jersey are 21 mm high and 100 mm wide.
const LAYERED_SIDE: f64 = 0.8;
/// Edge of the sheet's triangles [m].
const EDGE: f64 = 0.012;
/// A felt thicker than any preset.
const THICK_FELT: &str = r#"{"format": "crease-fabric/1", "name": "thick-felt", "based_on": "wool-winter-flannel",
    "description": "felt of 3 mm", "area_density_g_m2": 600, "thickness_mm": 3.0, "bend_warp_un_m": 400, "bend_weft_un_m": 400}"#;

/// Outcome of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// Nothing to say.
    Sound,
    /// The report warns.
    Warned,
    /// No result, or one that is not what the script says.
    Failed,
}

impl Outcome {
    /// All outcomes, from good to bad.
    const ALL: [Self; 3] = [Self::Sound, Self::Warned, Self::Failed];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::Warned => "warned",
            Self::Failed => "failed",
        }
    }
}

/// What is baked.
struct BakeScene {
    garment: Garment,
    fabric: Fabric,
    script: WearScript,
    body: Option<Arc<AnimatedBody>>,
    /// Shortest step instead of the quality's [s].
    min_dt: Option<f64>,
}

/// A map: bakes with one parameter changed.
pub struct RobustnessMap {
    /// Name in tables.
    pub name: &'static str,
    /// Quantity of the values, with its unit.
    pub parameter: &'static str,
    /// Values from easy to difficult.
    pub values: &'static [f64],
    scene: fn(f64) -> Result<BakeScene>,
}

/// All maps.
pub const MAPS: &[RobustnessMap] = &[
    RobustnessMap {
        name: "needles",
        parameter: "length over height of triangles",
        values: &[1.0, 4.0, 16.0, 64.0],
        scene: |ratio| {
            let [along, across] = [EDGE * ratio.sqrt(), EDGE / ratio.sqrt()];
            Ok(BakeScene { garment: grid(SIDE, along, across).flat_garment(), ..BakeScene::folded_twice()? })
        },
    },
    RobustnessMap {
        name: "noise",
        parameter: "displacement over edge of the file",
        values: &[0.02, 0.1, 0.3, 0.6],
        scene: |fraction| {
            let mut scene = BakeScene::folded_twice()?;
            let mut rng = Rng::from_seed(1);
            scene.garment.points.iter_mut().for_each(|x| *x += rng.in_cube() * (fraction * EDGE));
            Ok(scene)
        },
    },
    RobustnessMap {
        name: "size",
        parameter: "side of the sheet [m]",
        values: &[0.06, 0.2, 0.7, 2.0],
        scene: |side| {
            let edge = EDGE * side / SIDE;
            Ok(BakeScene { garment: grid(side, edge, edge).flat_garment(), ..BakeScene::folded_twice()? })
        },
    },
    RobustnessMap {
        name: "fabric",
        parameter: "thickness, taffeta to felt [mm]",
        values: &[0.12, 0.173, 0.652, 1.02, 3.0],
        scene: |thickness| {
            let fabric = match thickness {
                0.12 => Fabric::preset("polyester-taffeta")?,
                0.173 => Fabric::preset("silk-habotai")?,
                0.652 => Fabric::preset("cotton-jersey")?,
                1.02 => Fabric::preset("wool-winter-flannel")?,
                _ => Fabric::parse("thick-felt.json", THICK_FELT)?,
            };
            Ok(BakeScene { fabric, ..BakeScene::folded_twice()? })
        },
    },
    RobustnessMap {
        name: "step",
        parameter: "shortest step [ms]",
        values: &[4.0, 33.0, 100.0, 300.0],
        scene: |ms| {
            let min_dt = Some(1e-3 * ms);
            Ok(BakeScene { min_dt, ..BakeScene::folded_twice()? })
        },
    },
    RobustnessMap {
        name: "fold",
        parameter: "fold by 180 degrees within [s]",
        values: &[4.0, 1.0, 0.3, 0.1],
        scene: |over| Ok(BakeScene { script: folds(2, over, 200.0)?, ..BakeScene::folded_twice()? }),
    },
    RobustnessMap {
        name: "press",
        parameter: "pressure [Pa]",
        values: &[20.0, 200.0, 2e3, 2e4],
        scene: |pressure| Ok(BakeScene { script: folds(2, 2.0, pressure)?, ..BakeScene::folded_twice()? }),
    },
    RobustnessMap {
        name: "layers",
        parameter: "layers on one another",
        values: &[2.0, 4.0, 8.0, 16.0, 32.0],
        scene: |layers| {
            let garment = grid(LAYERED_SIDE, EDGE, EDGE).flat_garment();
            let script = folds(layers.log2().round() as usize, 2.0, 200.0)?;
            Ok(BakeScene { garment, script, ..BakeScene::folded_twice()? })
        },
    },
    RobustnessMap {
        name: "bend",
        parameter: "bend by 95 degrees within [s]",
        values: &[2.0, 1.0, 0.3, 0.1],
        scene: BakeScene::bent,
    },
];

impl BakeScene {
    /// The sheet, folded in half and once more, in the default fabric.
    fn folded_twice() -> Result<Self> {
        Ok(Self {
            garment: grid(SIDE, EDGE, EDGE).flat_garment(),
            fabric: Fabric::preset(DEFAULT_FABRIC)?,
            script: folds(2, 2.0, 200.0)?,
            body: None,
            min_dt: None,
        })
    }

    /// The sleeve on an arm that bends and straightens within `over` [s] each.
    fn bent(over: f64) -> Result<Self> {
        let (garment, body) = sleeve_on_arm()?;
        let script = format!(
            r#"{{"format": "crease-wear/1", "actions": [
                {{"bend": {{"joint": "elbow", "axis": "z", "angle": 95, "over": {over}, "hold": 0.5}}}}]}}"#
        );
        Ok(Self {
            garment,
            fabric: Fabric::preset(DEFAULT_FABRIC)?,
            script: WearScript::parse("bend.json", &script)?,
            body: Some(body),
            min_dt: None,
        })
    }

    /// Bakes with the options of a column.
    fn run(&self, column: Column) -> RobustnessCell {
        let mut options = column.options();
        if let Some(min_dt) = self.min_dt {
            options.step = Some(StepOptions { min_dt, ..options.step() });
        }
        let mut bake = Bake::new(&self.garment, &self.fabric, &self.script).options(options);
        if let Some(body) = &self.body {
            bake = bake.body(body.clone());
        }
        let clock = Instant::now();
        let result = bake.run();
        let wall = clock.elapsed().as_secs_f64();
        let cell = |outcome, report: Option<BakeReport>, why| RobustnessCell { outcome, wall, report, why };
        let baked = match result {
            Ok(baked) => baked,
            Err(error) => return cell(Outcome::Failed, None, error.to_string()),
        };
        let crossing = |x: &[Vec3]| self_intersections(x, &self.garment.triangles).len();
        let worn: Vec<Vec3> =
            self.garment.points.iter().zip(&baked.worn.displacement).map(|(x, d)| x + d).collect();
        let (before, after) = (crossing(&self.garment.points), crossing(&worn));
        let report = baked.report;
        let failure = match (&report.not_performed, &report.stopped) {
            (Some(diagnostic), _) => Some(diagnostic.to_string()),
            (_, Some(stop)) => Some(stop.cause.reason.to_string()),
            _ if after > before => Some(format!("{after} crossings in the result, {before} in the garment")),
            _ => None,
        };
        let doubt = report
            .unconverged_reason
            .clone()
            .or_else(|| report.warnings.first().map(ToString::to_string))
            .unwrap_or_default();
        match failure {
            Some(why) => cell(Outcome::Failed, Some(report), why),
            None if doubt.is_empty() => cell(Outcome::Sound, Some(report), doubt),
            None => cell(Outcome::Warned, Some(report), doubt),
        }
    }
}

/// Outcome and cost of one bake.
#[derive(Debug, Clone)]
pub struct RobustnessCell {
    /// Outcome.
    pub outcome: Outcome,
    /// Wall time [s].
    pub wall: f64,
    /// Report, if there is a result.
    pub report: Option<BakeReport>,
    /// Reason of a failure, or the first warning.
    pub why: String,
}

/// Column of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Column {
    /// A quality of a bake.
    Quality(Quality),
    /// An integrator at standard quality.
    Method(Method),
}

impl Column {
    /// Standard and draft; if `full` also reference and the integrators that are not the default.
    fn all(full: bool) -> Vec<Self> {
        let default = Quality::Standard.step_options().method;
        let others = METHODS.iter().filter(|method| **method != default).map(|method| Self::Method(*method));
        let slow = [Self::Quality(Quality::Reference)].into_iter().chain(others);
        let fast = [Quality::Standard, Quality::Draft].map(Self::Quality);
        fast.into_iter().chain(slow.filter(|_| full)).collect()
    }

    fn options(self) -> BakeOptions {
        match self {
            Self::Quality(quality) => BakeOptions::of_quality(quality),
            Self::Method(method) => {
                let mut options = BakeOptions::default();
                options.step = Some(StepOptions { method, ..options.step() });
                options
            }
        }
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quality(quality) => quality.name(),
            Self::Method(method) => method.name(),
        }
    }
}

impl RobustnessMap {
    /// Bakes one cell.
    ///
    /// # Errors
    /// If the scene cannot be set up.
    pub fn cell(&self, value: f64, column: Column) -> Result<RobustnessCell> {
        (self.scene)(value).map(|scene| scene.run(column))
    }
}

/// A square sheet of `side` [m] with cells of `along` x `across` [m], about.
fn grid(side: f64, along: f64, across: f64) -> TestSheet {
    let lines = (side / along).round().max(1.0) as usize;
    let along: Vec<f64> = (0..=lines).map(|k| side * (k as f64 / lines as f64)).collect();
    let sheet = TestSheet::strip(&along, side, (side / across).round().max(1.0) as usize);
    let flat = sheet.flat.iter().map(|p| p + Vec2::new(0.0, 0.5 * side)).collect();
    TestSheet { flat, ..sheet }
}

/// A script that folds the sheet in half `count` times, alternately across and along, each within `over` [s], presses it with
/// `pressure` [Pa] for 5 s, from the third fold on also after each, and unfolds it.
fn folds(count: usize, over: f64, pressure: f64) -> Result<WearScript> {
    // Where the remaining part of the sheet is cut in half, per direction.
    let mut remaining = [1.0, 1.0];
    let folds: Vec<String> = (0..count)
        .map(|k| {
            let at = 1.0 - 0.5 * remaining[k % 2];
            remaining[k % 2] *= 0.5;
            let (line, side) = match k % 2 {
                0 => (format!("[[{at}, 0.0], [{at}, 1.0]]"), "left"),
                _ => (format!("[[0.0, {at}], [1.0, {at}]]"), "lower"),
            };
            // Hands press a thick stack before they fold it once more.
            let pressed = match k {
                2.. => format!(r#"{{"press": {{"pressure": {pressure}, "for": 2}}}},"#),
                _ => String::new(),
            };
            format!(
                r#"{{"fold": {{"line": {line}, "side": "{side}", "over": {over}, "hold": 1.0}}}},{pressed}"#
            )
        })
        .collect();
    let text = format!(
        r#"{{"format": "crease-wear/1", "actions": [{{"lay": {{}}}}, {}
            {{"press": {{"pressure": {pressure}, "for": 5}}}},
            {{"unfold": {{"all": true, "over": {over}}}}}, {{"settle": {{"for": 1.0}}}}]}}"#,
        folds.concat()
    );
    WearScript::parse("folds.json", &text)
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let mut table = Table::new(&[
        "scene",
        "setting",
        "parameter",
        "value",
        "outcome",
        "wall_s",
        "steps",
        "linear_solves",
        "why",
    ]);
    let columns = Column::all(options.full);
    let (mut panels, mut notes) = (Vec::new(), Vec::new());
    for map in MAPS {
        let mut positions: [Vec<[f64; 2]>; 3] = Default::default();
        let mut counts = vec![[0usize; 3]; columns.len()];
        for (row, &value) in map.values.iter().enumerate() {
            let scene = (map.scene)(value)?;
            for (k, column) in columns.iter().enumerate() {
                let cell = scene.run(*column);
                positions[cell.outcome as usize].push([k as f64, row as f64]);
                counts[k][cell.outcome as usize] += 1;
                let report = cell.report.as_ref();
                table.push([
                    map.name.into(),
                    column.name().into(),
                    map.parameter.into(),
                    value.into(),
                    cell.outcome.name().into(),
                    cell.wall.into(),
                    report.map(|r| r.steps).into(),
                    report.map(|r| r.solves + r.local_solves).into(),
                    Some(cell.why.as_str()).filter(|why| !why.is_empty()).into(),
                ]);
            }
        }
        let counted: Vec<String> =
            columns.iter().zip(&counts).map(|(c, [a, b, d])| format!("{} {a}/{b}/{d}", c.name())).collect();
        notes.push(format!("{}: sound/warned/failed: {}", map.name, counted.join(", ")));
        panels.push(panel_of(map, &columns, positions));
    }
    let title = "Outcome of whole bakes where they get difficult".to_owned();
    Ok(Chart { name: "robustness", table, figure: Figure { title, panels }, notes })
}

/// Panel of a map: settings to the right, values upwards.
fn panel_of(map: &RobustnessMap, columns: &[Column], positions: [Vec<[f64; 2]>; 3]) -> Panel {
    let settings = columns.iter().map(|c| c.name().to_owned()).collect();
    let x = Axis { label: "quality or method".into(), ..named_axis(settings) };
    outcome_panel(map.name, x, map.parameter, map.values, Outcome::ALL.map(Outcome::name), positions)
}
