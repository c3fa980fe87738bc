//! `crease chart speed`: wall time of bakes by stage, compared with kernels of the same machine in the same run.
//!
//! Scenes (`scenes.rs`): the T-shirt folded thrice (2,000 points; with `--full` also 13,863 and 60,000, and the
//! growth between them), one bend of a sleeve's elbow, the three falling strips of the paper's Table 1 with memory, a
//! cantilever.
//!
//! Kernels (`kernels.rs`) are lower bounds of the cost: a streaming copy of memory, the sparse product and the
//! factorisation of one sheet's system, and one search for overlapping triangles of two layers with as many points
//! (parry's tree: refitted, and all overlaps of its boxes listed), each at the size next to the number of simulated
//! points.
//!
//! `ratio` is a scene's wall time per linear solve over one factorisation, `solver_ratio` that of its linear solves
//! alone, `contact_ratio` its time in contact per linear solve over one search; `rate_ratio` is the floating-point
//! rate of its linear solves over that of the factorisation, `copy_ratio` their memory throughput, from the bytes
//! that they move at least, over that of the streaming copy. Medians of `runs`; whole garments are baked once.

mod cost;
mod kernels;
mod scenes;

use crate::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use cost::{CostRatios, SceneCost};
use crease_model::error::Result;
use kernels::Kernels;

/// The stages of a bake, as its report names them.
const STAGES: [&str; 5] = ["assembly", "linear_solve", "contact", "memory", "relax"];
/// Points of the sheets that kernels are measured on; the last with `--full`.
const KERNEL_POINTS: [usize; 3] = [2_000, 6_000, 14_000];

const COLUMNS: &[&str] = &[
    "scene",
    "points",
    "simulated_points",
    "wall_s",
    "simulated_s",
    "steps",
    "linear_solves",
    "ratio",
    "solver_ratio",
    "contact_ratio",
    "stages",
    "solver_gflop",
    "solver_gbyte",
    "rate_ratio",
    "copy_ratio",
];

/// Index of the size next to `points` on a logarithmic scale.
fn nearest_size(points: usize, sizes: &[usize]) -> usize {
    let distance = |size: usize| (points as f64 / size as f64).ln().abs();
    let nearer = |a: &usize, b: &usize| distance(sizes[*a]).total_cmp(&distance(sizes[*b]));
    (0..sizes.len()).min_by(nearer).unwrap_or(0)
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let costs = scenes::costs(options)?;
    let sizes = if options.full { &KERNEL_POINTS[..] } else { &KERNEL_POINTS[..2] };
    let mut notes = growth(&costs);
    let mut table = Table::new(COLUMNS);
    for (size, &points) in sizes.iter().enumerate() {
        let kernels = Kernels::measure(points, options.runs)?;
        for (name, wall) in kernels.rows() {
            let points = kernels.points as u64;
            table.push([name.into(), points.into(), points.into(), wall.into()]);
        }
        notes.push(kernels.note());
        for cost in costs.iter().filter(|cost| nearest_size(cost.simulated_points, sizes) == size) {
            let ratios = cost.over(&kernels);
            notes.extend(notes_of(cost, &ratios));
            push_row(&mut table, cost, &ratios);
        }
    }
    notes.push(
        "ratio: wall time per linear solve over one factorisation; global and local solves count alike"
            .into(),
    );
    Ok(Chart { name: "speed", table, figure: figure(&costs), notes })
}

fn push_row(table: &mut Table, cost: &SceneCost, ratios: &CostRatios) {
    let stages: Vec<String> = cost.stages.iter().map(|(name, s)| format!("{name} {s:.2}")).collect();
    table.push([
        cost.scene.into(),
        (cost.points as u64).into(),
        (cost.simulated_points as u64).into(),
        cost.wall.into(),
        cost.simulated.into(),
        cost.steps.into(),
        cost.solves.into(),
        ratios.total.into(),
        ratios.solver.into(),
        ratios.contact.into(),
        stages.join(", ").as_str().into(),
        (2e-9 * cost.work.multiplications).into(),
        (1e-9 * cost.work.bytes).into(),
        ratios.rate.into(),
        ratios.copy.into(),
    ]);
}

