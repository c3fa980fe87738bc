//! `crease chart plan`: what the plan of a bake saves: the draft T-shirt folded thrice with the models that `--explain`
//! chooses, and with everything on (the fabric's whole stretch stiffness, steps of 1/60 s throughout, every solve of the
//! whole garment).
//!
//! Compared are cost and the product: how much the garment remembers. Folds that begin in contact are decided by little,
//! so that two equally good bakes differ; each kind is baked from several shaken starts, and means are compared, with the
//! standard error of their difference beside it.

use crate::chart::accuracy::FoldThrice;
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table, median};
use crate::bake::BakeOptions;
use crate::error::Result;

/// The kinds of bakes that are compared.
fn kinds() -> [(&'static str, BakeOptions); 2] {
    let plan = BakeOptions::default();
    [("plan", plan.clone()), ("everything", BakeOptions { full_fidelity: true, ..plan })]
}

/// Several bakes of one kind.
#[derive(Default)]
struct Kind {
    /// One per bake: wall time [s], mean magnitude of what wear changed the rest angles by [degrees].
    walls: Vec<f64>,
    means: Vec<f64>,
}

impl Kind {
    fn mean(&self) -> f64 {
        mean_of(&self.means)
    }

    /// Standard error of the mean; not a number of less than two bakes.
    fn error(&self) -> f64 {
        let (count, mean) = (self.means.len() as f64, self.mean());
        let squares: f64 = self.means.iter().map(|m| (m - mean) * (m - mean)).sum();
        (squares / (count - 1.0) / count).sqrt()
    }

    fn wall(&self) -> f64 {
        median(self.walls.iter().copied()).unwrap_or(f64::NAN)
    }
}

fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let scene = FoldThrice::new()?;
    let mut table = Table::new(&[
        "scene",
        "plan",
        "start",
        "wall_s",
        "steps",
        "linear_solves",
        "rest_angle_mean_deg",
        "rest_angle_rms_deg",
    ]);
    let mut done = [Kind::default(), Kind::default()];
    // Kinds take turns, so that both meet the same machine.
    for start in 1..=options.runs.max(1) as u64 {
        for ((name, options), kind) in kinds().iter().zip(&mut done) {
            let run = scene.shaken(start).run(options)?;
            let mean = scene.rest_angle_mean(&run.baked).to_degrees();
            table.push([
                "fold-thrice".into(),
                (*name).into(),
                start.into(),
                run.wall.into(),
                run.baked.report.steps.into(),
                run.linear_solves.into(),
                mean.into(),
                scene.rest_angle_size(&run.baked).to_degrees().into(),
            ]);
            kind.walls.push(run.wall);
            kind.means.push(mean);
        }
    }
    let [plan, everything] = &done;
    let mut notes: Vec<String> = kinds().iter().zip(&done).map(|((name, _), kind)| note(name, kind)).collect();
    let apart = 100.0 * (plan.mean() / everything.mean() - 1.0);
    let unsure = 100.0 * plan.error().hypot(everything.error()) / everything.mean();
    notes.push(format!(
        "the plan remembers {apart:+.1} % (standard error {unsure:.1} %) of what everything does, {:.1} times as fast",
        everything.wall() / plan.wall()
    ));
    let panels = vec![
        panel("what it costs", "wall time [s]", 0, &[&plan.walls, &everything.walls]),
        panel("what is remembered", "mean change of rest angle [degrees]", 1, &[&plan.means, &everything.means]),
    ];
    let title = "No more than a scene needs: the draft T-shirt, folded thrice".into();
    Ok(Chart { name: "plan", table, figure: Figure { title, panels }, notes })
}

fn note(name: &str, kind: &Kind) -> String {
    format!(
        "{name}: {:.1} s, median of {} bakes; mean change of rest angle {:.2} degrees, standard error {:.2}",
        kind.wall(),
        kind.walls.len(),
        kind.mean(),
        kind.error()
    )
}

/// A bar up to each kind's mean, and a dot for each of its bakes.
fn panel(title: &str, label: &str, colour: usize, kinds: &[&Vec<f64>]) -> Panel {
    let top = kinds.iter().flat_map(|values| values.iter()).copied().fold(1e-9, f64::max);
    let (mut bars, mut dots) = (Vec::new(), Vec::new());
    for (place, values) in kinds.iter().enumerate() {
        let (place, mean) = (place as f64, mean_of(values));
        bars.extend([[place, 0.0], [place, mean]]);
        dots.extend(values.iter().map(|value| [place, *value]));
    }
    let names = Axis {
        names: self::kinds().iter().map(|(name, _)| (*name).to_owned()).collect(),
        range: Some([-0.5, kinds.len() as f64 - 0.5]),
        ..Axis::default()
    };
    Panel {
        title: title.into(),
        x: names,
        y: Axis::of(label).between(0.0, 1.1 * top),
        series: vec![
            Series::new("", colour, Mark::Bars, bars),
            Series::new("one bake each", 2, Mark::Dots, dots),
        ],
    }
}
