//! `crease chart stability`: failures of every integrator.
//!
//! Five maps, each of step size against a parameter that makes a scene difficult: stretch stiffness, contrast of
//! bending stiffness (as memory causes it), thin elements, layers, speed of approach. Every integrator runs every
//! cell; compared with a reference of the two-stage method with a quarter of the shortest step an outcome is
//!
//! ```text
//! converged    position error below 5 % of the size, strain within its bound, at most a fifth of the steps unconverged
//! inaccurate   a larger error, a strain beyond that of the motion itself, or more unconverged steps
//! failed       intersections, not a number, or a strain beyond that of any cloth
//! ```
//!
//! The last column is the default of a bake: the standard quality with its step control.
//! `docs/validation/accuracy.md` lists failures of physics and numerics with their tests.

use crate::comparison::METHODS;
use crate::scenes::{Flight, Scene, SceneOutcome, SceneSetting, Stack, Swing};
use crate::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table, scenes};
use crease::internal::bake::Quality;
use crease_model::error::Result;
use crease_solver::sim::Method;

/// Verdict on a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Agreement with the reference.
    Converged,
    /// A state of cloth that differs from the reference.
    Inaccurate,
    /// Not a state of cloth.
    Failed,
}

impl Verdict {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Inaccurate => "inaccurate",
            Self::Failed => "failed",
        }
    }
}

/// A map: a scene with a parameter, its values, and step sizes.
pub struct StabilityMap {
    /// Name in tables.
    pub name: &'static str,
    /// Quantity of the values, with its unit.
    pub parameter: &'static str,
    /// Values from easy to difficult.
    pub values: &'static [f64],
    /// Step sizes, ascending [s].
    pub steps: &'static [f64],
    /// Makes the scene for a value.
    pub scene: fn(f64) -> Box<dyn Scene>,
    /// Strain beyond which an outcome is inaccurate, for a value [-].
    pub max_strain: fn(f64) -> f64,
    /// Position error over the size up to which an outcome has converged [-]; infinite where an impact scatters all
    /// positions.
    pub max_error: f64,
    /// Speed beyond which an outcome is inaccurate, for a value [m/s].
    pub max_speed: fn(f64) -> f64,
}

/// Position error over the size up to which an outcome has converged [-].
const MAX_POSITION_ERROR: f64 = 0.05;
/// Fraction of unconverged steps up to which an outcome has converged [-].
const MAX_UNCONVERGED_FRACTION: f64 = 0.2;
/// Displacement tolerance of Newton over the size of a scene [-].
const NEWTON_TOL: f64 = 1e-5;
/// Strain that tears cloth [-].
const TEARING_STRAIN: f64 = 0.3;
/// Largest speed after an impact over that of the approach [-].
const MAX_REBOUND_FACTOR: f64 = 1.5;
/// Step sizes of all maps [s].
const STEPS: &[f64] = &[1.0 / 240.0, 1.0 / 60.0, 1.0 / 24.0];

fn unbounded(_: f64) -> f64 {
    f64::INFINITY
}

fn stiff(stretch: f64) -> Swing {
    Swing { stretch, ..Swing::RELEASE_90 }
}

