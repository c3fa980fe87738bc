//! `crease chart plan`: cost and effect of the models that `--explain` lists: the T-shirt of 2,000 points, folded thrice, with the default
//! plan and with single models changed, up to full fidelity (the fabric's full stretch stiffness, steps of 1/60 s throughout, every solve
//! global, the file's own triangles).
//!
//! Compared are wall time and the field of memory (`curvature_field`) with that of the plan from the same perturbed initial condition
//! (start). Two starts of the plan differ, too: the scatter, below which no difference says anything.

use crate::bake_scene::{BakeScene, FOLD_THRICE};
use crate::curvature_field::{CurvatureField, scatter};
use crate::statistics::{mean, median};
use crate::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crease::internal::bake::BakeOptions;
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_solver::sim::Sewing;

/// Bakes of one variant.
struct Variant {
    /// Name in the table.
    name: &'static str,
    options: BakeOptions,
    /// Wall time of every start [s].
    walls: Vec<f64>,
    /// Difference of the field to that of the plan, over the plan's, of every start [-].
    differences: Vec<f64>,
    /// Root mean square of the field over that of the plan, of every start [-].
    amounts: Vec<f64>,
}

impl Variant {
    fn new(name: &'static str, change: impl Fn(&mut BakeOptions)) -> Self {
        let mut options = BakeOptions::default();
        change(&mut options);
        Self { name, options, walls: Vec::new(), differences: Vec::new(), amounts: Vec::new() }
    }

    fn note(&self) -> String {
        format!(
            "{}: {:.1} s, median of {} bakes; field {:.2} times the plan's, difference {:.2}",
            self.name,
            median(self.walls.iter().copied()).unwrap_or(f64::NAN),
            self.walls.len(),
            mean(&self.amounts),
            mean(&self.differences)
        )
    }
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let scene = BakeScene::tshirt_draft()?.in_fabric(Fabric::preset(DEFAULT_FABRIC)?);
    let mut table = Table::new(&[
        "scene",
        "plan",
        "start",
        "wall_s",
        "steps",
        "linear_solves",
        "field_over_plan",
        "field_difference",
    ]);
    // The plan comes first: the others are compared with it.
    let mut variants = [
        Variant::new("plan", |_| {}),
        Variant::new("unsewn", |options| options.sewing = Sewing::NONE),
        Variant::new("own triangles", |options| options.own_triangles = true),
        Variant::new("full fidelity", |options| options.full_fidelity = true),
    ];
    let mut of_plan: Vec<CurvatureField> = Vec::new();
    // The variants alternate, so that all run on the machine in the same state.
    for start in 1..=options.runs.max(1) as u64 {
        for variant in &mut variants {
            let run = scene.perturbed(start).run(&variant.options)?;
            let field = scene.field(&run.baked);
            let plan = of_plan.get(start as usize - 1).unwrap_or(&field);
            let [amount, difference] = [field.rms(), field.difference(plan)].map(|value| value / plan.rms());
            table.push([
                FOLD_THRICE.into(),
                variant.name.into(),
                start.into(),
                run.wall.into(),
                run.baked.report.steps.into(),
                run.linear_solves.into(),
                amount.into(),
                difference.into(),
            ]);
            variant.walls.push(run.wall);
            variant.amounts.push(amount);
            variant.differences.push(difference);
            if of_plan.len() < start as usize {
                of_plan.push(field);
            }
        }
    }
    let mut notes: Vec<String> = variants.iter().map(Variant::note).collect();
    let scatter = scatter(&of_plan);
    if !scatter.is_empty() {
        notes.push(format!("two starts of the plan: difference {:.2}", mean(&scatter)));
    }
    let panels = vec![
        panel("wall time", "wall time [s]", 0, &variants, |variant| &variant.walls),
        panel("memory", "difference of the field to the plan's [-]", 1, &variants, |variant| {
            &variant.differences
        }),
    ];
    let title = "Cost and effect of the models: tshirt-draft, folded thrice".into();
    Ok(Chart { name: "plan", table, figure: Figure { title, panels }, notes })
}

/// A bar up to the mean of each variant, and a dot for each of its starts.
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
        series: vec![Series::new("", colour, Mark::Bars, bars), Series::new("starts", 2, Mark::Dots, dots)],
    }
}
