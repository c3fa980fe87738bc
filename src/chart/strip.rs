//! `crease chart strip`: time to rest of falling strips, with and without memory, compared with the paper's Table 1.
//!
//! Strips of 156, 603 and 2306 points (within 2 %, `falling_strip.rs`) fall with fixed steps of 1/60 s, so that the
//! number of steps is the simulated time. (`crease chart speed` uses adaptive ones.)
//!
//! A falling strip is chaotic: one degree of tilt changes the time to rest by a third, with memory or without. So
//! every run has its own initial tilt, the same ones with and without memory, and the chart shows medians.

use crate::falling_strip::{
    FALLING_STRIP_POINTS, FIRST_TILT, Fall, REST_DURATION, REST_RESIDUAL, Stepping, fall, tilted_strip,
};
use crate::statistics::median;
use crate::{Axis, BLACK, Chart, ChartOptions, Figure, Mark, Panel, Series, Table};
use crease_model::error::Result;
use crease_model::fabric::{Fabric, PAPER_FABRIC};

/// Times to rest that the paper reports for a mesh [s].
#[derive(Debug, Clone, Copy)]
struct PaperTimes {
    without_memory: f64,
    with_memory: f64,
}

/// The paper's times, one per mesh of [`FALLING_STRIP_POINTS`], where known.
const PAPER: [Option<PaperTimes>; 3] = [
    Some(PaperTimes { without_memory: 9.0, with_memory: 7.0 }),
    None,
    Some(PaperTimes { without_memory: 94.0, with_memory: 83.0 }),
];

const COLUMNS: &[&str] = &[
    "points",
    "memory",
    "stabilised_s",
    "wall_s",
    "steps",
    "steps_fewest",
    "steps_most",
    "iterations",
    "events",
    "paper_s",
];

/// The falls from all initial tilts with and without memory, sorted by their number of steps.
struct Falls {
    points: usize,
    with_memory: bool,
    falls: Vec<Fall>,
}

impl Falls {
    fn run(points: usize, fabric: &Fabric, with_memory: bool, runs: usize) -> Result<Self> {
        let mut falls: Vec<Fall> = (0..runs.max(1))
            .map(|run| fall(points, fabric, with_memory, run, Stepping::Fixed))
            .collect::<Result<_>>()?;
        falls.sort_by_key(|f| f.steps);
        Ok(Self { points: tilted_strip(points, FIRST_TILT)?.points.len(), with_memory, falls })
    }

    /// Median time to rest [s]; `None` if a strip did not come to rest.
    fn stabilised(&self) -> Option<f64> {
        let all = self.falls.iter().map(|f| f.stabilised).collect::<Option<Vec<f64>>>();
        all.and_then(|all| median(all.into_iter()))
    }

    /// Median number of steps to rest.
    fn steps(&self) -> u64 {
        median(self.falls.iter().map(|f| f.steps)).unwrap_or(0)
    }

    fn push_row(&self, table: &mut Table, paper: Option<PaperTimes>) {
        table.push([
            (self.points as u64).into(),
            self.with_memory.into(),
            self.stabilised().into(),
            median(self.falls.iter().map(|f| f.wall)).into(),
            self.steps().into(),
            self.falls.first().map(|f| f.steps).into(),
            self.falls.last().map(|f| f.steps).into(),
            median(self.falls.iter().map(|f| f.iterations)).into(),
            median(self.falls.iter().map(|f| f.events)).into(),
            paper.map(|p| if self.with_memory { p.with_memory } else { p.without_memory }).into(),
        ]);
    }
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let fabric = Fabric::preset(PAPER_FABRIC)?;
    let mut table = Table::new(COLUMNS);
    let mut times = [("without memory", Mark::Rings), ("with memory", Mark::Crosses)]
        .map(|(name, mark)| Series::new(name, usize::from(mark == Mark::Rings), mark, Vec::new()));
    let mut residuals = Vec::new();
    let mut notes = Vec::new();
    for (wanted, paper) in FALLING_STRIP_POINTS.into_iter().zip(PAPER) {
        let without = Falls::run(wanted, &fabric, false, options.runs)?;
        let with = Falls::run(wanted, &fabric, true, options.runs)?;
        residuals.clear();
        for (falls, series) in [&without, &with].into_iter().zip(&mut times) {
            falls.push_row(&mut table, paper);
            series.points.extend(falls.stabilised().map(|s| [falls.points as f64, s]));
            let median_fall = &falls.falls[falls.falls.len() / 2];
            residuals.push(Series::new("", series.colour, Mark::Line, median_fall.residuals.clone()));
        }
        let paper_ratio = paper
            .map_or(String::new(), |p| format!(", in the paper {:.2}", p.with_memory / p.without_memory));
        let [off, on] = [without.steps(), with.steps()];
        notes.push(format!(
            "{} points: {off} steps without memory, {on} with: ratio {:.2}{paper_ratio}",
            without.points,
            on as f64 / off as f64
        ));
    }
    notes.push(format!(
        "at rest: residual over weight below {REST_RESIDUAL} for {REST_DURATION} s; all figures are medians of {} runs with different tilts; the paper's seconds are as printed there",
        options.runs
    ));
    let title = "Falling strips of 32 x 44 cm come to rest".into();
    Ok(Chart {
        name: "strip",
        table,
        figure: Figure { title, panels: panels_of(times.into(), residuals) },
        notes,
    })
}

