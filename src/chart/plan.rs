//! `crease chart plan`: what the plan of a bake saves: the draft T-shirt folded thrice with the models that `--explain`
//! chooses, and with everything on (the fabric's whole stretch stiffness, steps of 1/60 s throughout, every solve of the
//! whole garment).
//!
//! Compared are cost and the product: rest angles. Their sum says how much the garment remembers, the root mean square of
//! their differences whether it remembers in the same places. Folds that begin in contact are decided by little, so that
//! a third run, the plan with a twelfth less error per step, says how much two equally good runs differ.

use super::accuracy::{FoldThrice, Run};
use super::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::bake::BakeOptions;
use crate::error::Result;

/// The bakes that are compared: name, and how each differs from what a bake does unless told otherwise.
fn bakes() -> [(&'static str, BakeOptions); 3] {
    let plan = BakeOptions::default();
    let mut shaken = plan.clone();
    shaken.step.error *= 11.0 / 12.0;
    [
        ("plan", plan.clone()),
        ("plan, shaken", shaken),
        ("everything", BakeOptions { everything: true, ..plan }),
    ]
}

pub(super) fn make(_options: &ChartOptions) -> Result<Chart> {
    let scene = FoldThrice::new()?;
    let mut table = Table::new(&[
        "scene",
        "plan",
        "wall_s",
        "steps",
        "linear_solves",
        "rest_angle_rms_deg",
        "difference_rms_deg",
        "difference_of_mean_percent",
    ]);
    let mut runs: Vec<(&'static str, Run)> = Vec::new();
    for (name, options) in bakes() {
        runs.push((name, scene.run(&options)?));
    }
    let mut bars = [Vec::new(), Vec::new()];
    let mut notes = Vec::new();
    let Some((_, first)) = runs.first() else { return Err(crate::Error::fault("chart", "plan", "is empty", "")) };
    let size = |run: &Run| scene.rest_angle_size(&run.baked);
    for (place, (name, run)) in runs.iter().enumerate() {
        let difference = scene.rest_angle_error(&run.baked, &first.baked).to_degrees();
        let of_mean = 100.0 * (scene.rest_angle_mean(&run.baked) / scene.rest_angle_mean(&first.baked) - 1.0);
        table.push([
            "fold-thrice".into(),
            (*name).into(),
            run.wall.into(),
            run.baked.report.steps.into(),
            run.linear_solves.into(),
            size(run).to_degrees().into(),
            difference.into(),
            of_mean.into(),
        ]);
        bars[0].extend([[place as f64, 0.0], [place as f64, run.wall]]);
        bars[1].extend([[place as f64, 0.0], [place as f64, size(run).to_degrees()]]);
        notes.push(format!(
            "{name}: {:.1} s, {} steps, {} solves; rest angles {:.2} degrees rms; against the plan {of_mean:+.2} % in the mean, \
             {difference:.2} degrees rms apart; {:.1} times its wall time",
            run.wall,
            run.baked.report.steps,
            run.linear_solves,
            size(run).to_degrees(),
            run.wall / first.wall
        ));
    }
    let names = || Axis {
        names: runs.iter().map(|(name, _)| (*name).to_owned()).collect(),
        range: Some([-0.5, runs.len() as f64 - 0.5]),
        ..Axis::default()
    };
    let panel = |title: &str, label: &str, colour: usize, points: Vec<[f64; 2]>| {
        let top = points.iter().map(|p| p[1]).fold(0.0, f64::max);
        Panel {
            title: title.into(),
            x: names(),
            y: Axis::of(label).between(0.0, 1.1 * top.max(1e-9)),
            series: vec![Series::new("", colour, Mark::Bars, points)],
        }
    };
    let [walls, sizes] = bars;
    let panels = vec![
        panel("what it costs", "wall time [s]", 0, walls),
        panel("what is remembered", "rest angles, rms [degrees]", 1, sizes),
    ];
    let title = "No more than a scene needs: the draft T-shirt, folded thrice".into();
    Ok(Chart { name: "plan", table, figure: Figure { title, panels }, notes })
}
