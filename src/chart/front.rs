//! `crease chart front`: error of what is baked over wall time, for every quality and for single settings around the default.
//!
//! Two T-shirts are folded thrice, an elbow is bent, a handkerchief crumpled and a strip falls, in the default fabric, each from several perturbed
//! initial conditions (starts). The error of a setting is the difference of what is remembered to that of the reference quality from the same start,
//! over that of the reference: of the field of changed curvature (`curvature_field`), where folds lie elsewhere each time, at an elbow, in
//! crumpled cloth and in a heap, of its spectrum (`spectrum`), and of the net angles across the folds (`net_angles`), all root mean squares. The error of the reference
//! is the same between its own starts, its scatter: no setting can come below it. The systematic error is what is left of the error without
//! the scatter of both,
//!
//! ```text
//! systematic^2 = error^2 - (scatter^2 + reference scatter^2) / 2     (means over all pairs of starts, as if independent)
//! ```
//!
//! which is how far the mean of many bakes with a setting is from the mean of many references. The T-shirt of 13,863 points is baked with
//! every setting, the other scenes with every quality and length of edges (`--full`: with every setting).

use crate::bake_scene::{BakeScene, FOLD_THRICE};
use crate::comparison::BACKWARD_EULER_ONCE;
use crate::curvature_field::CurvatureField;
use crate::net_angles::{FOLD_THRICE_LINES, net_angles};
use crate::spectrum::Spectrum;
use crate::statistics::{mean, median, standard_error};
use crate::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crease::internal::bake::{BakeOptions, BakeResult, Quality};
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_solver::sim::{Method, Sewing, StepOptions};

/// Group of the qualities, the first in the legend.
const QUALITIES: &str = "quality";
/// Group of the lengths of edges.
const EDGES: &str = "edges";

/// A setting: its group, its name in the table and its options.
type Setting = (&'static str, String, BakeOptions);

/// What is compared of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Compared {
    /// The field of changed curvature, and the net angles across the lines of `fold-thrice`.
    Folds,
    /// The spectrum of the field.
    Spectrum,
}

/// A scene of the chart.
struct FrontScene {
    /// Name in the table.
    name: &'static str,
    title: &'static str,
    scene: BakeScene,
    compared: Compared,
    /// Whether all settings are varied, not only quality and edges.
    all_settings: bool,
}

/// What a bake left.
enum Remembered {
    Field(CurvatureField),
    Spectrum(Spectrum),
}

impl Remembered {
    /// Root mean square [1/m].
    fn rms(&self) -> f64 {
        match self {
            Self::Field(field) => field.rms(),
            Self::Spectrum(spectrum) => spectrum.rms(),
        }
    }

    /// Root mean square difference to that of another bake of the same scene [1/m].
    fn difference(&self, other: &Self) -> f64 {
        match (self, other) {
            (Self::Field(own), Self::Field(other)) => own.difference(other),
            (Self::Spectrum(own), Self::Spectrum(other)) => own.difference(other),
            _ => f64::NAN,
        }
    }
}

/// Cost and memory of a setting, one of each per start.
#[derive(Default)]
struct Bakes {
    walls: Vec<f64>,
    fields: Vec<Remembered>,
    /// Net angles across the folds [rad m].
    angles: Vec<Vec<f64>>,
    failed: bool,
}

/// Cost and errors of a setting. Errors are relative to what the reference remembers [-], not a number where there are too few starts.
struct Outcome {
    walls: Vec<f64>,
    /// Differences to the reference from the same start.
    errors: Vec<f64>,
    systematic: f64,
    /// Differences of the net angles to those of the reference from the same start; empty without folds.
    angle_errors: Vec<f64>,
    /// Root mean square of the field over that of the reference [-], per start.
    amounts: Vec<f64>,
    failed: bool,
}

/// A setting with its outcome: group, name and outcome.
type Tried = (&'static str, String, Outcome);

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
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
        "angle_error",
    ]);
    let (mut notes, mut panels) = (Vec::new(), Vec::new());
    for scene in scenes()? {
        let outcomes = scene.outcomes(options)?;
        for (group, name, outcome) in &outcomes {
            let angle_error = (!outcome.angle_errors.is_empty()).then(|| mean(&outcome.angle_errors));
            table.push([
                scene.name.into(),
                (*group).into(),
                name.as_str().into(),
                outcome.wall().into(),
                mean(&outcome.errors).into(),
                standard_error(&outcome.errors).into(),
                outcome.systematic.into(),
                mean(&outcome.amounts).into(),
                (outcome.walls.len() as u64).into(),
                outcome.failed.into(),
                angle_error.into(),
            ]);
        }
        let note = |(group, name, outcome): &Tried| format!("{}: {}", scene.name, outcome.note(group, name));
        notes.extend(outcomes.iter().map(note));
        let of = if scene.compared == Compared::Spectrum { "spectrum" } else { "field" };
        panels.push(Panel {
            title: scene.title.to_owned(),
            x: Axis::linear("wall time [s]"),
            y: Axis::log(&format!("error of the {of} of memory, rms over rms [-]")),
            series: series_of(&outcomes),
        });
    }
    let title = "Error of what is baked over wall time".into();
    Ok(Chart { name: "front", table, figure: Figure { title, panels }, notes })
}

