//! `crease chart front`: error of what is baked over wall time, for every quality and for single settings around the default.
//!
//! The T-shirt of 13,863 points is folded thrice in the default fabric, from several perturbed initial conditions (starts). The error of
//! a setting is the difference of its field of changed curvature (`curvature_field`) to that of the reference quality from
//! the same start, over the field of the reference, both root mean squares. The error of the reference is the same between its own
//! starts, its scatter: no setting can come below it. The systematic error is what is left of the error without the scatter of both,
//!
//! ```text
//! systematic^2 = error^2 - (scatter^2 + reference scatter^2) / 2     (means over all pairs of starts, as if independent)
//! ```
//!
//! which is how far the mean of many bakes with a setting is from the mean of many references.

use crate::bake::{BakeOptions, Quality};
use crate::chart::curvature_field::CurvatureField;
use crate::chart::fold_thrice::{FOLD_THRICE, FoldThrice};
use crate::chart::statistics::{mean, median, standard_error};
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crate::error::Result;
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::sim::{Method, Sewing};

/// Group of the qualities, the first in the legend.
const QUALITIES: &str = "quality";

/// A setting: its group, its name in the table and its options.
type Setting = (&'static str, String, BakeOptions);

/// Cost and fields of a setting, one of each per start.
#[derive(Default)]
struct Bakes {
    walls: Vec<f64>,
    fields: Vec<CurvatureField>,
    failed: bool,
}

/// Cost and errors of a setting. Errors are relative to the field of the reference [-], not a number where there are too few starts.
struct Outcome {
    walls: Vec<f64>,
    /// Differences to the reference from the same start.
    errors: Vec<f64>,
    systematic: f64,
    /// Root mean square of the field over that of the reference [-], per start.
    amounts: Vec<f64>,
    failed: bool,
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let scene = FoldThrice::tshirt()?.in_fabric(Fabric::preset(DEFAULT_FABRIC)?);
    let starts: Vec<FoldThrice> =
        (1..=options.runs.max(1) as u64).map(|seed| scene.perturbed(seed)).collect();
    let reference = Bakes::new(&scene, &starts, &BakeOptions::for_quality(Quality::Reference))?;
    let mut table = Table::new(&[
        "scene",
        "group",
        "setting",
        "wall_s",
        "field_error",
        "field_error_standard_error",
        "field_error_systematic",
        "field_over_reference",
        "starts",
        "failed",
    ]);
    let mut outcomes = vec![(QUALITIES, "reference".to_owned(), Outcome::of_reference(&reference))];
    for (group, name, settings) in settings() {
        let outcome = Outcome::new(Bakes::new(&scene, &starts, &settings)?, &reference);
        outcomes.push((group, name, outcome));
    }
    for (group, name, outcome) in &outcomes {
        table.push([
            FOLD_THRICE.into(),
            (*group).into(),
            name.as_str().into(),
            outcome.wall().into(),
            mean(&outcome.errors).into(),
            standard_error(&outcome.errors).into(),
            outcome.systematic.into(),
            mean(&outcome.amounts).into(),
            (outcome.walls.len() as u64).into(),
            outcome.failed.into(),
        ]);
    }
    let notes = outcomes.iter().map(|(group, name, outcome)| outcome.note(group, name)).collect();
    let panel = Panel {
        title: "T-shirt of 13,863 points, folded thrice".to_owned(),
        x: Axis::linear("wall time [s]"),
        y: Axis::log("error of the field of memory, rms over rms [-]"),
        series: series_of(&outcomes),
    };
    let title = "Error of what is baked over wall time".into();
    Ok(Chart { name: "front", table, figure: Figure { title, panels: vec![panel] }, notes })
}

impl Bakes {
    fn new(scene: &FoldThrice, starts: &[FoldThrice], options: &BakeOptions) -> Result<Self> {
        let mut bakes = Self::default();
        for start in starts {
            let run = start.run(options)?;
            bakes.walls.push(run.wall);
            bakes.fields.push(scene.field(&run.baked));
            bakes.failed |= run.baked.report.not_performed.is_some() || scene.has_intersections(&run.baked);
        }
        Ok(bakes)
    }

    /// Mean square of the fields [1/m^2].
    fn mean_square(&self) -> f64 {
        mean(&self.fields.iter().map(|field| field.rms().powi(2)).collect::<Vec<_>>())
    }

    /// Mean square difference of two starts [1/m^2]; not a number for one.
    fn scatter(&self) -> f64 {
        let fields = &self.fields;
        let pairs = (0..fields.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let squares: Vec<f64> = pairs.map(|(i, j)| fields[i].difference(&fields[j]).powi(2)).collect();
        if squares.is_empty() { f64::NAN } else { mean(&squares) }
    }
}

impl Outcome {
    fn new(bakes: Bakes, reference: &Bakes) -> Self {
        let pairs = || bakes.fields.iter().zip(&reference.fields);
        let of_all =
            bakes.fields.iter().flat_map(|own| reference.fields.iter().map(|other| own.difference(other)));
        let squares: Vec<f64> = of_all.map(|difference: f64| difference.powi(2)).collect();
        let without_scatter = mean(&squares) - 0.5 * (bakes.scatter() + reference.scatter());
        Self {
            errors: pairs().map(|(own, reference)| own.difference(reference) / reference.rms()).collect(),
            // Not a number stays one.
            systematic: (without_scatter.clamp(0.0, f64::INFINITY) / reference.mean_square()).sqrt(),
            amounts: pairs().map(|(own, reference)| own.rms() / reference.rms()).collect(),
            walls: bakes.walls,
            failed: bakes.failed,
        }
    }

    /// The reference itself: its error is the scatter of its starts.
    fn of_reference(reference: &Bakes) -> Self {
        Self {
            walls: reference.walls.clone(),
            errors: vec![(reference.scatter() / reference.mean_square()).sqrt()],
            systematic: 0.0,
            amounts: vec![1.0],
            failed: reference.failed,
        }
    }

    fn wall(&self) -> f64 {
        median(self.walls.iter().copied()).unwrap_or(f64::NAN)
    }

    fn note(&self, group: &str, name: &str) -> String {
        format!(
            "{group}, {name}: {:.1} s; error {:.2} (standard error {:.2}, {} starts), systematic {:.2}, field {:.2} times the reference's{}",
            self.wall(),
            mean(&self.errors),
            standard_error(&self.errors),
            self.walls.len(),
            self.systematic,
            mean(&self.amounts),
            if self.failed { "; FAILED" } else { "" }
        )
    }
}

/// The qualities, and the default with one setting changed.
fn settings() -> Vec<Setting> {
    let with = |change: &dyn Fn(&mut BakeOptions)| {
        let mut options = BakeOptions::default();
        change(&mut options);
        options
    };
    let mut all: Vec<Setting> = [Quality::Draft, Quality::Standard]
        .map(|quality| (QUALITIES, quality.name().to_owned(), BakeOptions::for_quality(quality)))
        .into();
    for mm in [8.0, 16.0, 24.0] {
        all.push(("edges", format!("{mm} mm"), with(&|o| o.finest_edge = 1e-3 * mm)));
    }
    all.push(("tolerances", "energy tolerance times 10".to_owned(), with(&|o| o.energy_tol_m *= 10.0)));
    let short = |o: &mut BakeOptions| {
        o.step.min_dt *= 0.25;
        o.step.local_error_tol *= 0.25;
    };
    all.push(("tolerances", "shortest step and error times 0.25".to_owned(), with(&short)));
    let late = |o: &mut BakeOptions| o.event_dt_fraction *= 2.5;
    all.push(("tolerances", "steps after events times 2.5".to_owned(), with(&late)));
    all.push(("models", "no hems, no double seams".to_owned(), with(&|o| o.sewing = Sewing::NONE)));
    for method in [Method::BackwardEulerOnce, Method::Bdf2] {
        all.push(("integrators", method.name().to_owned(), with(&|o| o.step.method = method)));
    }
    all
}

/// One series a group: its settings as dots, failures as crosses.
fn series_of(outcomes: &[(&str, String, Outcome)]) -> Vec<Series> {
    let mut groups: Vec<&str> = Vec::new();
    for (group, ..) in outcomes {
        if !groups.contains(group) {
            groups.push(group);
        }
    }
    let mut series = Vec::new();
    for (colour, group) in groups.iter().enumerate() {
        let of = |failed: bool| {
            outcomes
                .iter()
                .filter(|(own, _, outcome)| own == group && outcome.failed == failed)
                .map(|(.., outcome)| [outcome.wall(), mean(&outcome.errors)])
                .filter(|dot| dot[1].is_finite())
                .collect::<Vec<_>>()
        };
        series.push(Series::new(group, colour, Mark::Dots, of(false)));
        series.push(Series::new("", colour, Mark::Crosses, of(true)));
    }
    series
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::curvature_field::tests::creased_strip;

    #[test]
    fn the_systematic_error_is_what_scatter_does_not_explain() {
        let bakes = |creases: [(f64, f64); 2]| Bakes {
            walls: vec![1.0; 2],
            fields: creases.map(|crease| creased_strip(&[crease])).into(),
            failed: false,
        };
        let weaker = Outcome::new(bakes([(0.15, 0.9); 2]), &bakes([(0.15, 1.0); 2]));
        assert!((weaker.systematic - 0.1).abs() < 1e-6, "{}", weaker.systematic);
        assert!((mean(&weaker.errors) - 0.1).abs() < 1e-6);
        // Creases anywhere: every start differs from every other by as much.
        let anywhere = Outcome::new(bakes([(0.05, 1.0), (0.25, 1.0)]), &bakes([(0.11, 1.0), (0.19, 1.0)]));
        assert!(mean(&anywhere.errors) > 1.2 && anywhere.systematic < 0.2, "{}", anywhere.systematic);
    }
}
