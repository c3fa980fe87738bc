//! `crease chart speed`: what a bake costs and where the time goes, beside kernels of the same machine in the same run.
//!
//! Scenes: the T-shirt folded thrice (2,000 points; with `--full` 13,863, and the growth between them), the three falling strips
//! of the paper's Table 1 with memory. Kernels bound what can be had: a streaming copy of memory, the sparse product and
//! the factorisation of one sheet's system, of about as many points as the T-shirt, and one search for triangles that are
//! near one another in two layers of as many points (parry's tree: refitted, and all overlaps of its boxes listed).
//! `ratio` is a scene's wall time for every linear solve over one factorisation, `solver_ratio` that of its linear solves
//! alone, `contact_ratio` its time in contact for every linear solve over one search. Medians of `runs`; the T-shirt is baked
//! once.

use super::accuracy::FoldThrice;
use super::sheet::Sheet;
use super::strip;
use super::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table, median};
use crate::bake::BakeOptions;
use crate::energy::BlockSink;
use crate::error::Result;
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::math::{Mat3, Vec3};
use crate::mesh::PointIndex;
use crate::mesh::tree::TriangleTree;
use crate::solve::{BlockMatrix, Cholesky};
use std::time::Instant;

/// Numbers that the streaming copy moves: far more than caches hold.
const STREAM: usize = 1 << 24;
/// Side of the kernels' sheet [m].
const SHEET: f64 = 0.7;
/// Distance of two layers that touch, and how far boxes reach [m].
const LAYER: f64 = 0.65e-3;
/// The stages of a bake, as its report names them.
const STAGES: [&str; 5] = ["assemble", "solve", "contact", "remember", "home"];

/// What one scene took.
struct Cost {
    scene: &'static str,
    points: usize,
    wall: f64,
    simulated: f64,
    steps: u64,
    solves: u64,
    stages: Vec<(&'static str, f64)>,
}

impl Cost {
    /// Time of a stage [s], if the scene tells it.
    fn stage(&self, name: &str) -> Option<f64> {
        self.stages.iter().find(|(stage, _)| *stage == name).map(|(_, seconds)| *seconds)
    }

