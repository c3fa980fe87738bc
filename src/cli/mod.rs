//! The tool. One file per command: arguments -> options -> library call -> files.
//!
//! The only place that prints and the only one that opens files. stdout is data, stderr is talk. Exit codes: 0 done,
//! 1 bad input, 2 wrong usage, 3 did not converge, 130 interrupted. A command is one file and one line in the list
//! below.

mod args;
mod commands;
mod files;
mod runtime;

use clap::{Parser, Subcommand};
#[cfg(feature = "charts")]
use commands::chart;
#[cfg(feature = "viewer")]
use commands::view;
use commands::{bake, batch, completions, fabric, inspect, remember, render, schema, transfer};
use crease::{Error, Result};
use runtime::{console, interrupt};
use std::process::ExitCode;

/// Garments that remember how they were worn: wear a mesh in, bake its wrinkles.
#[derive(Debug, Parser)]
#[command(
    name = "crease",
    version,
    after_help = "Examples:
  crease inspect shirt.obj
  crease bake shirt.obj --wear garments/wear/fold-thrice.json -o worn.glb --preview
  crease view worn.glb -o worn.html

Exit codes: 0 done, 1 bad input, 2 wrong usage, 3 did not converge, 130 interrupted."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Say what is in a mesh file, what would be repaired, what would be refused
    Inspect(inspect::Arguments),
    /// Wear a garment in and bake its wrinkles: writes OUT.glb, OUT.crease.json and OUT.report.json
    Bake(Box<bake::Arguments>),
    /// Carry memory over to another garment: writes OUT.glb, OUT.crease.json and OUT.report.json
    Transfer(Box<transfer::Arguments>),
    /// Give a garment the memory of a motion that already exists, without simulation
    #[command(visible_alias = "from-motion")]
    Remember(Box<remember::Arguments>),
    /// Make a picture of a worn garment
    Render(render::Arguments),
    /// Draw and write a chart: numbers of ours beside what is known by other means
    #[cfg(feature = "charts")]
    Chart(chart::Arguments),
    /// Make a page to turn worn garments on, colour and compare them
    #[cfg(feature = "viewer")]
    View(view::Arguments),
    /// Wear many garments by many scripts in many fabrics: here, on a Slurm cluster, or by Open Job Description
    Batch(Box<batch::Arguments>),
    /// List the fabrics that come along, or show one in full
    Fabric(fabric::Arguments),
    /// Print the JSON Schema of a file format
    Schema(schema::Arguments),
    /// Print the completions of a shell
    Completions(completions::Arguments),
    /// Print the manual page
    Man(completions::ManArguments),
}

impl Command {
    fn run(self) -> Result<()> {
        match self {
            Self::Inspect(arguments) => inspect::run(arguments),
            Self::Bake(arguments) => bake::run(*arguments),
            Self::Transfer(arguments) => transfer::run(*arguments),
            Self::Remember(arguments) => remember::run(*arguments),
            Self::Render(arguments) => render::run(arguments),
            #[cfg(feature = "charts")]
            Self::Chart(arguments) => chart::run(arguments),
            #[cfg(feature = "viewer")]
            Self::View(arguments) => view::run(arguments),
            Self::Batch(arguments) => batch::run(*arguments),
            Self::Fabric(arguments) => fabric::run(arguments),
            Self::Schema(arguments) => schema::run(arguments),
            Self::Completions(arguments) => completions::run(arguments),
            Self::Man(arguments) => completions::run_man(arguments),
        }
    }
}

/// Reads the command line, runs the command, and maps its outcome to an exit code.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(refusal) => {
            // This is also how clap hands out help and version; a closed pipe is no reason to fail.
            let _ = refusal.print();
            return if refusal.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    match arguments.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            console::error(&error);
            ExitCode::from(exit_code(&error))
        }
    }
}

fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Input(_) | Error::File { .. } => 1,
        Error::NotConverged(_) => 3,
        Error::Interrupted => interrupt::INTERRUPTED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn exit_codes_are_those_promised() {
        assert_eq!(exit_code(&Error::input("f", "", "bad", "")), 1);
        assert_eq!(
            exit_code(&Error::File { file: "f".to_owned(), source: std::io::Error::other("disk") }),
            1
        );
        assert_eq!(exit_code(&Error::NotConverged("step 3".to_owned())), 3);
    }
}