/// All maps.
pub const MAPS: &[StabilityMap] = &[
    StabilityMap {
        name: "release90",
        parameter: "stretch stiffness [N/m]",
        values: &[2e2, 2e3, 2e4, 2e5],
        steps: STEPS,
        scene: |value| until_tearing(stiff(value)),
        max_strain: |value| stiff(value).physical_strain(),
        max_error: MAX_POSITION_ERROR,
        max_speed: unbounded,
    },
    StabilityMap {
        name: "contrast",
        parameter: "stiffness ratio of every other hinge",
        values: &[1.0, 30.0, 1e3, 1e5],
        steps: STEPS,
        scene: |contrast| until_tearing(Swing { contrast, name: "contrast", ..Swing::SWING_30 }),
        max_strain: unbounded,
        max_error: MAX_POSITION_ERROR,
        max_speed: unbounded,
    },
    StabilityMap {
        name: "sliver",
        parameter: "thinnest altitude over the others'",
        values: &[1e-1, 1e-2, 1e-3, 1e-5],
        steps: STEPS,
        scene: |sliver| until_tearing(Swing { sliver, name: "sliver", ..Swing::SWING_30 }),
        max_strain: unbounded,
        max_error: MAX_POSITION_ERROR,
        max_speed: unbounded,
    },
    StabilityMap {
        name: "layers",
        parameter: "sheets on one another",
        values: &[2.0, 5.0],
        steps: STEPS,
        scene: |layers| Box::new(Stack { layers: layers as usize }),
        max_strain: unbounded,
        max_error: MAX_POSITION_ERROR,
        max_speed: unbounded,
    },
    StabilityMap {
        name: "approach",
        parameter: "speed of approach [m/s]",
        values: &[1.0, 5.0, 20.0],
        steps: STEPS,
        scene: |speed| Box::new(Flight { speed }),
        max_strain: |_| TEARING_STRAIN,
        max_error: f64::INFINITY,
        max_speed: |speed| MAX_REBOUND_FACTOR * speed,
    },
];

/// `swing`, which fails only beyond the tearing strain: smaller excessive strains are inaccurate.
fn until_tearing(swing: Swing) -> Box<dyn Scene> {
    Box::new(Swing { max_strain: Some(TEARING_STRAIN), ..swing })
}

/// Outcome of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityCell {
    /// Verdict.
    pub verdict: Verdict,
    /// Largest error of a position over the size [-].
    pub error: f64,
    /// Largest strain [-].
    pub max_strain: f64,
    /// Linear systems solved.
    pub linear_solves: u64,
    /// Reason of a failure or of missing convergence.
    pub why: Option<&'static str>,
}

impl StabilityMap {
    /// Makes the reference of the cells of `value`.
    ///
    /// # Errors
    /// If the scene cannot be set up.
    pub fn reference(&self, value: f64) -> Result<SceneOutcome> {
        let scene = (self.scene)(value);
        let step = 0.25 * self.steps.iter().copied().fold(f64::INFINITY, f64::min);
        scenes::run(
            scene.as_ref(),
            &SceneSetting::fixed(Method::Sdirk2, step, 1e-3 * NEWTON_TOL * scene.size()),
        )
    }

    /// Runs one cell.
    ///
    /// # Errors
    /// If the scene cannot be set up.
    pub fn cell(
        &self,
        value: f64,
        column: MethodColumn,
        step: f64,
        reference: &SceneOutcome,
    ) -> Result<StabilityCell> {
        let scene = (self.scene)(value);
        let fixed = |method| SceneSetting::fixed(method, step, NEWTON_TOL * scene.size());
        let setting = match column {
            MethodColumn::Method(method) => fixed(method),
            MethodColumn::Default => {
                let method = Quality::Standard.step_options().method;
                SceneSetting { quality: Some(Quality::Standard), ..fixed(method) }
            }
        };
        let outcome = scenes::run(scene.as_ref(), &setting)?;
        let error = outcome.position_error(reference, scene.size());
        let is_off = error > self.max_error || !error.is_finite();
        let is_overstretched = outcome.max_strain > (self.max_strain)(value);
        let is_unconverged = outcome.unconverged_fraction > MAX_UNCONVERGED_FRACTION;
        let is_too_fast = outcome.max_speed > (self.max_speed)(value);
        let verdict = if outcome.failed.is_some() {
            Verdict::Failed
        } else if is_off || is_overstretched || is_unconverged || is_too_fast {
            Verdict::Inaccurate
        } else {
            Verdict::Converged
        };
        let (max_strain, linear_solves) = (outcome.max_strain, outcome.linear_solves);
        let why = outcome.failed.or(is_unconverged.then_some("does not converge"));
        Ok(StabilityCell { verdict, error, max_strain, linear_solves, why })
    }
}