    /// Time of the linear solves and of contact for every linear solve, over one factorisation and one search.
    fn ratios(&self, kernels: &Kernels) -> [Option<f64>; 2] {
        let solves = self.solves.max(1) as f64;
        [("solve", kernels.factor), ("contact", kernels.search)]
            .map(|(stage, kernel)| self.stage(stage).map(|seconds| seconds / solves / kernel))
    }
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let mut costs = Vec::new();
    let mut shirts = vec![FoldThrice::new()?];
    if options.full {
        shirts.push(FoldThrice::full()?);
    }
    for shirt in &shirts {
        let run = shirt.run(&BakeOptions::default())?;
        let report = &run.baked.report;
        costs.push(Cost {
            scene: "fold-thrice",
            points: run.baked.end.len(),
            wall: run.wall,
            simulated: report.simulated,
            steps: report.steps,
            solves: run.linear_solves,
            stages: report.stages.clone(),
        });
    }
    let fabric = Fabric::preset(DEFAULT_FABRIC)?;
    for points in strip::points_of_meshes() {
        let mut falls = Vec::new();
        for run in 0..options.runs.max(1) {
            falls.push(strip::fall(points, &fabric, true, run)?);
        }
        falls.sort_by(|a, b| a.wall.total_cmp(&b.wall));
        let fall = &falls[falls.len() / 2];
        costs.push(Cost {
            scene: "falling strip",
            points,
            wall: fall.wall,
            simulated: fall.residuals.last().map_or(0.0, |r| r[0]),
            steps: fall.steps,
            solves: fall.iterations,
            stages: Vec::new(),
        });
    }
    let mut notes = growth(&costs);
    let mut table = Table::new(&[
        "scene",
        "points",
        "wall_s",
        "simulated_s",
        "steps",
        "linear_solves",
        "ratio",
        "solver_ratio",
        "contact_ratio",
        "stages",
    ]);
    for points in [2_000, 14_000] {
        let kernels = Kernels::measure(points, options.runs)?;
        for (name, wall) in kernels.rows() {
            let blank = || None::<f64>.into();
            let (b, points) = (blank, kernels.points as u64);
            table.push([name.into(), points.into(), wall.into(), b(), b(), b(), b(), b(), b(), "".into()]);
        }
        notes.push(kernels.note());
        for cost in costs.iter().filter(|c| (c.points < 7_000) == (points < 7_000) && c.solves > 0) {
            notes.push(format!(
                "{}, {} points: {:.2} times one factorisation for every linear solve",
                cost.scene,
                cost.points,
                cost.wall / cost.solves as f64 / kernels.factor
            ));
            if let [Some(solver), Some(contact)] = cost.ratios(&kernels) {
                notes.push(format!(
                    "{}, {} points: {solver:.2} times one factorisation in the solver and {contact:.2} times one search in contact for every linear solve",
                    cost.scene, cost.points
                ));
            }
        }
        for cost in costs.iter().filter(|c| (c.points < 7_000) == (points < 7_000)) {
            let stages: Vec<String> = cost.stages.iter().map(|(name, s)| format!("{name} {s:.2}")).collect();
            let [solver, contact] = cost.ratios(&kernels);
            table.push([
                cost.scene.into(),
                (cost.points as u64).into(),
                cost.wall.into(),
                cost.simulated.into(),
                cost.steps.into(),
                cost.solves.into(),
                (cost.wall / cost.solves.max(1) as f64 / kernels.factor).into(),
                solver.into(),
                contact.into(),
                stages.join(", ").as_str().into(),
            ]);
        }
    }
    notes.push("ratio: wall time for every linear solve over one factorisation; a solve of a part counts like one of the whole".into());
    Ok(Chart { name: "speed", table, figure: figure(&costs), notes })
}

/// Exponents of the growth of wall time with points.
fn growth(costs: &[Cost]) -> Vec<String> {
    let of = |scene: &str| -> Vec<&Cost> { costs.iter().filter(|c| c.scene == scene).collect() };
    let exponent = |a: &Cost, b: &Cost| (b.wall / a.wall).ln() / (b.points as f64 / a.points as f64).ln();
    let mut notes = Vec::new();
    for scene in ["fold-thrice", "falling strip"] {
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
    for cost in costs.iter().filter(|c| c.scene == "fold-thrice") {
        notes.push(format!(
            "fold-thrice, {} points: {:.2} s of wall time for every second of wear",
            cost.points,
            cost.wall / cost.simulated
        ));
    }
    notes
}

/// What the machine can do with a sheet.
struct Kernels {
    points: usize,
    /// Streaming copy [bytes/s].
    copy: f64,
    /// Sparse product [s], and the bytes it reads.
    product: (f64, f64),
    /// Factorisation and solution [s], and multiplications of the former.
    factor: f64,
    solve: f64,
    work: f64,
    /// One search of two layers that touch [s], and pairs of triangles that it finds.
    search: f64,
    near: usize,
}

impl Kernels {
    fn measure(points: usize, runs: usize) -> Result<Self> {
        let (matrix, places) = sheet_system(points)?;
        let rows = matrix.row_count();
        let from: Vec<f64> = (0..STREAM).map(|k| k as f64).collect();
        let mut to = vec![0.0; STREAM];
        let copy = time_of(runs, || to.copy_from_slice(std::hint::black_box(&from)));
        std::hint::black_box(&to);
        let x = vec![Vec3::new(1.0, 2.0, 3.0); rows];
        let mut y = vec![Vec3::zeros(); rows];
        let product = time_of(runs, || matrix.multiply(std::hint::black_box(&x), &mut y));
        let mut direct = Cholesky::default();
        // The first one finds the order of elimination.
        let fails = |_| crate::Error::fault("chart", "speed", "a sheet's system is not positive", "");
        direct.factorise(&matrix, &places).map_err(fails)?;
        let mut sound = true;
        let factor = time_of(runs, || sound &= direct.factorise(&matrix, &places).is_ok());
        let solve = time_of(runs, || sound &= direct.solve(&matrix, &mut x.clone()).is_ok());
        if !sound {
            return Err(crate::Error::fault("chart", "speed", "a sheet's system could not be solved", ""));
        }
        let (points_of_layers, triangles) = two_layers(points)?;
        let mut tree = TriangleTree::new(&points_of_layers, &triangles, LAYER);
        let mut near = 0;
        let search = time_of(runs, || {
            tree.refit(&points_of_layers, std::hint::black_box(&points_of_layers), LAYER);
            near = tree.overlapping_pairs().len();
        });
        Ok(Self {
            points: rows,
            copy: (2 * STREAM * size_of::<f64>()) as f64 / copy,
            product: (product, (matrix.block_count() * (size_of::<Mat3>() + 4)) as f64),
            factor,
            solve,
            work: direct.size().0,
            search,
            near,
        })
    }

    fn rows(&self) -> [(&'static str, f64); 4] {
        [
            ("kernel: sparse product", self.product.0),
            ("kernel: factorisation", self.factor),
            ("kernel: solution", self.solve),
            ("kernel: search", self.search),
        ]
    }

    fn note(&self) -> String {
        format!(
            "kernels at {} points: copy {:.1} GB/s; sparse product {:.2} ms, {:.1} GB/s of matrix; factorisation {:.1} ms, {:.0} GFlop/s; solution {:.1} ms; search of two layers {:.1} ms, {} pairs of triangles",
            self.points,
            self.copy / 1e9,
            1e3 * self.product.0,
            self.product.1 / self.product.0 / 1e9,
            1e3 * self.factor,
            2.0 * self.work / self.factor / 1e9,
            1e3 * self.solve,
            1e3 * self.search,
            self.near
        )
    }
}

/// A flat sheet's system: every edge a spring along itself and every hinge one across, and mass.
fn sheet_system(points: usize) -> Result<(BlockMatrix, Vec<Vec3>)> {
    let garment = Sheet::unstructured(SHEET, SHEET, points)?.flat_garment();
    let count = garment.points.len();
    let hinges: Vec<[u32; 4]> = garment.topology.hinges.iter().map(|h| h.points.map(|p| p.0)).collect();
    let mut matrix = BlockMatrix::with_pattern((0..count as u32).collect(), &mut |visit| {
        hinges.iter().for_each(|points| visit(points));
    });
    for [a, b, c, d] in &hinges {
        for (p, q) in [(a, b), (c, d), (a, c), (b, d)] {
            let along = (garment.points[*q as usize] - garment.points[*p as usize]).normalize();
            let block = along * along.transpose() * 100.0 + Mat3::identity();
            // Only blocks on and below the diagonal are given.
            for (i, j, sign) in [(p, p, 1.0), (q, q, 1.0), (p.max(q), p.min(q), -1.0)] {
                matrix.add(*i, *j, &(block * sign));
            }
        }
    }
    (0..count).for_each(|p| matrix.add_diagonal(p, 1.0));
    Ok((matrix, garment.points))
}

/// Two flat layers of about `points` points in all that touch.
fn two_layers(points: usize) -> Result<(Vec<Vec3>, Vec<[PointIndex; 3]>)> {
    let layer = Sheet::unstructured(SHEET, SHEET, points / 2)?.flat_garment();
    let count = layer.points.len() as u32;
    // The axis in which the sheet is flat.
    let up = Vec3::y() * LAYER;
    let above = layer.points.iter().map(|p| p + up);
    let shifted = layer.triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + count)));
    Ok((
        layer.points.iter().copied().chain(above).collect(),
        layer.triangles.iter().copied().chain(shifted).collect(),
    ))
}

