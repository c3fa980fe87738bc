//! `crease chart plan`: cost and effect of model reduction: the T-shirt of 2,000 points, folded thrice, with the
//! models that `--explain` lists, and at full fidelity (the fabric's full stretch stiffness, steps of 1/60 s
//! throughout, every solve global).
//!
//! Compared are wall time and the amount of memory. Folds that begin in contact are sensitive to their initial
//! condition, so that two equally accurate bakes differ: each variant is baked from several perturbed initial
//! conditions (replicates), and their means are compared, with the standard error of the difference.

use crate::bake::BakeOptions;
use crate::chart::fold_thrice::{FOLD_THRICE, FoldThrice};
use crate::chart::statistics::{mean, median, standard_error};
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::error::Result;

/// Replicates of one variant.
struct Variant {
    /// Name in the table.
    name: &'static str,
    options: BakeOptions,
    /// Wall time of every replicate [s].
    walls: Vec<f64>,
    /// Mean magnitude of the change of the rest angles of every replicate [degrees].
    memories: Vec<f64>,
}

impl Variant {
    fn new(name: &'static str, options: BakeOptions) -> Self {
        Self { name, options, walls: Vec::new(), memories: Vec::new() }
    }

    fn median_wall(&self) -> f64 {
        median(self.walls.iter().copied()).unwrap_or(f64::NAN)
    }

    fn note(&self) -> String {
        format!(
            "{}: {:.1} s, median of {} bakes; mean change of rest angle {:.2} degrees, standard error {:.2}",
            self.name,
            self.median_wall(),
            self.walls.len(),
            mean(&self.memories),
            standard_error(&self.memories)
        )
    }
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let scene = FoldThrice::tshirt_draft()?;
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
    let reduced = BakeOptions::default();
    let full = BakeOptions { full_fidelity: true, ..reduced.clone() };
    let mut variants = [Variant::new("plan", reduced), Variant::new("everything", full)];
    // The variants alternate, so that both run on the machine in the same state.
    for start in 1..=options.runs.max(1) as u64 {
        for variant in &mut variants {
            let run = scene.perturbed(start).run(&variant.options)?;
            let memory = scene.rest_angle_mean(&run.baked).to_degrees();
            table.push([
                FOLD_THRICE.into(),
                variant.name.into(),
                start.into(),
                run.wall.into(),
                run.baked.report.steps.into(),
                run.linear_solves.into(),
                memory.into(),
                scene.rest_angle_rms(&run.baked).to_degrees().into(),
            ]);
            variant.walls.push(run.wall);
            variant.memories.push(memory);
        }
    }
    let mut notes: Vec<String> = variants.iter().map(Variant::note).collect();
    notes.push(comparison(&variants));
    let panels = vec![
        panel("wall time", "wall time [s]", 0, &variants, |variant| &variant.walls),
        panel("amount of memory", "mean change of rest angle [degrees]", 1, &variants, |variant| {
            &variant.memories
        }),
    ];
    let title = "Cost and effect of model reduction: tshirt-draft, folded thrice".into();
    Ok(Chart { name: "plan", table, figure: Figure { title, panels }, notes })
}

/// Difference of the amounts of memory, and speed-up, in words.
fn comparison([reduced, full]: &[Variant; 2]) -> String {
    let full_mean = mean(&full.memories);
    let difference = 100.0 * (mean(&reduced.memories) / full_mean - 1.0);
    let error = 100.0 * standard_error(&reduced.memories).hypot(standard_error(&full.memories)) / full_mean;
    format!(
        "amount of memory with the plan over that at full fidelity: {difference:+.1} % (standard error {error:.1} %), {:.1} times as fast",
        full.median_wall() / reduced.median_wall()
    )
}

/// A bar up to the mean of each variant, and a dot for each of its replicates.
fn panel(
    title: &str,
    label: &str,
    colour: usize,
    variants: &[Variant],
    values: fn(&Variant) -> &Vec<f64>,
) -> Panel {
    let highest = variants.iter().flat_map(values).copied().fold(1e-9, f64::max);
    let (mut bars, mut dots) = (Vec::new(), Vec::new());
    for (column, variant) in variants.iter().enumerate() {
        let column = column as f64;
        bars.extend([[column, 0.0], [column, mean(values(variant))]]);
        dots.extend(values(variant).iter().map(|value| [column, *value]));
    }
    let names = Axis {
        names: variants.iter().map(|variant| variant.name.to_owned()).collect(),
        range: Some([-0.5, variants.len() as f64 - 0.5]),
        ..Axis::default()
    };
    Panel {
        title: title.into(),
        x: names,
        y: Axis::linear(label).between(0.0, 1.1 * highest),
        series: vec![
            Series::new("", colour, Mark::Bars, bars),
            Series::new("replicates", 2, Mark::Dots, dots),
        ],
    }
}
