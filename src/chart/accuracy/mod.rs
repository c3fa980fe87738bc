//! `crease chart accuracy`: cost over error of every integrator.
//!
//! ```text
//! scene x integrator x step x tolerance -> SceneOutcome   compared with the scene's reference -> error, cost
//! ```
//!
//! The reference of a scene is computed on the same mesh with the same energies by the two-stage method with an
//! eighth of the shortest step and Newton to 1e-10 m, and extrapolated from that and twice the step. The notes report
//! its own error. Failures are shown as crosses at their cost. `crease chart front` does the same for a whole bake.

mod point;
mod sweep;

pub use point::{AccuracyPoint, SceneReference, measure, reference};

use crate::comparison::{METHODS, is_visual};
use crate::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crease_model::error::Result;

/// Smallest angle error shown [degrees].
const MIN_SHOWN_ANGLE_DEG: f64 = 1e-3;
/// Smallest position error shown [-].
const MIN_SHOWN_POSITION: f64 = 1e-7;
/// Error at which failures without a finite one are shown, and the largest one shown of failures [-].
const FAILURE_ERROR: f64 = 10.0;

const COLUMNS: &[&str] = &[
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
];

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let mut notes = vec![
        "error_position: largest distance of a point from the reference at the end, over the size of the scene"
            .into(),
        "linear_solves: systems solved, global and local; sweeps for vbd, which is not converged".into(),
    ];
    let mut scenes: Vec<(&'static str, Vec<AccuracyPoint>)> = Vec::new();
    for sweep in sweep::sweeps() {
        scenes.push((sweep.name(), sweep.run(options.runs, &mut notes)?));
    }
    let mut table = Table::new(COLUMNS);
    let mut panels = Vec::new();
    for (name, points) in &scenes {
        points.iter().for_each(|point| push_row(&mut table, name, point));
        panels.extend(panels_of(name, points));
    }
    let title = "Cost over error of every integrator".into();
    Ok(Chart { name: "accuracy", table, figure: Figure { title, panels }, notes })
}

fn push_row(table: &mut Table, scene: &str, p: &AccuracyPoint) {
    table.push([
        scene.into(),
        p.method.name().into(),
        p.setting.as_str().into(),
        p.wall.into(),
        p.linear_solves.into(),
        p.position_error.into(),
        p.rest_angle_error.map(f64::to_degrees).into(),
        p.failed.is_some().into(),
        p.angle_error.to_degrees().into(),
        p.step.into(),
        p.tolerance.into(),
        p.max_strain.into(),
        p.failed.into(),
    ]);
}

/// Three panels of a scene: wall time over errors of position and angle, linear solves over the error of position.
fn panels_of(name: &str, points: &[AccuracyPoint]) -> [Panel; 3] {
    let has_memory = points.iter().any(|p| p.rest_angle_error.is_some());
    let angle =
        |p: &AccuracyPoint| p.rest_angle_error.unwrap_or(p.angle_error).to_degrees().max(MIN_SHOWN_ANGLE_DEG);
    let position = |p: &AccuracyPoint| p.position_error.max(MIN_SHOWN_POSITION);
    let angle_label =
        if has_memory { "rest angle error, rms [degrees]" } else { "angle error, rms [degrees]" };
    let panel = |error: &dyn Fn(&AccuracyPoint) -> f64,
                 cost: &dyn Fn(&AccuracyPoint) -> f64,
                 x: &str,
                 y: &str| Panel {
        title: name.to_owned(),
        x: Axis::log(x),
        y: Axis::log(y),
        series: series_of(points, error, cost),
    };
    let position_label = "position error over size [-]";
    let solves = |p: &AccuracyPoint| p.linear_solves as f64;
    [
        panel(&position, &|p| p.wall, position_label, "wall time [s]"),
        panel(&angle, &|p| p.wall, angle_label, "wall time [s]"),
        panel(&position, &solves, position_label, "linear solves"),
    ]
}

/// Per integrator: its settings as dots, their Pareto front as a line, failures as crosses.
fn series_of(
    points: &[AccuracyPoint],
    error: &dyn Fn(&AccuracyPoint) -> f64,
    cost: &dyn Fn(&AccuracyPoint) -> f64,
) -> Vec<Series> {
    let mut series = Vec::new();
    for (colour, &method) in METHODS.iter().enumerate() {
        let own = || points.iter().filter(|p| p.method == method);
        let position = |p: &AccuracyPoint| [error(p), cost(p)];
        let mut dots: Vec<[f64; 2]> = own().filter(|p| p.failed.is_none()).map(position).collect();
        dots.retain(|p| p[0].is_finite());
        dots.sort_by(|a, b| a[1].total_cmp(&b[1]));
        let mut best = f64::INFINITY;
        let mut front = Vec::new();
        for dot in &dots {
            if dot[0] < best {
                best = dot[0];
                front.push(*dot);
            }
        }
        let crosses = own().filter(|p| p.failed.is_some()).map(position);
        let shown = |error: f64| if error.is_finite() { error.min(FAILURE_ERROR) } else { FAILURE_ERROR };
        let crosses = crosses.map(|p| [shown(p[0]), p[1]]).collect();
        let name =
            if is_visual(method) { format!("{} (visual)", method.name()) } else { method.name().into() };
        series.push(Series::new("", colour, Mark::Line, front));
        series.push(Series::new(&name, colour, Mark::Dots, dots));
        series.push(Series::new("", colour, Mark::Crosses, crosses));
    }
    series
}
