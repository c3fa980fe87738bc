//! Charts: what crease does, measured and drawn beside what is known by other means.
//!
//! ```text
//! chart file (hinge.rs, ...) -> Chart { rows, figure } -> svg, png, csv, json
//! ```
//!
//! One file per chart, which runs its scene through the library and returns numbers, and one line in the list below.
//! No chart draws or writes for itself: `figure` says what a picture shows, `draw` draws every picture with the same
//! colours, axes and letters, `table` writes every table. Knows no files; `crease chart` puts the bytes on disk.
//!
//! To add a chart: `NAME.rs` with `pub(super) fn make(&ChartOptions) -> Result<Chart>`, and its line in `chart_list!`.

mod draw;
mod figure;
pub mod press_between_plates;
mod raster;
pub mod scenes;
mod static_solve;
mod table;
mod test_sheet;

pub use figure::{Axis, Figure, Mark, Panel, Series};
pub use table::{Cell, Table};

use crate::error::{Error, Result};
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::json::nearest;

macro_rules! chart_list {
    ($($module:ident $name:literal $what:literal,)*) => {
        $(pub mod $module;)*

        /// Name, what it shows, and maker of every chart, in the order they are listed to people.
        const CHARTS: &[(&str, &str, fn(&ChartOptions) -> Result<Chart>)] = &[$(($name, $what, $module::make)),*];
    };
}

chart_list! {
    hinge "hinge" "torque and rest angle of one hinge that is folded, beside the paper's Table 2",
    strip "strip" "seconds to come to rest of falling strips with and without memory, the paper's Table 1",
    kes_loop "loop" "moment over curvature of a strip bent to and fro, as on a KES-FB2 tester",
    cantilever "cantilever" "strips that bend under their own weight, beside the heavy elastica",
    drape "drape" "drape coefficients of Cusick over bending length, beside an independent solver's",
    accuracy "accuracy" "what every method costs for what error; `--full` with a whole T-shirt (an hour)",
    stability "stability" "where methods fail: step against stiffness, contrast, slivers, layers, speed",
    plan "plan" "what choosing the models saves: the draft T-shirt by plan and with everything on (half an hour)",
    speed "speed" "wall time and where it goes, beside kernels of the machine; `--full` with T-shirts of 13,863 and 60,000 points (an hour)",
    recovery "recovery" "crease recovery angles of the fabrics that come along, beside published ranges",
}

/// What a chart may be told.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartOptions {
    /// Fabric of charts that show one.
    pub fabric: Fabric,
    /// How often timed scenes are run; medians are shown.
    pub runs: usize,
    /// Whether scenes that take long are run, too.
    pub full: bool,
}

impl ChartOptions {
    /// The default fabric, and five runs.
    pub fn new() -> Result<Self> {
        Ok(Self { fabric: Fabric::preset(DEFAULT_FABRIC)?, runs: 5, full: false })
    }
}

/// A chart: numbers and what its picture shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Its name, as on the command line.
    pub name: &'static str,
    /// The numbers.
    pub table: Table,
    /// The picture.
    pub figure: Figure,
    /// What a reader should know: one sentence each.
    pub notes: Vec<String>,
}

impl Chart {
    /// Names of all charts and what they show, in list order.
    pub fn list() -> impl Iterator<Item = (&'static str, &'static str)> {
        CHARTS.iter().map(|(name, what, _)| (*name, *what))
    }

    /// Makes the chart `name`.
    pub fn make(name: &str, options: &ChartOptions) -> Result<Self> {
        match CHARTS.iter().find(|(own, ..)| *own == name) {
            Some((_, _, make)) => make(options),
            None => {
                let names: Vec<&str> = Self::list().map(|(name, _)| name).collect();
                let cure = match nearest(name, names.iter().copied()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("the charts are {}", names.join(", ")),
                };
                Err(Error::input(
                    "chart",
                    "",
                    format!("there is no chart {}", crate::json::quoted(name)),
                    cure,
                ))
            }
        }
    }

    /// Its files: ending and bytes of each.
    pub fn files(&self) -> Result<[(&'static str, Vec<u8>); 4]> {
        Ok([
            ("svg", draw::svg(&self.figure)?.into_bytes()),
            ("png", draw::png(&self.figure)?),
            ("csv", self.table.to_csv().into_bytes()),
            ("json", self.table.to_json(self.name, &self.notes).into_bytes()),
        ])
    }
}

/// Value in the middle of `values`; of an even number the upper one.
fn median<T: PartialOrd + Copy>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut values: Vec<T> = values.collect();
    values.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    values.get(values.len() / 2).copied()
}