/// Column of cells: an integrator or the default of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MethodColumn {
    /// An integrator with fixed steps.
    Method(Method),
    /// The default of a bake: its integrator, with step control up to the step size of the cell.
    Default,
}

impl MethodColumn {
    /// Every integrator, and the default.
    pub fn all() -> impl Iterator<Item = Self> {
        METHODS.iter().map(|m| Self::Method(*m)).chain([Self::Default])
    }

    /// Name in tables.
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
        let mut positions: [Vec<[f64; 2]>; 3] = Default::default();
        let mut counts = vec![[0usize; 3]; MethodColumn::all().count()];
        for (row, &value) in map.values.iter().enumerate() {
            let reference = map.reference(value)?;
            for (column, method) in MethodColumn::all().enumerate() {
                for (k, &step) in map.steps.iter().enumerate() {
                    let cell = map.cell(value, method, step, &reference)?;
                    let offset = 0.24 * (k as f64 - 0.5 * (map.steps.len() as f64 - 1.0));
                    positions[cell.verdict as usize].push([column as f64 + offset, row as f64]);
                    counts[column][cell.verdict as usize] += 1;
                    table.push([
                        map.name.into(),
                        method.name().into(),
                        step.into(),
                        map.parameter.into(),
                        value.into(),
                        cell.verdict.name().into(),
                        cell.error.into(),
                        cell.max_strain.into(),
                        cell.linear_solves.into(),
                        cell.why.into(),
                    ]);
                }
            }
        }
        let counted = MethodColumn::all().zip(&counts);
        let counted: Vec<String> =
            counted.map(|(m, [a, b, c])| format!("{} {a}/{b}/{c}", m.name())).collect();
        notes.push(format!("{}: converged/inaccurate/failed: {}", map.name, counted.join(", ")));
        panels.push(panel_of(map, positions));
    }
    let ms: Vec<String> = STEPS.iter().map(|s| format!("{:.1}", 1e3 * s)).collect();
    notes.push(format!("marks of each method, from the left: steps of {} ms", ms.join(", ")));
    let title =
        format!("Stability of every integrator: steps of {} ms from the left in each column", ms.join(", "));
    Ok(Chart { name: "stability", table, figure: Figure { title, panels }, notes })
}

/// Panel of a map: integrators to the right, values upwards, a mark for every step size.
fn panel_of(map: &StabilityMap, positions: [Vec<[f64; 2]>; 3]) -> Panel {
    let methods = MethodColumn::all().map(|m| m.name().replace("backward-euler", "be")).collect();
    let names = [Verdict::Converged, Verdict::Inaccurate, Verdict::Failed].map(Verdict::name);
    let x = Axis { label: "method (be: backward-euler)".into(), ..named_axis(methods) };
    outcome_panel(map.name, x, map.parameter, map.values, names, positions)
}

/// Panel of outcomes from good to bad, named `names`: columns on the axis `x`, the values of a parameter upwards.
pub(super) fn outcome_panel(
    title: &str,
    x: Axis,
    parameter: &str,
    values: &[f64],
    names: [&str; 3],
    positions: [Vec<[f64; 2]>; 3],
) -> Panel {
    let short = |v: &f64| if (1e-2..1e4).contains(v) { format!("{v}") } else { format!("{v:.0e}") };
    let marks = [(2, Mark::Dots), (5, Mark::Rings), (1, Mark::Crosses)];
    let series = names.into_iter().zip(marks).zip(positions);
    Panel {
        title: title.to_owned(),
        x,
        y: Axis { label: parameter.into(), ..named_axis(values.iter().map(short).collect()) },
        series: series.map(|((name, (colour, mark)), at)| Series::new(name, colour, mark, at)).collect(),
    }
}

/// An axis with names at 0, 1, 2, ... and room on either side.
pub(super) fn named_axis(names: Vec<String>) -> Axis {
    let range = [-0.6, names.len() as f64 - 0.4];
    Axis { names, range: Some(range), ..Axis::default() }
}
