//! `crease chart accuracy`: what every method of the shelf costs for what error.
//!
//! ```text
//! scene x method x step x tolerance -> Outcome   against the scene's reference -> error, cost
//! ```
//!
//! The reference of a scene is made on the same mesh with the same energies by the two-stage method with an eighth of the
//! shortest step, Newton to 1e-10 m, and extrapolated from that and twice the step. Its own error is told in the notes. Failures stand in the picture as crosses at their cost.
//! `--full` adds the T-shirt that is folded thrice (`garment.rs`), which takes an hour.

mod garment;

pub(super) use garment::read_own;
pub use garment::{FoldThrice, Run, reference_options};

use crate::chart::scenes;
use crate::chart::scenes::{Cantilever, Flap, Outcome, Scene, Setting, Swing};
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::error::Result;
use crate::sim::{Method, InnerSolver};

/// One point of the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The integrator.
    pub method: Method,
    /// In words.
    pub setting: String,
    /// Step [s] and tolerance [m].
    pub knobs: [f64; 2],
    /// Wall time [s].
    pub wall: f64,
    /// Linear systems solved.
    pub linear_solves: u64,
    /// Largest error of a position over the size of the scene [-].
    pub position: f64,
    /// Root mean square error of the angles [rad].
    pub angle: f64,
    /// The same of the rest angles, where the cloth remembers [rad].
    pub rest_angle: Option<f64>,
    /// Largest strain on the way [-].
    pub strain: f64,
    /// Why it failed, if it did.
    pub failed: Option<&'static str>,
}

/// How far apart reference and scene are asked to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The extrapolated outcome.
    pub outcome: Outcome,
    /// Largest distance between it and the run with twice the step, over the size of the scene [-].
    pub own_error: f64,
}

/// The reference of a scene whose shortest plotted step is `step` [s].
pub fn reference(scene: &dyn Scene, step: f64) -> Result<Reference> {
    let make = |h: f64| scenes::run(scene, &Setting::fixed(Method::Sdirk2, h, 1e-10));
    let (fine, coarse) = (make(step / 8.0)?, make(2.0 * step / 8.0)?);
    let own_error = fine.position_error(&coarse, scene.size());
    let more = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + (a - b) / 3.0).collect();
    let x = fine.x.iter().zip(&coarse.x).map(|(a, b)| a + (a - b) / 3.0).collect();
    let angle = more(&fine.angle, &coarse.angle);
    // Events of memory come one by one: rest angles are not extrapolated.
    Ok(Reference { outcome: Outcome { x, angle, ..fine }, own_error: own_error / 3.0 })
}

/// Runs `scene` by one setting, `runs` times if it is quick, and compares.
pub fn point(scene: &dyn Scene, reference: &Outcome, setting: &Setting, runs: usize) -> Result<Point> {
    let outcome = scenes::run(scene, setting)?;
    let mut walls = vec![outcome.wall];
    let again = if outcome.wall < LONG { runs } else { 1 };
    for _ in 1..again {
        walls.push(scenes::run(scene, setting)?.wall);
    }
    walls.sort_by(f64::total_cmp);
    let remembers = reference.rest_angle.iter().any(|a| *a != 0.0);
    Ok(Point {
        method: setting.method,
        setting: words(setting),
        knobs: [setting.step, setting.tolerance],
        wall: walls[walls.len() / 2],
        linear_solves: outcome.linear_solves,
        position: outcome.position_error(reference, scene.size()),
        angle: outcome.angle_error(reference),
        rest_angle: remembers.then(|| outcome.rest_angle_error(reference)),
        strain: outcome.largest_strain,
        failed: outcome.failed,
    })
}

/// Runs longer than this are timed once [s].
const LONG: f64 = 0.5;

fn words(setting: &Setting) -> String {
    let step = format!("{:.3} ms", 1e3 * setting.step);
    match setting.method.solver() {
        InnerSolver::Newton => format!("{step}, to {:.0e} m", setting.tolerance),
        InnerSolver::SingleNewton => format!("{step}, 1 iteration"),
        InnerSolver::Vbd => format!("{step}, sweeps"),
    }
}

/// A scene and the steps it is run with.
struct Sweep {
    scene: Box<dyn Scene>,
    /// Longest step [s].
    longest: f64,
    /// How often it is halved.
    halvings: u32,
}

fn sweeps() -> Vec<Sweep> {
    vec![
        Sweep { scene: Box::new(Flap), longest: 1.0 / 10.0, halvings: 5 },
        Sweep { scene: Box::new(Swing::SWING_30), longest: 0.02, halvings: 5 },
        Sweep { scene: Box::new(Swing::RELEASE_90), longest: 0.02, halvings: 5 },
        Sweep { scene: Box::new(Cantilever), longest: 0.5, halvings: 6 },
    ]
}

/// Tolerances of Newton, over the size of the scene.
const TOLERANCES: &[f64] = &[1e-4, 1e-7];

/// All points of one sweep.
fn points(sweep: &Sweep, runs: usize, notes: &mut Vec<String>) -> Result<Vec<Point>> {
    let Sweep { scene, longest, halvings } = sweep;
    let (scene, longest, halvings) = (scene.as_ref(), *longest, *halvings);
    let shortest = longest / f64::from(1 << halvings);
    let Reference { outcome, own_error } = reference(scene, shortest)?;
    let mut all = Vec::new();
    for &method in Method::ALL {
        for k in 0..=halvings {
            let step = longest / f64::from(1 << k);
            let tolerances = if method.solver() == InnerSolver::Newton { TOLERANCES } else { &[0.0] };
            for tolerance in tolerances {
                let setting = Setting::fixed(method, step, tolerance * scene.size());
                all.push(point(scene, &outcome, &setting, runs)?);
            }
        }
    }
    let name = scene.name();
    let least = all.iter().filter(|p| p.failed.is_none()).map(|p| p.position).fold(f64::INFINITY, f64::min);
    notes.push(format!(
        "{name}: the reference is good to {own_error:.1e} of the size, the smallest error shown is {least:.1e}"
    ));
    notes.extend(at_equal_error(name, &all));
    Ok(all)
}

