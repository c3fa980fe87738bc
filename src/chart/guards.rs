//! `crease chart guards`: both guards of an event of memory, on crease recovery and on the paper's Table 1.
//!
//! The guard of the library bounds the energy of an element, `s C²`; an event may then raise its torque. The other bounds the torque,
//! `s C`. Table 2 under both: `crease chart readings`. Here all presets are pressed as in `crease chart recovery`, and strips fall as in
//! `crease chart strip` from the same starts without memory and with each guard, once as in a bake and once under BDF2 without damping,
//! where they rest late enough for events.

use crate::falling_strip::{Fall, Stepping, fall};
use crate::recovery::{published, recovery_angles};
use crate::statistics::mean;
use crate::{Axis, BLACK, Chart, ChartOptions, Figure, GREY, Mark, Panel, Series, Table};
use crease_model::error::Result;
use crease_model::fabric::{EventGuard, Fabric, PAPER_FABRIC};

/// Guards and their names.
const GUARDS: [(EventGuard, &str); 2] = [(EventGuard::Energy, "energy"), (EventGuard::Torque, "torque")];
/// Spacing of the pressed strip's mesh [m], hold and reading [s]: those of ISO 2313.
const PRESSED: (f64, f64, f64) = (0.005, 300.0, 300.0);
/// Points of the falling strips: the smaller two of Table 1.
const POINTS: [usize; 2] = [156, 603];
/// Ways to step, with their names.
const STEPPINGS: [(Stepping, &str); 2] =
    [(Stepping::Fixed, "strip"), (Stepping::Undamped, "strip, undamped")];

/// `fabric` with the guard.
fn guarded(fabric: &Fabric, guard: EventGuard) -> Fabric {
    let mut fabric = fabric.clone();
    fabric.memory.guard = guard;
    fabric
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let mut table = Table::new(&[
        "quantity",
        "guard",
        "fabric",
        "points",
        "value",
        "low",
        "high",
        "starts",
        "sooner",
        "later",
        "iterations",
    ]);
    let mut notes = Vec::new();
    let recovery = add_recovery(&mut table, &mut notes)?;
    let mut panels = vec![recovery];
    for (stepping, name) in STEPPINGS {
        panels.push(add_strips(stepping, name, options.runs.max(1), &mut table, &mut notes)?);
    }
    let title = "Guards of the events of memory".into();
    Ok(Chart { name: "guards", table, figure: Figure { title, panels }, notes })
}

/// Recovery angles of all presets under both guards.
fn add_recovery(table: &mut Table, notes: &mut Vec<String>) -> Result<Panel> {
    let (element, hold, read) = PRESSED;
    let names = Fabric::preset_names();
    let mut series = vec![Series::new("published range", GREY, Mark::Bars, Vec::new())];
    for (number, (guard, name)) in GUARDS.into_iter().enumerate() {
        let (mut points, mut inside, mut known) = (Vec::new(), 0, 0);
        for (row, preset) in names.iter().rev().enumerate() {
            let fabric = guarded(&Fabric::preset(preset)?, guard);
            let angle = recovery_angles(&fabric, element, hold, &[read])[0];
            let range = published(preset);
            known += u32::from(range.is_some());
            inside += u32::from(range.is_some_and(|[low, high]| (low..=high).contains(&angle)));
            points.push([angle, row as f64]);
            let [low, high] = [0, 1].map(|k| range.map(|r| r[k]));
            if number == 0 {
                series[0].points.extend(low.into_iter().chain(high).map(|angle| [angle, row as f64]));
            }
            table.push([
                "recovery".into(),
                name.into(),
                (*preset).into(),
                None::<u64>.into(),
                angle.into(),
                low.into(),
                high.into(),
            ]);
        }
        let mark = if number == 0 { Mark::Rings } else { Mark::Crosses };
        series.push(Series::new(&format!("guard on the {name}"), number, mark, points));
        notes.push(format!(
            "guard on the {name}: {inside} of {known} fabrics recover within their published range"
        ));
    }
    let y = Axis { names: names.iter().rev().map(|n| (*n).to_owned()).collect(), ..Axis::default() };
    Ok(Panel {
        title: "recovery after 300 s".into(),
        x: Axis::linear("recovery angle [degrees]").between(0.0, 180.0),
        y: y.between(-0.7, names.len() as f64 - 0.3),
        series,
    })
}

