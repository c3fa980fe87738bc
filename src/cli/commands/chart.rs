//! `crease chart`: what crease does, measured and drawn beside what is known by other means.

use crate::cli::files::input;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crate::cli::runtime::threads::use_threads;
use crease::chart::{Chart, ChartOptions};
use crease::fabric::DEFAULT_FABRIC;
use crease::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = list())]
pub struct Arguments {
    /// Which chart; the list is below
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(Chart::list().map(|(name, _)| name)), hide_possible_values = true)]
    name: String,
    /// Folder for NAME.svg, NAME.png, NAME.csv and NAME.json; made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Fabric of charts that show one: a name from `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    /// Runs of every timed scene, all in one process; medians are shown
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..))]
    runs: u8,
    /// With the scenes that take long
    #[arg(long)]
    full: bool,
}

fn list() -> String {
    let lines = Chart::list().map(|(name, what)| format!("  {name:<12}{what}\n"));
    format!("Charts:\n{}", lines.collect::<String>())
}

pub fn run(arguments: Arguments) -> Result<()> {
    use_threads(None)?;
    let options = ChartOptions {
        fabric: input::fabric(&arguments.fabric)?,
        runs: arguments.runs.into(),
        full: arguments.full,
    };
    let folder = Folder::at(&arguments.output)?;
    let chart = Chart::make(&arguments.name, &options)?;
    let mut outputs = Outputs::new([]);
    for (ending, bytes) in chart.files()? {
        outputs.add(&arguments.output.join(format!("{}.{ending}", chart.name)), &bytes)?;
    }
    outputs.commit()?;
    folder.keep();
    chart.notes.iter().for_each(|note| console::say(note));
    Ok(())
}

/// The folder of the outputs; taken away again if it was made for a chart that failed.
struct Folder<'a> {
    made: Option<&'a Path>,
}

impl<'a> Folder<'a> {
    fn at(path: &'a Path) -> Result<Self> {
        if path.is_dir() {
            return Ok(Self { made: None });
        }
        let fault = |what: String, cure| Error::input(input::name_of(path), "", what, cure);
        if path.exists() {
            return Err(fault("is not a folder".into(), "name a folder"));
        }
        std::fs::create_dir(path).map_err(|e| {
            fault(format!("cannot be made: {e}"), "make the folder it lies in, or choose another place")
        })?;
        Ok(Self { made: Some(path) })
    }

    fn keep(mut self) {
        self.made = None;
    }
}

impl Drop for Folder<'_> {
    fn drop(&mut self) {
        if let Some(path) = self.made {
            // Only an empty folder goes.
            let _ = std::fs::remove_dir(path);
        }
    }
}
