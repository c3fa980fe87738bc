//! `crease chart stability`: where methods fail.
//!
//! Five maps, each step length against what makes a scene hard: stretch stiffness, contrast of bending stiffness (what
//! memory makes), thin elements, layers, speed of approach. Every method runs every cell; against a reference of the
//! two-stage method with a quarter of the shortest step an outcome is
//!
//! ```text
//! converged    within 5 % of the scene's size, strain within its bound, Newton at peace
//! inaccurate   farther off, or drawn out beyond what the scene itself does, or a fifth of the steps ran out of
//!              iterations: looks like cloth, is not this cloth
//! failed       crosses, is no number, or drawn out beyond what any cloth bears
//! ```
//!
//! The last column is what a bake does unless told otherwise: the standard quality with its own control of steps. docs/validation/accuracy.md lists 21 failures of
//! physics and numerics with the tests that stand for them.

use crate::chart::scenes;
use crate::chart::scenes::{Flight, Outcome, Scene, Setting, Stack, Swing};
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::bake::Quality;
use crate::error::Result;
use crate::sim::Method;

/// How a cell came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As the reference.
    Converged,
    /// Cloth, but not this cloth.
    Inaccurate,
    /// No cloth.
    Failed,
}

impl Verdict {
    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Inaccurate => "inaccurate",
            Self::Failed => "failed",
        }
    }
}

/// One map: what makes it hard, by how much, and with which steps.
pub struct Map {
    /// Scene in tables.
    pub name: &'static str,
    /// What the values are, with their unit.
    pub parameter: &'static str,
    /// From easy to hard.
    pub values: &'static [f64],
    /// Steps [s], short to long.
    pub steps: &'static [f64],
    /// The scene for a value.
    pub scene: fn(f64) -> Box<dyn Scene>,
    /// Strain beyond which the cloth is not this cloth, for a value.
    pub strain: fn(f64) -> f64,
    /// Share of the size within which a position is right; infinite where an impact scatters all of them.
    pub right: f64,
    /// Speed that no point can have, for a value [m/s].
    pub fastest: fn(f64) -> f64,
}

/// Share of the size within which a position is right, where nothing collides.
const RIGHT: f64 = 0.05;
/// More steps than this share must not run out of iterations.
const MOST_UNCONVERGED: f64 = 0.2;
/// Tolerance of Newton over the size of a scene.
const TOLERANCE: f64 = 1e-5;
const STEPS: &[f64] = &[1.0 / 240.0, 1.0 / 60.0, 1.0 / 24.0];

fn unbounded(_: f64) -> f64 {
    f64::INFINITY
}

fn stiff(stretch: f64) -> Swing {
    Swing { stretch, ..Swing::RELEASE_90 }
}

/// All maps.
pub const MAPS: &[Map] = &[
    Map {
        name: "release90",
        parameter: "stretch stiffness [N/m]",
        values: &[2e2, 2e3, 2e4, 2e5],
        steps: STEPS,
        scene: |value| loose(stiff(value)),
        strain: |value| stiff(value).honest_strain(),
        right: RIGHT,
        fastest: unbounded,
    },
    Map {
        name: "contrast",
        parameter: "bending stiffness ratio of every other hinge",
        values: &[1.0, 30.0, 1e3, 1e5],
        steps: STEPS,
        scene: |contrast| loose(Swing { contrast, name: "contrast", ..Swing::SWING_30 }),
        strain: unbounded,
        right: RIGHT,
        fastest: unbounded,
    },
    Map {
        name: "sliver",
        parameter: "altitude of the thinnest triangle over the others'",
        values: &[1e-1, 1e-2, 1e-3, 1e-5],
        steps: STEPS,
        scene: |sliver| loose(Swing { sliver, name: "sliver", ..Swing::SWING_30 }),
        strain: unbounded,
        right: RIGHT,
        fastest: unbounded,
    },
    Map {
        name: "layers",
        parameter: "sheets on one another",
        values: &[2.0, 5.0],
        steps: STEPS,
        scene: |layers| Box::new(Stack { layers: layers as usize }),
        strain: unbounded,
        right: RIGHT,
        fastest: unbounded,
    },
    Map {
        name: "approach",
        parameter: "speed of approach [m/s]",
        values: &[1.0, 5.0, 20.0],
        steps: STEPS,
        scene: |speed| Box::new(Flight { speed }),
        strain: |_| 0.3,
        right: f64::INFINITY,
        fastest: |speed| 1.5 * speed,
    },
];

/// `swing`, failed only where cloth would tear [-]: what is drawn out less is inaccurate.
fn loose(swing: Swing) -> Box<dyn Scene> {
    Box::new(Swing { bears: Some(0.3), ..swing })
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// How it came out.
    pub verdict: Verdict,
    /// Largest error of a position over the size [-].
    pub error: f64,
    /// Largest strain [-].
    pub strain: f64,
    /// Linear solves.
    pub linear_solves: u64,
    /// Why it failed or did not converge, if it did.
    pub why: Option<&'static str>,
}