/// Ratios of a scene in words.
fn notes_of(cost: &SceneCost, ratios: &CostRatios) -> Vec<String> {
    let name = format!("{}, {} points", cost.scene, cost.points);
    let mut notes = vec![format!("{name}: {:.2} times one factorisation per linear solve", ratios.total)];
    if let (Some(solver), Some(contact)) = (ratios.solver, ratios.contact) {
        notes.push(format!(
            "{name}: {solver:.2} times one factorisation in the solver and {contact:.2} times one search in contact per linear solve"
        ));
    }
    if let (Some(rate), Some(copy)) = (ratios.rate, ratios.copy) {
        notes.push(format!(
            "{name}: linear solves run at {rate:.2} times the rate of the factorisation and at {copy:.2} times the throughput of the streaming copy"
        ));
    }
    notes
}

/// Exponents of the growth of wall time with the number of points, and wall time per second of wear, in words.
fn growth(costs: &[SceneCost]) -> Vec<String> {
    let of = |scene: &str| -> Vec<&SceneCost> { costs.iter().filter(|c| c.scene == scene).collect() };
    let exponent =
        |a: &SceneCost, b: &SceneCost| (b.wall / a.wall).ln() / (b.points as f64 / a.points as f64).ln();
    let mut notes = Vec::new();
    for scene in [scenes::SHIRT, scenes::STRIP] {
        for pair in of(scene).windows(2) {
            let [a, b] = pair else { continue };
            notes.push(format!(
                "{scene}: {} to {} points, {:.1} to {:.1} s, growth with exponent {:.2}",
                a.points,
                b.points,
                a.wall,
                b.wall,
                exponent(a, b)
            ));
        }
    }
    for cost in costs.iter() {
        if let Some(simulated) = cost.simulated.filter(|_| cost.scene != scenes::STRIP) {
            notes.push(format!(
                "{}, {} points: {:.2} s of wall time per second of wear",
                cost.scene,
                cost.points,
                cost.wall / simulated
            ));
        }
    }
    notes
}

/// Wall time over points, and the stages of the largest T-shirt.
fn figure(costs: &[SceneCost]) -> Figure {
    let points = |scene: &str| -> Vec<[f64; 2]> {
        costs.iter().filter(|c| c.scene == scene).map(|c| [c.points as f64, c.wall]).collect()
    };
    let max_wall = costs.iter().map(|c| c.wall).fold(1.0, f64::max);
    let shirt = costs.iter().rfind(|c| c.scene == scenes::SHIRT);
    let percentages: Vec<[f64; 2]> = shirt.map_or(Vec::new(), |cost| {
        let percentage = |name: &&str| 100.0 * cost.stage(name).unwrap_or(0.0) / cost.wall;
        STAGES
            .iter()
            .enumerate()
            .flat_map(|(k, name)| [[k as f64, 0.0], [k as f64, percentage(name)]])
            .collect()
    });
    let shirt_points = shirt.map_or(0, |cost| cost.points);
    Figure {
        title: "Wall time of bakes".into(),
        panels: vec![
            Panel {
                title: "wall time".into(),
                x: Axis::log("points"),
                y: Axis::log("wall time [s]").between(0.1, 2.0 * max_wall),
                series: vec![
                    Series::new("T-shirt folded thrice, 58 s", 0, Mark::Rings, points(scenes::SHIRT)),
                    Series::new("falling strip, to rest", 1, Mark::Crosses, points(scenes::STRIP)),
                    Series::new("elbow bent once, 2.5 s", 2, Mark::Dots, points(scenes::ELBOW)),
                    Series::new("cantilever, to rest", 3, Mark::Dots, points(scenes::CANTILEVER)),
                ],
            },
            Panel {
                title: format!("T-shirt of {shirt_points} points: wall time by stage"),
                x: Axis {
                    names: STAGES.iter().map(|name| (*name).to_owned()).collect(),
                    range: Some([-0.5, STAGES.len() as f64 - 0.5]),
                    ..Axis::default()
                },
                y: Axis::linear("fraction of wall time [%]").between(0.0, 100.0),
                series: vec![Series::new("", 0, Mark::Bars, percentages)],
            },
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_compared_with_kernels_of_the_nearest_size() {
        for (points, size) in
            [(156, 0), (1_999, 0), (3_040, 0), (5_246, 1), (6_000, 1), (13_863, 2), (59_000, 2)]
        {
            assert_eq!(nearest_size(points, &KERNEL_POINTS), size, "{points}");
        }
    }
}
