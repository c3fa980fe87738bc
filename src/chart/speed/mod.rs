//! `crease chart speed`: what a bake costs and where the time goes, beside kernels of the same machine in the same run.
//!
//! Scenes (`scenes.rs`): the T-shirt folded thrice (2,000 points; with `--full` 13,863 and 60,000, and the growth between them), one
//! bend of a sleeve's elbow, the three falling strips of the paper's Table 1 with memory, a cantilever. Kernels (`kernels.rs`)
//! bound what can be had: a streaming copy of memory, the sparse product and the factorisation of one sheet's system, and one
//! search for triangles that are near one another in two layers of as many points (parry's tree: refitted, and all overlaps of
//! its boxes listed), each for the size that is next to the points that the scene simulates.
//! `ratio` is a scene's wall time for every linear solve over one factorisation, `solver_ratio` that of its linear solves
//! alone, `contact_ratio` its time in contact for every linear solve over one search; `rate_ratio` the operations of its
//! factorisations in the time of its linear solves over the rate of the one factorisation, `copy_ratio` the bytes that these
//! move at least over what the streaming copy moves. Medians of `runs`; whole garments are baked once.

mod kernels;
mod scenes;

use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::error::Result;
use crate::sim::SolveCost;
use kernels::Kernels;

/// The stages of a bake, as its report names them.
const STAGES: [&str; 5] = ["assembly", "linear_solve", "contact", "memory", "relax"];
/// Points of the sheets that kernels are measured on; the last with `--full`.
const KERNELS: [usize; 3] = [2_000, 6_000, 14_000];

/// What one scene took.
struct Cost {
    scene: &'static str,
    points: usize,
    /// Points that were simulated: fewer where a bake grades its mesh.
    simulated_points: usize,
    wall: f64,
    simulated: Option<f64>,
    steps: u64,
    /// Linear solves, of the whole and of a few places.
    solves: u64,
    /// What they took.
    work: SolveCost,
    stages: Vec<(&'static str, f64)>,
}

/// A scene's times over those of kernels [-].
struct Ratios {
    /// Wall time of one linear solve over one factorisation.
    whole: f64,
    /// Of the linear solves alone, and contact over a search; none where the scene does not tell its stages.
    solver: Option<f64>,
    contact: Option<f64>,
    /// Operations of factorisations and bytes moved, for the time of the linear solves.
    rate: Option<f64>,
    copy: Option<f64>,
}

impl Cost {
    /// Time of a stage [s], if the scene tells it.
    fn stage(&self, name: &str) -> Option<f64> {
        self.stages.iter().find(|(stage, _)| *stage == name).map(|(_, seconds)| *seconds)
    }

    fn over(&self, kernels: &Kernels) -> Ratios {
        let solves = self.solves.max(1) as f64;
        let each = |stage: &str| self.stage(stage).map(|seconds| seconds / solves);
        let solving = self.stage("linear_solve").filter(|seconds| *seconds > 0.0);
        Ratios {
            whole: self.wall / solves / kernels.factor,
            solver: each("linear_solve").map(|seconds| seconds / kernels.factor),
            contact: each("contact").map(|seconds| seconds / kernels.search),
            rate: solving.map(|seconds| 2.0 * self.work.multiplications / seconds / kernels.rate()),
            copy: solving.map(|seconds| self.work.bytes / seconds / kernels.copy),
        }
    }
}

/// Which of the kernels' sizes is next to a scene of which so many `points` are simulated.
fn next_to(points: usize, sizes: &[usize]) -> usize {
    let apart = |size: usize| (points as f64 / size as f64).ln().abs();
    let next = |a: &usize, b: &usize| apart(sizes[*a]).total_cmp(&apart(sizes[*b]));
    (0..sizes.len()).min_by(next).unwrap_or(0)
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let costs = scenes::costs(options)?;
    let sizes = if options.full { &KERNELS[..] } else { &KERNELS[..2] };
    let mut notes = growth(&costs);
    let mut table = Table::new(&[
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
    ]);
    for (size, &points) in sizes.iter().enumerate() {
        let kernels = Kernels::measure(points, options.runs)?;
        for (name, wall) in kernels.rows() {
            let points = kernels.points as u64;
            table.push([name.into(), points.into(), points.into(), wall.into()]);
        }
        notes.push(kernels.note());
        for cost in costs.iter().filter(|cost| next_to(cost.simulated_points, sizes) == size) {
            let ratios = cost.over(&kernels);
            notes.extend(told(cost, &ratios));
            let stages: Vec<String> = cost.stages.iter().map(|(name, s)| format!("{name} {s:.2}")).collect();
            table.push([
                cost.scene.into(),
                (cost.points as u64).into(),
                (cost.simulated_points as u64).into(),
                cost.wall.into(),
                cost.simulated.into(),
                cost.steps.into(),
                cost.solves.into(),
                ratios.whole.into(),
                ratios.solver.into(),
                ratios.contact.into(),
                stages.join(", ").as_str().into(),
                (2e-9 * cost.work.multiplications).into(),
                (1e-9 * cost.work.bytes).into(),
                ratios.rate.into(),
                ratios.copy.into(),
            ]);
        }
    }
    notes.push("ratio: wall time for every linear solve over one factorisation; a solve of a part counts like one of the whole".into());
    Ok(Chart { name: "speed", table, figure: figure(&costs), notes })
}

/// A scene's ratios in words.
fn told(cost: &Cost, ratios: &Ratios) -> Vec<String> {
    let name = format!("{}, {} points", cost.scene, cost.points);
    let mut notes = vec![format!("{name}: {:.2} times one factorisation for every linear solve", ratios.whole)];
    if let (Some(solver), Some(contact)) = (ratios.solver, ratios.contact) {
        notes.push(format!(
            "{name}: {solver:.2} times one factorisation in the solver and {contact:.2} times one search in contact for every linear solve"
        ));
    }
    if let (Some(rate), Some(copy)) = (ratios.rate, ratios.copy) {
        notes.push(format!(
            "{name}: linear solves run at {rate:.2} times the rate of the factorisation and move {copy:.2} times what the streaming copy does"
        ));
    }
    notes
}

/// Exponents of the growth of wall time with points.
fn growth(costs: &[Cost]) -> Vec<String> {
    let of = |scene: &str| -> Vec<&Cost> { costs.iter().filter(|c| c.scene == scene).collect() };
    let exponent = |a: &Cost, b: &Cost| (b.wall / a.wall).ln() / (b.points as f64 / a.points as f64).ln();
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
                "{}, {} points: {:.2} s of wall time for every second of wear",
                cost.scene,
                cost.points,
                cost.wall / simulated
            ));
        }
    }
    notes
}