/// Time to rest over points, and residual over time of the median falls of the largest mesh.
fn panels_of(times: Vec<Series>, mut residuals: Vec<Series>) -> Vec<Panel> {
    let latest = times.iter().flat_map(|t| &t.points).map(|p| p[1]).fold(0.1, f64::max);
    let longest = residuals.iter().flat_map(|c| &c.points).map(|p| p[0]).fold(0.0, f64::max);
    let threshold = vec![[0.0, REST_RESIDUAL], [longest, REST_RESIDUAL]];
    residuals.push(Series::new("at rest below", BLACK, Mark::Dashed, threshold));
    vec![
        Panel {
            title: "time to rest".into(),
            x: Axis::log("points").between(100.0, 4000.0),
            y: Axis::linear("time to rest [s]").between(0.0, 1.2 * latest),
            series: times,
        },
        Panel {
            title: format!("residual of the strip of {} points", FALLING_STRIP_POINTS[2]),
            x: Axis::linear("time [s]"),
            y: Axis::log("unbalanced force over weight [-]"),
            series: residuals,
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use test_attributes::long;

    /// Trend of Table 1 on the two smaller strips; the chart has all three.
    #[long(80)]
    #[test]
    fn strips_come_to_rest_no_later_with_memory() {
        let fabric = Fabric::preset(PAPER_FABRIC).expect("exists");
        let mut with_events = Vec::new();
        for points in [156, 603] {
            let [off, on] = [false, true].map(|with_memory| {
                let fall = |run| fall(points, &fabric, with_memory, run, Stepping::Fixed).expect("fall");
                (0..11).map(fall).collect::<Vec<_>>()
            });
            assert!(off.iter().chain(&on).all(|f| f.stabilised.is_some()), "{points}: all come to rest");
            assert!(off.iter().all(|f| f.events == 0));
            let steps = [&off, &on].map(|falls| falls.iter().map(|f| f.steps).collect::<Vec<_>>());
            println!("{points}: steps {:?} without memory, {:?} with", steps[0], steps[1]);
            let [without, with] = steps.map(|steps| median(steps.into_iter()));
            assert!(with <= without, "{points}: {with:?} against {without:?}");
            for (off, on) in off.iter().zip(&on) {
                // A strip at rest within its first second has no event.
                if on.events > 0 {
                    with_events.push([off.steps as f64, on.steps as f64]);
                } else {
                    assert_eq!(
                        off.residuals, on.residuals,
                        "{points}: without events memory changes nothing"
                    );
                }
            }
        }
        // Few falls have events, and falls are chaotic: single ones come to rest a fifth later or sooner. So the sum
        // over all with events is compared.
        let [off, on] = [0, 1].map(|k| with_events.iter().map(|steps| steps[k]).sum::<f64>());
        println!("{} of 22 falls have events, with {on} steps, {off} without memory", with_events.len());
        assert!(with_events.len() >= 6);
        assert!(on <= 1.15 * off, "{on} steps against {off}");
    }
}