/// The scenes, the one with all settings first.
fn scenes() -> Result<[FrontScene; 5]> {
    let scene = |name, title, scene: Result<BakeScene>, compared, all_settings| {
        let scene = scene?.in_fabric(Fabric::preset(DEFAULT_FABRIC)?);
        Ok(FrontScene { name, title, scene, compared, all_settings })
    };
    let (full, draft) = (BakeScene::tshirt(), BakeScene::tshirt_draft());
    let (elbow, crumpled, strip) = (BakeScene::elbow(), BakeScene::crumpled(), BakeScene::falling_strip());
    Ok([
        scene(FOLD_THRICE, "T-shirt of 13,863 points, folded thrice", full, Compared::Folds, true)?,
        scene("fold-thrice, draft mesh", "T-shirt of 1,999 points", draft, Compared::Folds, false)?,
        scene("elbow, one bend", "Sleeve, bent once", elbow, Compared::Spectrum, false)?,
        scene("crumple", "Handkerchief, crumpled", crumpled, Compared::Spectrum, false)?,
        scene("falling strip", "Strip of 2,306 points, fallen", strip, Compared::Spectrum, false)?,
    ])
}

impl FrontScene {
    /// Bakes the scene with all settings; the reference is first.
    fn outcomes(&self, options: &ChartOptions) -> Result<Vec<Tried>> {
        let starts: Vec<BakeScene> =
            (1..=options.runs.max(1) as u64).map(|seed| self.scene.perturbed(seed)).collect();
        let reference = self.bakes(&starts, &BakeOptions::of_quality(Quality::Reference))?;
        let mut outcomes = vec![(QUALITIES, "reference".to_owned(), Outcome::of_reference(&reference))];
        for (group, name, settings) in settings() {
            if self.all_settings || options.full || [QUALITIES, EDGES].contains(&group) {
                outcomes.push((group, name, Outcome::new(self.bakes(&starts, &settings)?, &reference)));
            }
        }
        Ok(outcomes)
    }

    fn bakes(&self, starts: &[BakeScene], options: &BakeOptions) -> Result<Bakes> {
        let mut bakes = Bakes::default();
        for start in starts {
            let run = start.run(options)?;
            bakes.walls.push(run.wall);
            bakes.failed |= run.baked.report.not_performed.is_some() || start.has_intersections(&run.baked);
            bakes.fields.push(self.remembered(&run.baked));
            if self.compared == Compared::Folds {
                let (garment, memory) = (self.scene.garment(), &run.baked.worn.memory);
                bakes.angles.push(net_angles(garment, memory, &FOLD_THRICE_LINES));
            }
        }
        Ok(bakes)
    }

    fn remembered(&self, baked: &BakeResult) -> Remembered {
        match self.compared {
            Compared::Folds => Remembered::Field(self.scene.field(baked)),
            Compared::Spectrum => {
                Remembered::Spectrum(Spectrum::new(self.scene.garment(), &baked.worn.memory))
            }
        }
    }
}

impl Bakes {
    /// Mean square of what is remembered [1/m^2].
    fn mean_square(&self) -> f64 {
        mean(&self.fields.iter().map(|field| field.rms().powi(2)).collect::<Vec<_>>())
    }

    /// Mean square difference of two starts [1/m^2]; not a number for one.
    fn scatter(&self) -> f64 {
        let fields = &self.fields;
        let squares: Vec<f64> =
            pairs(fields.len()).map(|(i, j)| fields[i].difference(&fields[j]).powi(2)).collect();
        if squares.is_empty() { f64::NAN } else { mean(&squares) }
    }
}

/// Pairs of different numbers below `count`.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|i| (0..i).map(move |j| (i, j)))
}

/// Returns the difference of net angles `own` to those of the `reference`, over the reference, both root mean squares [-].
fn angle_error(own: &[f64], reference: &[f64]) -> f64 {
    let squares = |of: &dyn Fn(usize) -> f64| (0..reference.len()).map(|k| of(k).powi(2)).sum::<f64>();
    (squares(&|k| own[k] - reference[k]) / squares(&|k| reference[k])).sqrt()
}

impl Outcome {
    fn new(bakes: Bakes, reference: &Bakes) -> Self {
        let pairs = || bakes.fields.iter().zip(&reference.fields);
        let of_all =
            bakes.fields.iter().flat_map(|own| reference.fields.iter().map(|other| own.difference(other)));
        let squares: Vec<f64> = of_all.map(|difference: f64| difference.powi(2)).collect();
        let without_scatter = mean(&squares) - 0.5 * (bakes.scatter() + reference.scatter());
        let angles = bakes.angles.iter().zip(&reference.angles);
        Self {
            errors: pairs().map(|(own, reference)| own.difference(reference) / reference.rms()).collect(),
            // Not a number stays one.
            systematic: (without_scatter.clamp(0.0, f64::INFINITY) / reference.mean_square()).sqrt(),
            angle_errors: angles.map(|(own, reference)| angle_error(own, reference)).collect(),
            amounts: pairs().map(|(own, reference)| own.rms() / reference.rms()).collect(),
            walls: bakes.walls,
            failed: bakes.failed,
        }
    }