fn figure(costs: &[Cost]) -> Figure {
    let points = |scene: &str| -> Vec<[f64; 2]> {
        costs.iter().filter(|c| c.scene == scene).map(|c| [c.points as f64, c.wall]).collect()
    };
    let most = costs.iter().map(|c| c.wall).fold(1.0, f64::max);
    let shirt = costs.iter().rfind(|c| c.scene == scenes::SHIRT);
    let shares: Vec<[f64; 2]> = shirt.map_or(Vec::new(), |cost| {
        let share = |name: &&str| 100.0 * cost.stage(name).unwrap_or(0.0) / cost.wall;
        STAGES.iter().enumerate().flat_map(|(k, name)| [[k as f64, 0.0], [k as f64, share(name)]]).collect()
    });
    let title = shirt.map_or(0, |cost| cost.points);
    Figure {
        title: "What it costs".into(),
        panels: vec![
            Panel {
                title: "wall time".into(),
                x: Axis::decades("points"),
                y: Axis::decades("wall time [s]").between(0.1, 2.0 * most),
                series: vec![
                    Series::new("T-shirt folded thrice, 58 s", 0, Mark::Rings, points(scenes::SHIRT)),
                    Series::new("falling strip, to rest", 1, Mark::Crosses, points(scenes::STRIP)),
                    Series::new("elbow bent once, 2.5 s", 2, Mark::Dots, points(scenes::ELBOW)),
                    Series::new("cantilever, to rest", 3, Mark::Dots, points(scenes::CANTILEVER)),
                ],
            },
            Panel {
                title: format!("T-shirt of {title} points: where the time goes"),
                x: Axis {
                    names: STAGES.iter().map(|name| (*name).to_owned()).collect(),
                    range: Some([-0.5, STAGES.len() as f64 - 0.5]),
                    ..Axis::default()
                },
                y: Axis::of("share of wall time [%]").between(0.0, 100.0),
                series: vec![Series::new("", 0, Mark::Bars, shares)],
            },
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_go_to_the_kernels_next_to_them() {
        for (points, size) in [(156, 0), (1_999, 0), (3_040, 0), (5_246, 1), (6_000, 1), (13_863, 2), (59_000, 2)] {
            assert_eq!(next_to(points, &KERNELS), size, "{points}");
        }
    }

    #[test]
    fn what_a_scene_does_not_tell_has_no_ratio() {
        let kernels = Kernels::measure(300, 1).unwrap();
        let work = SolveCost { multiplications: 1e9, bytes: 1e9 };
        let mut cost =
            Cost { scene: "s", points: 300, simulated_points: 300, wall: 2.0, simulated: None, steps: 1, solves: 4, work, stages: vec![] };
        let ratios = cost.over(&kernels);
        assert!(ratios.solver.is_none() && ratios.rate.is_none() && ratios.copy.is_none());
        cost.stages = vec![("linear_solve", 1.0)];
        let ratios = cost.over(&kernels);
        assert_eq!(ratios.rate, Some(2e9 / kernels.rate()));
        assert_eq!(ratios.whole, 0.5 / kernels.factor);
        assert_eq!(ratios.solver, Some(0.25 / kernels.factor));
    }
}
