//! `crease fabric`: the built-in fabrics.

use crate::args::values::html_path;
use crate::files::input;
use crate::files::output::{Outputs, commit};
use crate::runtime::console;
use clap::Subcommand;
use crease::internal::report::swatch_page;
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease fabric list --swatches fabrics.html
  crease fabric show denim > own.json")]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the built-in fabrics, one per line
    List {
        /// Print the full data of all fabrics as JSON
        #[arg(long)]
        json: bool,
        /// Also write a page with a swatch of each fabric
        #[arg(long, value_name = "OUT.html", value_parser = html_path)]
        swatches: Option<PathBuf>,
    },
    /// Print a fabric as a file, to be edited into a new one
    Show {
        /// Name of a built-in fabric, or a fabric file
        #[arg(value_name = "NAME|FILE")]
        fabric: String,
    },
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    match arguments.command {
        Command::List { json, swatches } => {
            let fabrics: Vec<Fabric> =
                Fabric::preset_names().into_iter().map(Fabric::preset).collect::<Result<_>>()?;
            if let Some(path) = swatches {
                let mut outputs = Outputs::new([]);
                outputs.add(&path, swatch_page(&fabrics).as_bytes())?;
                commit(outputs)?;
            }
            match json {
                true => console::data(&format!("{:#}\n", serde_json::json!(fabrics))),
                false => console::data(&table(&fabrics)),
            }
        }
        Command::Show { fabric } => console::data(&input::fabric(&fabric)?.to_json()),
    }
}

fn table(fabrics: &[Fabric]) -> String {
    let mut text = format!("{:<22}{:>6}  {:>9}  what it is\n", "name", "g/m2", "bends, cm");
    for fabric in fabrics {
        let mark = if fabric.name == DEFAULT_FABRIC { " (default)" } else { "" };
        text += &format!(
            "{:<22}{:>6.0}  {:>9.2}  {}{mark}\n",
            fabric.name,
            fabric.area_density_g_m2,
            fabric.bending_length() * 100.0,
            fabric.description,
        );
    }
    text
}