/// What the methods cost at equal error: the cheapest setting that is as good.
fn at_equal_error(scene: &str, points: &[Point]) -> Vec<String> {
    [1e-2, 3e-3, 1e-3]
        .into_iter()
        .filter_map(|error| {
            let cheapest = |method: Method| {
                let good = points.iter().filter(|p| {
                    p.method == method && p.failed.is_none() && p.position <= error
                });
                good.min_by(|a, b| a.wall.total_cmp(&b.wall))
            };
            let mut each: Vec<&Point> = Method::ALL.iter().filter_map(|m| cheapest(*m)).collect();
            each.sort_by(|a, b| a.wall.total_cmp(&b.wall));
            let best = each.first()?.wall;
            let words: Vec<String> = each
                .iter()
                .map(|p| {
                    format!("{} x{:.1} ({} solves, {})", p.method.name(), p.wall / best, p.linear_solves, p.setting)
                })
                .collect();
            Some(format!("{scene}, position within {error:.0e} of the size: {}", words.join("; ")))
        })
        .collect()
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let mut table = Table::new(&[
        "scene",
        "method",
        "setting",
        "wall_s",
        "linear_solves",
        "error_position",
        "error_rest_angle_deg",
        "failed",
        "error_angle_deg",
        "step_s",
        "tolerance_m",
        "largest_strain",
        "why_failed",
    ]);
    let mut notes = vec![
        "error_position: largest distance of a point from the reference at the end, over the size of the scene"
            .into(),
        "linear_solves: systems solved, of the whole or of parts; rounds of sweeps for vbd, which is visual".into(),
    ];
    let mut panels = Vec::new();
    let mut scenes: Vec<(&'static str, Vec<Point>)> = Vec::new();
    for sweep in sweeps() {
        scenes.push((sweep.scene.name(), points(&sweep, options.runs, &mut notes)?));
    }
    if options.full {
        scenes.push((garment::NAME, garment::points(&mut notes)?));
    }
    for (name, points) in &scenes {
        for p in points {
            let degrees = f64::to_degrees;
            table.push([
                (*name).into(),
                p.method.name().into(),
                p.setting.as_str().into(),
                p.wall.into(),
                p.linear_solves.into(),
                p.position.into(),
                p.rest_angle.map(degrees).into(),
                p.failed.is_some().into(),
                degrees(p.angle).into(),
                p.knobs[0].into(),
                p.knobs[1].into(),
                p.strain.into(),
                p.failed.into(),
            ]);
        }
        panels.extend(pictures(name, points));
    }
    let title = "What a method costs for what error".into();
    Ok(Chart { name: "accuracy", table, figure: Figure { title, panels }, notes })
}

/// Errors smaller than these are shown as these [degrees], [-].
const LEAST: [f64; 2] = [1e-3, 1e-7];

/// Three panels of a scene.
fn pictures(name: &str, points: &[Point]) -> [Panel; 3] {
    let remembers = points.iter().any(|p| p.rest_angle.is_some());
    let angle = |p: &Point| p.rest_angle.unwrap_or(p.angle).to_degrees().max(LEAST[0]);
    let position = |p: &Point| p.position.max(LEAST[1]);
    let of_angle = if remembers { "error of rest angles, rms [degrees]" } else { "error of angles, rms [degrees]" };
    let panel = |error: &dyn Fn(&Point) -> f64, cost: &dyn Fn(&Point) -> f64, x: &str, y: &str| Panel {
        title: name.to_owned(),
        x: Axis::decades(x),
        y: Axis::decades(y),
        series: fronts(points, error, cost),
    };
    let of_position = "error of positions over size [-]";
    let solves = |p: &Point| p.linear_solves as f64;
    [
        panel(&position, &|p| p.wall, of_position, "wall time [s]"),
        panel(&angle, &|p| p.wall, of_angle, "wall time [s]"),
        panel(&position, &solves, of_position, "linear solves"),
    ]
}

/// Per method: its settings as dots, the front of them as a line, failures as crosses.
fn fronts(points: &[Point], error: &dyn Fn(&Point) -> f64, cost: &dyn Fn(&Point) -> f64) -> Vec<Series> {
    let mut series = Vec::new();
    for (colour, &method) in Method::ALL.iter().enumerate() {
        let own = || points.iter().filter(|p| p.method == method);
        let place = |p: &Point| [error(p), cost(p)];
        let mut dots: Vec<[f64; 2]> = own().filter(|p| p.failed.is_none()).map(place).collect();
        dots.retain(|p| p[0].is_finite());
        dots.sort_by(|a, b| a[1].total_cmp(&b[1]));
        let mut best = f64::INFINITY;
        let front = dots.iter().copied().filter(|p| p[0] < best && { best = p[0]; true }).collect();
        // What is not a number stands where nothing is worse.
        let crosses = own().filter(|p| p.failed.is_some()).map(place);
        let crosses = crosses.map(|p| [if p[0].is_finite() { p[0].min(10.0) } else { 10.0 }, p[1]]).collect();
        let name = if method.is_visual() { format!("{} (visual)", method.name()) } else { method.name().into() };
        series.push(Series::new("", colour, Mark::Line, front));
        series.push(Series::new(&name, colour, Mark::Dots, dots));
        series.push(Series::new("", colour, Mark::Crosses, crosses));
    }
    series
}
