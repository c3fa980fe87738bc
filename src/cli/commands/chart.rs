//! `crease chart`: measurements of crease, drawn beside reference data.

use crate::files::input;
use crate::files::output::{Outputs, commit};
use crate::runtime::console;
use crate::runtime::threads::on_threads;
use crate::runtime::waiting::Waiting;
use crate::runtime::wording::ToolWords;
use crease_chart::{Chart, ChartOptions};
use crease_model::error::{Error, Result};
use crease_model::fabric::PAPER_FABRIC;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = list())]
pub struct Arguments {
    /// Name of the chart, listed below
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(Chart::list().map(|(name, _)| name)), hide_possible_values = true)]
    name: String,
    /// Folder for NAME.svg, NAME.png, NAME.csv and NAME.json; created if it is missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Fabric of charts of a single fabric: a name from `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = PAPER_FABRIC)]
    fabric: String,
    /// Runs of every timed scene, in one process; medians are reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..))]
    runs: u8,
    /// Include scenes with a long run time
    #[arg(long)]
    full: bool,
}

/// Returns the list of charts for the help.
fn list() -> String {
    let lines = Chart::list().map(|(name, what)| format!("  {name:<12}{}\n", what.worded(&ToolWords)));
    format!("Charts:\n{}", lines.collect::<String>())
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let options = ChartOptions {
        fabric: input::fabric(&arguments.fabric)?,
        runs: arguments.runs.into(),
        full: arguments.full,
    };
    let folder = OutputFolder::create(&arguments.output)?;
    let waiting = Waiting::begin(&format!("chart {}", arguments.name));
    let chart = on_threads(None, || Chart::make(&arguments.name, &options))?;
    drop(waiting);
    let mut outputs = Outputs::new([]);
    for (ending, bytes) in chart.files()? {
        outputs.add(&arguments.output.join(format!("{}.{ending}", chart.name)), &bytes)?;
    }
    commit(outputs)?;
    folder.keep();
    chart.notes.iter().for_each(|note| console::message(note));
    Ok(())
}

/// Folder of the outputs. If the command created it, it is removed again when the chart fails.
struct OutputFolder<'a> {
    /// Path, if the command created the folder and has not succeeded yet.
    created: Option<&'a Path>,
}

impl<'a> OutputFolder<'a> {
    fn create(path: &'a Path) -> Result<Self> {
        if path.is_dir() {
            return Ok(Self { created: None });
        }
        let error = |message: String, help| Error::input(input::name_of(path), "", message, help);
        if path.exists() {
            return Err(error("is not a folder".into(), "name a folder"));
        }
        std::fs::create_dir(path).map_err(|e| {
            error(format!("cannot be made: {e}"), "make the parent folder, or choose another path")
        })?;
        Ok(Self { created: Some(path) })
    }

    fn keep(mut self) {
        self.created = None;
    }
}

impl Drop for OutputFolder<'_> {
    fn drop(&mut self) {
        if let Some(path) = self.created {
            // Fails, as it should, if the folder is not empty.
            let _ = std::fs::remove_dir(path);
        }
    }
}