impl Map {
    /// What the cells of `value` are compared with.
    pub fn reference(&self, value: f64) -> Result<Outcome> {
        let scene = (self.scene)(value);
        let step = 0.25 * self.steps.iter().copied().fold(f64::INFINITY, f64::min);
        scenes::run(
            scene.as_ref(),
            &Setting::fixed(Method::Sdirk2, step, 1e-3 * TOLERANCE * scene.size()),
        )
    }

    /// Runs one cell.
    pub fn cell(&self, value: f64, column: Column, step: f64, reference: &Outcome) -> Result<Cell> {
        let scene = (self.scene)(value);
        let fixed = |method| Setting::fixed(method, step, TOLERANCE * scene.size());
        let setting = match column {
            Column::Method(method) => fixed(method),
            Column::Default => {
                let method = Quality::Standard.step_options().method;
                Setting { quality: Some(Quality::Standard), ..fixed(method) }
            }
        };
        let outcome = scenes::run(scene.as_ref(), &setting)?;
        let error = outcome.position_error(reference, scene.size());
        let off = error > self.right || !error.is_finite();
        let drawn_out = outcome.largest_strain > (self.strain)(value);
        let restless = outcome.unconverged > MOST_UNCONVERGED;
        let verdict = if outcome.failed.is_some() {
            Verdict::Failed
        } else if off || drawn_out || restless || outcome.fastest > (self.fastest)(value) {
            Verdict::Inaccurate
        } else {
            Verdict::Converged
        };
        let (strain, linear_solves) = (outcome.largest_strain, outcome.linear_solves);
        let why = outcome.failed.or(restless.then_some("does not converge"));
        Ok(Cell { verdict, error, strain, linear_solves, why })
    }
}

/// What a column of cells is made by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// A method with steps of one length.
    Method(Method),
    /// What a bake does unless told otherwise: its method, with its own control of steps that are `step` at most.
    Default,
}

impl Column {
    /// Every method, and the default.
    pub fn every() -> impl Iterator<Item = Self> {
        Method::ALL.iter().map(|m| Self::Method(*m)).chain([Self::Default])
    }

    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Method(method) => method.name(),
            Self::Default => "default",
        }
    }
}

pub(super) fn make(_options: &ChartOptions) -> Result<Chart> {
    let mut table = Table::new(&[
        "scene",
        "method",
        "step_s",
        "parameter",
        "value",
        "outcome",
        "error_position",
        "largest_strain",
        "linear_solves",
        "why",
    ]);
    let (mut panels, mut notes) = (Vec::new(), Vec::new());
    for map in MAPS {
        let mut places: [Vec<[f64; 2]>; 3] = Default::default();
        let mut counts = vec![[0usize; 3]; Column::every().count()];
        for (row, &value) in map.values.iter().enumerate() {
            let reference = map.reference(value)?;
            for (column, method) in Column::every().enumerate() {
                for (k, &step) in map.steps.iter().enumerate() {
                    let cell = map.cell(value, method, step, &reference)?;
                    let aside = 0.24 * (k as f64 - 0.5 * (map.steps.len() as f64 - 1.0));
                    places[cell.verdict as usize].push([column as f64 + aside, row as f64]);
                    counts[column][cell.verdict as usize] += 1;
                    table.push([
                        map.name.into(),
                        method.name().into(),
                        step.into(),
                        map.parameter.into(),
                        value.into(),
                        cell.verdict.name().into(),
                        cell.error.into(),
                        cell.strain.into(),
                        cell.linear_solves.into(),
                        cell.why.into(),
                    ]);
                }
            }
        }
        let words = Column::every().zip(&counts);
        let words: Vec<String> = words.map(|(m, [a, b, c])| format!("{} {a}/{b}/{c}", m.name())).collect();
        notes.push(format!("{}: converged/inaccurate/failed: {}", map.name, words.join(", ")));
        panels.push(picture(map, places));
    }
    let ms: Vec<String> = STEPS.iter().map(|s| format!("{:.1}", 1e3 * s)).collect();
    notes.push(format!("each method's columns, from the left: steps of {} ms", ms.join(", ")));
    let title = format!("Where methods fail: steps of {} ms from the left in each column", ms.join(", "));
    Ok(Chart { name: "stability", table, figure: Figure { title, panels }, notes })
}

/// Methods to the right, values upwards, a mark for every step.
fn picture(map: &Map, places: [Vec<[f64; 2]>; 3]) -> Panel {
    let short = |v: &f64| if (1e-2..1e4).contains(v) { format!("{v}") } else { format!("{v:.0e}") };
    let names = |names: Vec<String>| {
        let room = [-0.6, names.len() as f64 - 0.4];
        Axis { names, range: Some(room), ..Axis::default() }
    };
    let methods = Column::every().map(|m| m.name().replace("backward-euler", "be")).collect();
    let [good, middling, bad] = places;
    Panel {
        title: map.name.to_owned(),
        x: Axis { label: "method (be: backward-euler)".into(), ..names(methods) },
        y: Axis { label: map.parameter.into(), ..names(map.values.iter().map(short).collect()) },
        series: vec![
            Series::new("converged", 2, Mark::Dots, good),
            Series::new("inaccurate", 5, Mark::Rings, middling),
            Series::new("failed", 1, Mark::Crosses, bad),
        ],
    }
}
