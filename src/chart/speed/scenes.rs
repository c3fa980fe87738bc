//! The timed scenes.

use crate::bake_scene::BakeScene;
use crate::falling_strip::{FALLING_STRIP_POINTS, Fall, Stepping, fall};
use crate::speed::cost::SceneCost;
use crate::{ChartOptions, cantilever};
use crease::internal::bake::{BakeOptions, BakeReport};
use crease_model::error::Result;
use crease_model::fabric::{Fabric, PAPER_FABRIC};
use crease_solver::sim::NewtonSeconds;
use std::time::Instant;

pub(super) const SHIRT: &str = "fold-thrice";
pub(super) const STRIP: &str = "falling strip";
pub(super) const ELBOW: &str = "elbow, one bend";
pub(super) const CANTILEVER: &str = "cantilever";

/// Edge length to which the T-shirt of 13,863 points is refined for the largest one [m].
const REFINED_EDGE: f64 = 5.4e-3;
/// Elements along the cantilever.
const ELEMENTS: usize = 80;
/// Weight of the cantilever over its rigidity, rho g L³ / B [-].
const GAMMA: f64 = 10.0;

/// Runs all scenes; those that are short several times, of which the median counts.
pub(super) fn costs(options: &ChartOptions) -> Result<Vec<SceneCost>> {
    let mut costs = Vec::new();
    let mut shirts = vec![BakeScene::tshirt_draft()?];
    if options.full {
        let full = BakeScene::tshirt()?;
        let refined = full.refine(REFINED_EDGE);
        shirts.extend([full, refined]);
    }
    for shirt in &shirts {
        let run = shirt.run(&BakeOptions::default())?;
        costs.push(of_bake(SHIRT, shirt.points(), run.wall, &run.baked.report));
    }
    let run = BakeScene::elbow()?.run(&BakeOptions::default())?;
    costs.push(of_bake(ELBOW, run.baked.worn.displacement.len(), run.wall, &run.baked.report));
    let fabric = Fabric::preset(PAPER_FABRIC)?;
    for points in FALLING_STRIP_POINTS {
        let fall_of = |run| fall(points, &fabric, true, run, Stepping::Adaptive);
        let falls = (0..options.runs.max(1)).map(fall_of);
        costs.extend(median(falls.map(|fall| Ok(of_fall(points, &fall?))).collect::<Result<_>>()?));
    }
    let bends = (0..options.runs.max(1)).map(|_| cantilever_bent());
    costs.extend(median(bends.collect()));
    Ok(costs)
}

/// The median by wall time.
fn median(mut costs: Vec<SceneCost>) -> Option<SceneCost> {
    costs.sort_by(|a, b| a.wall.total_cmp(&b.wall));
    let middle = costs.len() / 2;
    (middle < costs.len()).then(|| costs.swap_remove(middle))
}

fn of_bake(scene: &'static str, points: usize, wall: f64, report: &BakeReport) -> SceneCost {
    SceneCost {
        scene,
        points,
        simulated_points: report.points,
        wall,
        simulated: Some(report.simulated),
        steps: report.steps,
        solves: report.solves + report.local_solves,
        work: report.cost,
        stages: report.stages.clone(),
    }
}

fn of_fall(points: usize, fall: &Fall) -> SceneCost {
    SceneCost {
        scene: STRIP,
        points,
        simulated_points: points,
        wall: fall.wall,
        simulated: fall.residuals.last().map(|r| r[0]),
        steps: fall.steps,
        solves: fall.iterations + fall.local_iterations,
        work: fall.cost,
        stages: stages(fall.seconds),
    }
}

/// Wall times of Newton as named stages [s].
fn stages(seconds: NewtonSeconds) -> Vec<(&'static str, f64)> {
    vec![("assembly", seconds.assembly), ("linear_solve", seconds.linear_solve), ("contact", seconds.contact)]
}

/// Computes the equilibrium of a strip that bends under its weight.
fn cantilever_bent() -> SceneCost {
    let clock = Instant::now();
    let bent = cantilever::bent(ELEMENTS, GAMMA);
    let wall = clock.elapsed().as_secs_f64();
    SceneCost {
        scene: CANTILEVER,
        points: bent.points,
        simulated_points: bent.points,
        wall,
        simulated: None,
        steps: 0,
        solves: (bent.newton.global_iterations + bent.newton.local_iterations) as u64,
        work: bent.newton.cost,
        stages: stages(bent.newton.seconds),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shirts_have_the_documented_number_of_points() {
        let [draft, full] = [BakeScene::tshirt_draft().unwrap(), BakeScene::tshirt().unwrap()];
        let refined = full.refine(REFINED_EDGE);
        for (shirt, points) in [(draft, 2_000.0), (full, 14_000.0), (refined, 60_000.0)] {
            let ratio = shirt.points() as f64 / points;
            assert!((ratio - 1.0).abs() < 0.05, "{points}: {}", shirt.points());
        }
    }

    #[test]
    fn a_cantilever_reports_its_cost() {
        let cost = cantilever_bent();
        assert!(cost.solves > 0 && cost.work.multiplications > 0.0 && cost.work.bytes > 0.0);
        assert!(cost.stages.iter().map(|(_, s)| s).sum::<f64>() <= cost.wall);
    }
}
