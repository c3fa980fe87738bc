//! `crease chart accuracy`: what every method of the shelf costs for what error.
//!
//! ```text
//! scene x method x step x tolerance -> Outcome   against the scene's reference -> error, cost
//! ```
//!
//! The reference of a scene is made on the same mesh with the same energies by the two-stage method with an eighth of the
//! shortest step, Newton to 1e-10 m, and extrapolated from that and twice the step; with contact, which is not smooth,
//! it is the finer of the two. Its own error is told in the notes. Failures stand in the picture as crosses at their cost.
//! `--full` adds the T-shirt that is folded thrice (`garment.rs`), which takes an hour.

mod garment;

pub(super) use garment::read_own;
pub use garment::{FoldThrice, Run, reference_options};

use crate::chart::scenes;
use crate::chart::scenes::{Cantilever, Flap, Outcome, OverSphere, Scene, Setting, Swing};
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::error::Result;
use crate::sim::{Method, Solver};

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
pub fn reference(scene: &dyn Scene, step: f64, smooth: bool) -> Result<Reference> {
    let share = if smooth { 8.0 } else { 4.0 };
    let make = |h: f64| scenes::run(scene, &Setting::fixed(Method::Sdirk2, h, 1e-10));
    let (fine, coarse) = (make(step / share)?, make(2.0 * step / share)?);
    if !smooth {
        let own_error = fine.profile_error(&coarse, scene.size());
        return Ok(Reference { outcome: fine, own_error });
    }
    let own_error = fine.position_error(&coarse, scene.size());
    let more = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + (a - b) / 3.0).collect();
    let x = fine.x.iter().zip(&coarse.x).map(|(a, b)| a + (a - b) / 3.0).collect();
    let angle = more(&fine.angle, &coarse.angle);
    // Events of memory come one by one: rest angles are not extrapolated.
    Ok(Reference { outcome: Outcome { x, angle, ..fine }, own_error: own_error / 3.0 })
}

/// Runs `scene` by one setting, `runs` times if it is quick, and compares.
pub fn point(
    scene: &dyn Scene,
    reference: &Outcome,
    setting: &Setting,
    smooth: bool,
    runs: usize,
) -> Result<Point> {
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
        position: if smooth {
            outcome.position_error(reference, scene.size())
        } else {
            outcome.profile_error(reference, scene.size())
        },
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
        Solver::Converged => format!("{step}, to {:.0e} m", setting.tolerance),
        Solver::Once => format!("{step}, 1 iteration"),
        Solver::Sweeps => format!("{step}, sweeps"),
    }
}

/// A scene and the steps it is run with.
struct Sweep {
    scenes: Vec<Box<dyn Scene>>,
    /// Longest step [s], and how often it is halved.
    steps: (f64, u32),
    /// Whether it has no contact.
    smooth: bool,
}

fn sweeps(full: bool) -> Vec<Sweep> {
    let smooth = |scene: Box<dyn Scene>, steps| Sweep { scenes: vec![scene], steps, smooth: true };
    vec![
        smooth(Box::new(Flap), (1.0 / 10.0, 5)),
        smooth(Box::new(Swing::SWING_30), (0.02, 5)),
        smooth(Box::new(Swing::RELEASE_90), (0.02, 5)),
        smooth(Box::new(Cantilever), (0.5, 6)),
        Sweep {
            scenes: (1..=SEEDS).map(|seed| Box::new(OverSphere { seed }) as Box<dyn Scene>).collect(),
            steps: (1.0 / 20.0, if full { 4 } else { 2 }),
            smooth: false,
        },
    ]
}

/// Tolerances of Newton, over the size of the scene: where the scene is smooth, and where contact leaves more error than
/// Newton ever does.
const TOLERANCES: [&[f64]; 2] = [&[1e-4, 1e-7], &[1e-4]];
/// Starts of a scene whose folds are decided by little.
const SEEDS: u32 = 3;

/// All points of one sweep; of several seeds that with the median error of position.
fn points(sweep: &Sweep, runs: usize, notes: &mut Vec<String>) -> Result<Vec<Point>> {
    let (longest, halvings) = sweep.steps;
    let shortest = longest / f64::from(1 << halvings);
    let references: Vec<Reference> = sweep
        .scenes
        .iter()
        .map(|scene| reference(scene.as_ref(), shortest, sweep.smooth))
        .collect::<Result<_>>()?;
    let mut all = Vec::new();
    for &method in Method::EVERY {
        for k in 0..=halvings {
            let step = longest / f64::from(1 << k);
            let tolerances = if method.solver() == Solver::Converged { TOLERANCES[usize::from(!sweep.smooth)] } else { &[0.0] };
            for tolerance in tolerances {
                let mut seeds = Vec::new();
                for (scene, reference) in sweep.scenes.iter().zip(&references) {
                    let setting = Setting::fixed(method, step, tolerance * scene.size());
                    seeds.push(point(scene.as_ref(), &reference.outcome, &setting, sweep.smooth, runs)?);
                }
                seeds.sort_by(|a, b| a.position.total_cmp(&b.position));
                all.extend(seeds.into_iter().nth(sweep.scenes.len() / 2));
            }
        }
    }
    let name = sweep.scenes.first().map_or("", |scene| scene.name());
    let mut own: Vec<f64> = references.iter().map(|r| r.own_error).collect();
    own.sort_by(f64::total_cmp);
    let own = own.get(own.len() / 2).copied().unwrap_or(0.0);
    let least = all.iter().filter(|p| p.failed.is_none()).map(|p| p.position).fold(f64::INFINITY, f64::min);
    notes.push(format!(
        "{name}: the reference is good to {own:.1e} of the size, the smallest error shown is {least:.1e}"
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
            let mut each: Vec<&Point> = Method::EVERY.iter().filter_map(|m| cheapest(*m)).collect();
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
        "error_position: largest distance of a point from the reference at the end, over the size of the scene; for \
         sphere-twist root mean square of sorted heights, median of three starts"
            .into(),
        "linear_solves: systems solved, of the whole or of parts; rounds of sweeps for vbd, which is visual".into(),
    ];
    let mut panels = Vec::new();
    let mut scenes: Vec<(&'static str, Vec<Point>)> = Vec::new();
    for sweep in sweeps(options.full) {
        let name = sweep.scenes.first().map_or("", |scene| scene.name());
        scenes.push((name, points(&sweep, options.runs, &mut notes)?));
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
    for (colour, &method) in Method::EVERY.iter().enumerate() {
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