    /// The reference itself: its error is the scatter of its starts.
    fn of_reference(reference: &Bakes) -> Self {
        let angles = &reference.angles;
        Self {
            walls: reference.walls.clone(),
            errors: vec![(reference.scatter() / reference.mean_square()).sqrt()],
            systematic: 0.0,
            angle_errors: pairs(angles.len()).map(|(i, j)| angle_error(&angles[i], &angles[j])).collect(),
            amounts: vec![1.0],
            failed: reference.failed,
        }
    }

    fn wall(&self) -> f64 {
        median(self.walls.iter().copied()).unwrap_or(f64::NAN)
    }

    fn note(&self, group: &str, name: &str) -> String {
        let angles = match mean(&self.angle_errors) {
            _ if self.angle_errors.is_empty() => String::new(),
            error => format!(", net angles {error:.2}"),
        };
        format!(
            "{group}, {name}: {:.1} s; error {:.2} (standard error {:.2}, {} starts), systematic {:.2}, {:.2} times the reference's{angles}{}",
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
        .map(|quality| (QUALITIES, quality.name().to_owned(), with(&|o| o.quality = quality)))
        .into();
    for mm in [8.0, 16.0, 24.0] {
        all.push((EDGES, format!("{mm} mm"), with(&|o| o.finest_edge = Some(1e-3 * mm))));
    }
    all.push((
        "tolerances",
        "energy tolerance times 10".to_owned(),
        with(&|o| o.energy_tol_m = Some(10.0 * o.energy_tol_m())),
    ));
    let short = |o: &mut BakeOptions| {
        let step = o.step();
        let (min_dt, local_error_tol) = (0.25 * step.min_dt, 0.25 * step.local_error_tol);
        o.step = Some(StepOptions { min_dt, local_error_tol, ..step });
    };
    all.push(("tolerances", "shortest step and error times 0.25".to_owned(), with(&short)));
    let late = |o: &mut BakeOptions| o.event_dt_fraction = Some(2.5 * o.event_dt_fraction());
    all.push(("tolerances", "steps after events times 2.5".to_owned(), with(&late)));
    all.push(("models", "no hems, no double seams".to_owned(), with(&|o| o.sewing = Sewing::NONE)));
    for method in [BACKWARD_EULER_ONCE, Method::Bdf2] {
        all.push((
            "integrators",
            method.name().to_owned(),
            with(&|o| o.step = Some(StepOptions { method, ..o.step() })),
        ));
    }
    all
}

/// One series a group: its settings as dots, failures as crosses. Qualities, edges and failures have their names beside them.
fn series_of(outcomes: &[Tried]) -> Vec<Series> {
    let mut groups: Vec<&str> = Vec::new();
    for (group, ..) in outcomes {
        if !groups.contains(group) {
            groups.push(group);
        }
    }
    let mut series = Vec::new();
    for (colour, group) in groups.iter().enumerate() {
        for (failed, name, mark) in [(false, *group, Mark::Dots), (true, "", Mark::Crosses)] {
            let (points, names): (Vec<_>, Vec<_>) = outcomes
                .iter()
                .filter(|(own, _, outcome)| own == group && outcome.failed == failed)
                .map(|(_, name, outcome)| ([outcome.wall(), mean(&outcome.errors)], name.clone()))
                .filter(|(point, _)| point[1].is_finite())
                .unzip();
            let is_named = failed || [QUALITIES, EDGES].contains(group);
            let labels = if is_named { names } else { Vec::new() };
            series.push(Series::new(name, colour, mark, points).with_labels(labels));
        }
    }
    series
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature_field::tests::creased_strip;

    #[test]
    fn the_systematic_error_is_what_scatter_does_not_explain() {
        let bakes = |creases: [(f64, f64); 2]| Bakes {
            walls: vec![1.0; 2],
            fields: creases.map(|crease| Remembered::Field(creased_strip(&[crease]))).into(),
            angles: creases.map(|(_, angle)| vec![angle, -angle]).into(),
            failed: false,
        };
        let weaker = Outcome::new(bakes([(0.15, 0.9); 2]), &bakes([(0.15, 1.0); 2]));
        assert!((weaker.systematic - 0.1).abs() < 1e-6, "{}", weaker.systematic);
        assert!((mean(&weaker.errors) - 0.1).abs() < 1e-6);
        assert!((mean(&weaker.angle_errors) - 0.1).abs() < 1e-6);
        // Creases anywhere: every start differs from every other by as much.
        let anywhere = Outcome::new(bakes([(0.05, 1.0), (0.25, 1.0)]), &bakes([(0.11, 1.0), (0.19, 1.0)]));
        assert!(mean(&anywhere.errors) > 1.2 && anywhere.systematic < 0.2, "{}", anywhere.systematic);
    }
}