/// Median time of `work` over `runs` [s].
fn time_of(runs: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..runs.max(1)).map(|_| {
        let clock = Instant::now();
        work();
        clock.elapsed().as_secs_f64()
    });
    median(times).unwrap_or(0.0)
}

fn figure(costs: &[Cost]) -> Figure {
    let points = |scene: &str| -> Vec<[f64; 2]> {
        costs.iter().filter(|c| c.scene == scene).map(|c| [c.points as f64, c.wall]).collect()
    };
    let most = costs.iter().map(|c| c.wall).fold(1.0, f64::max);
    let shirt = costs.iter().rfind(|c| c.scene == "fold-thrice");
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
                    Series::new("T-shirt folded thrice, 58 s", 0, Mark::Rings, points("fold-thrice")),
                    Series::new("falling strip, to rest", 1, Mark::Crosses, points("falling strip")),
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
    fn kernels_solve_what_they_are_given() {
        let (matrix, places) = sheet_system(300).unwrap();
        let x: Vec<Vec3> = places.iter().map(|p| Vec3::new(p.x, 1.0, p.z)).collect();
        let mut y = vec![Vec3::zeros(); x.len()];
        matrix.multiply(&x, &mut y);
        let mut direct = Cholesky::default();
        direct.factorise(&matrix, &places).unwrap();
        direct.solve(&matrix, &mut y).unwrap();
        let off = x.iter().zip(&y).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off}");
        let kernels = Kernels::measure(300, 1).unwrap();
        assert!(kernels.factor > 0.0 && kernels.work > 0.0 && kernels.copy > 0.0);
        // Every triangle finds the one over it.
        let (points, triangles) = two_layers(300).unwrap();
        let half = triangles.len() as u32 / 2;
        let pairs = TriangleTree::new(&points, &triangles, LAYER).overlapping_pairs();
        let found = |f: u32| pairs.iter().any(|pair| pair.contains(&f) && pair.contains(&(f + half)));
        assert!((0..half).all(found));
    }
}
