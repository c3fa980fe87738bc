//! Validation charts: results of crease compared with references of other origin.
//!
//! ```text
//! chart file (hinge.rs, ...) -> Chart { table, figure } -> svg, png, csv, json
//! ```
//!
//! Each chart is one file, which runs its scenes through the library and returns numbers, and one line in the list
//! below. `figure` describes a picture as plain data, `draw` renders every picture with the same colours, axes and
//! font, `table` writes every table. No file is opened here: `crease chart` writes the bytes.
//!
//! To add a chart: `NAME.rs` with `pub(super) fn make(&ChartOptions) -> Result<Chart>`, and its line in
//! `chart_list!`.

mod bake_scene;
mod chart_type;
pub mod comparison;
mod curvature_field;
mod draw;
mod falling_strip;
mod figure;
mod included_mesh;
mod net_angles;
pub mod press_between_plates;
mod raster;
pub mod scenes;
mod spectrum;
mod static_solve;
mod statistics;
mod table;
mod test_sheet;
mod ticks;

pub use chart_type::{Chart, ChartOptions};
pub use figure::{Axis, BLACK, Figure, GREY, Mark, Panel, Series};
pub use table::{Cell, Table};
pub use test_sheet::TestSheet;

use crease_model::error::{Error, Message, Result, Setting};
use crease_model::json::nearest;

macro_rules! chart_list {
    ($($module:ident $name:literal $description:literal,)*) => {
        $(pub mod $module;)*

        /// Name, description and maker of every chart, in the order of listings.
        const CHARTS: &[(&str, &str, fn(&ChartOptions) -> Result<Chart>)] =
            &[$(($name, $description, $module::make)),*];
    };
}

chart_list! {
    hinge "hinge" "torque and rest angle of one folded hinge, compared with the paper's Table 2",
    readings "readings" "readings of the paper's law, by the strain and by the rate, and guards of its events, compared with its Table 2",
    guards "guards" "both guards of the events of memory: recovery of all presets, and time to rest of falling strips (two minutes a run)",
    strip "strip" "time to rest of falling strips with and without memory, compared with the paper's Table 1",
    kes_loop "loop" "moment over curvature of a strip in cyclic bending (KES-FB2 test)",
    cantilever "cantilever" "strips bending under their own weight, compared with the heavy elastica",
    drape "drape" "Cusick drape coefficient over bending length, compared with an independent solver",
    accuracy "accuracy" "cost over error of every integrator on scenes with known solutions",
    front "front" "error of what is baked over wall time: folds, an elbow, crumpled and fallen cloth at every quality and with single settings changed (ten minutes a run)",
    stability "stability" "failures of every integrator: step size against stiffness, contrast, slivers, layers, speed",
    robustness "robustness" "outcome of whole bakes where they get difficult: slivers, noise, size, fabric, step, speed, pressure, layers (ten minutes; `{full}`: reference and every integrator)",
    plan "plan" "cost and effect of models: tshirt-draft with the plan, single models changed, and at full fidelity (four minutes a run)",
    speed "speed" "wall time by stage, compared with kernels of the machine; `{full}` adds T-shirts of 14k and 60k points (an hour)",
    recovery "recovery" "crease recovery angles of all presets, compared with published ranges",
}

impl Chart {
    /// Names and descriptions of all charts, in list order.
    pub fn list() -> impl Iterator<Item = (&'static str, Message)> {
        let described = |description: &'static str| match description.split_once("{full}") {
            Some((before, after)) => Message::from(before) + Setting::FullCharts + after,
            None => description.into(),
        };
        CHARTS.iter().map(move |(name, description, _)| (*name, described(description)))
    }

    /// Makes the chart `name`.
    ///
    /// # Errors
    /// [`Error::Input`] for an unknown name.
    pub fn make(name: &str, options: &ChartOptions) -> Result<Self> {
        match CHARTS.iter().find(|(own, ..)| *own == name) {
            Some((_, _, make)) => make(options),
            None => {
                let names: Vec<&str> = Self::list().map(|(name, _)| name).collect();
                let help = match nearest(name, names.iter().copied()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("the charts are {}", names.join(", ")),
                };
                Err(Error::input(
                    "chart",
                    "",
                    format!("there is no chart {}", crease_model::json::quoted(name)),
                    help,
                ))
            }
        }
    }
}