/// Times to rest of falling strips from `starts` tilts without memory and under both guards.
fn add_strips(
    stepping: Stepping,
    name: &str,
    starts: usize,
    table: &mut Table,
    notes: &mut Vec<String>,
) -> Result<Panel> {
    let fabric = Fabric::preset(PAPER_FABRIC)?;
    let mut series = vec![
        Series::new("no memory", BLACK, Mark::Dots, Vec::new()),
        Series::new("guard on the energy", 0, Mark::Rings, Vec::new()),
        Series::new("guard on the torque", 1, Mark::Crosses, Vec::new()),
    ];
    for points in POINTS {
        let run = |fabric: &Fabric, with_memory| -> Result<Vec<Fall>> {
            (0..starts).map(|start| fall(points, fabric, with_memory, start, stepping)).collect()
        };
        let without = run(&fabric, false)?;
        let mut row = |number: usize, guard: Option<&str>, falls: &[Fall]| {
            let (mean, summary) = summarise(falls, &without);
            series[number].points.extend(mean.map(|mean| [points as f64, mean]));
            let label = guard.map_or("no memory".into(), |guard| format!("guard on the {guard}"));
            notes
                .push(format!("{name} of {points} points, {label}: {}", summary.describe(mean, falls.len())));
            let times = || falls.iter().filter_map(|fall| fall.stabilised);
            table.push([
                name.into(),
                guard.into(),
                None::<&str>.into(),
                (points as u64).into(),
                mean.into(),
                times().reduce(f64::min).into(),
                times().reduce(f64::max).into(),
                (falls.len() as u64).into(),
                summary.sooner.into(),
                summary.later.into(),
                summary.iterations.into(),
            ]);
        };
        row(0, None, &without);
        for (number, (guard, label)) in GUARDS.into_iter().enumerate() {
            let falls = run(&guarded(&fabric, guard), true)?;
            row(number + 1, Some(label), &falls);
        }
    }
    Ok(Panel {
        title: name.into(),
        x: Axis::log("points").between(100.0, 1000.0),
        y: Axis::linear("mean time to rest [s]"),
        series,
    })
}

/// Falls compared with those without memory from the same starts.
#[derive(Debug, Clone, Copy)]
struct Compared {
    sooner: u64,
    later: u64,
    /// Mean number of global Newton iterations.
    iterations: f64,
}

impl Compared {
    fn describe(&self, mean: Option<f64>, starts: usize) -> String {
        let Self { sooner, later, iterations } = self;
        let mean = mean
            .map_or("not all at rest within 20 s".into(), |mean| format!("{mean:.2} s to rest in the mean"));
        format!(
            "{mean} of {starts} starts, {sooner} sooner and {later} later than without, {iterations:.0} iterations"
        )
    }
}

/// Mean time to rest [s], `None` if a strip did not come to rest, and the comparison with the falls `without` memory.
fn summarise(falls: &[Fall], without: &[Fall]) -> (Option<f64>, Compared) {
    let times: Option<Vec<f64>> = falls.iter().map(|fall| fall.stabilised).collect();
    let time = |fall: &Fall| fall.stabilised.unwrap_or(f64::INFINITY);
    let count = |is: fn(f64, f64) -> bool| {
        falls.iter().zip(without).filter(|(with, without)| is(time(with), time(without))).count() as u64
    };
    let iterations: Vec<f64> = falls.iter().map(|fall| fall.iterations as f64).collect();
    let compared =
        Compared { sooner: count(|a, b| a < b), later: count(|a, b| a > b), iterations: mean(&iterations) };
    (times.map(|times| mean(&times)), compared)
}
