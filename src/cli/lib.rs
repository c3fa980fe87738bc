//! The command-line tool: from arguments to the options of a job, a library call, and messages.
//!
//! Only this side prints. Data goes to stdout, messages go to stderr. Exit codes: 0 success, 1 bad input,
//! 2 wrong usage, 3 no convergence, an action that did not take place, or an empty result, 130 interrupted. A new command is
//! a file in `commands` and an entry in `Command`.

mod args;
mod commands;
mod files;
mod runtime;

pub use runtime::wording::ToolWords;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};
#[cfg(feature = "charts")]
use commands::chart;
#[cfg(feature = "viewer")]
use commands::view;
use commands::{
    apply, bake, batch, completions, example, fabric, from_motion, inspect, render, schema, transfer,
};
use crease_model::error::{Error, Result};
use runtime::{console, interrupt};
use std::ffi::OsString;

/// Simulates how a garment is worn and bakes the permanent wrinkles into its mesh.
#[derive(Debug, Parser)]
#[command(
    name = "crease",
    version,
    after_help = "Examples:
  crease inspect shirt.obj
  crease example tshirt-draft -o .
  crease bake tshirt-draft.glb --wear fold-thrice -o worn.glb --preview
  crease view worn.glb -o worn.html

Exit codes: 0 success, 1 bad input, 2 wrong usage, 3 no convergence, an action that did not
take place, or an empty result, 130 interrupted."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Describe a mesh file and the repairs and errors that a bake would report
    Inspect(inspect::Arguments),
    /// Simulate wear and bake the wrinkles: writes OUT.glb, OUT.crease.json and OUT.report.json
    Bake(Box<bake::Arguments>),
    /// Transfer memory to another garment: writes OUT.glb, OUT.crease.json and OUT.report.json
    Transfer(Box<transfer::Arguments>),
    /// Make the worn shape of a baked file its base shape, for programs that do not read default morph weights
    Apply(apply::Arguments),
    /// Compute memory from an existing motion, without simulation
    #[command(visible_alias = "from-motion")]
    Remember(Box<from_motion::Arguments>),
    /// Draw a picture of a worn garment
    Render(render::Arguments),
    /// Run a validation scene and chart it beside reference data
    #[cfg(feature = "charts")]
    Chart(chart::Arguments),
    /// Write an interactive 3D page of worn garments
    #[cfg(feature = "viewer")]
    View(view::Arguments),
    /// Bake many garments, scripts and fabrics: on this machine, on a Slurm cluster, or through Open Job Description
    Batch(Box<batch::Arguments>),
    /// List garments, wear scripts and memories to try, or write one
    Example(example::Arguments),
    /// List the built-in fabrics, or print one
    Fabric(fabric::Arguments),
    /// Print the JSON Schema of a file format
    Schema(schema::Arguments),
    /// Print shell completions
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
            Self::Apply(arguments) => apply::run(arguments),
            Self::Remember(arguments) => from_motion::run(*arguments),
            Self::Render(arguments) => render::run(arguments),
            #[cfg(feature = "charts")]
            Self::Chart(arguments) => chart::run(arguments),
            #[cfg(feature = "viewer")]
            Self::View(arguments) => view::run(arguments),
            Self::Batch(arguments) => batch::run(*arguments),
            Self::Example(arguments) => example::run(arguments),
            Self::Fabric(arguments) => fabric::run(arguments),
            Self::Schema(arguments) => schema::run(arguments),
            Self::Completions(arguments) => completions::run(arguments, Arguments::command()),
            Self::Man(arguments) => completions::run_man(arguments, Arguments::command()),
        }
    }
}

/// Runs the command line `words`, of which the first is the name of the program; returns the exit code.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => {
            let error = with_equals_tip(error, &words);
            // Help and version arrive here, too. A closed pipe is not an error.
            let _ = error.print();
            return if error.use_stderr() { 2 } else { 0 };
        }
    };
    match arguments.command.run() {
        Ok(()) => 0,
        Err(error) => {
            console::error(&error);
            exit_code(&error)
        }
    }
}

/// Returns `error` with the right way to write a value that stands behind an option and is taken behind an equals sign only.
fn with_equals_tip(mut error: clap::Error, words: &[OsString]) -> clap::Error {
    let Some(ContextValue::String(value)) = error.get(ContextKind::InvalidArg) else { return error };
    let option = words.windows(2).find(|pair| pair[1] == **value).and_then(|pair| pair[0].to_str());
    let name = option.and_then(|option| option.strip_prefix("--"));
    let command = Arguments::command();
    let mut options = command.get_subcommands().flat_map(clap::Command::get_arguments);
    if let Some(name) = name
        && options.any(|option| option.is_require_equals_set() && option.get_long() == Some(name))
    {
        let tip = format!("write --{name}={value}").into();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip]));
    }
    error
}

/// Returns the exit code of `error`.
fn exit_code(error: &Error) -> u8 {
    match error {
        Error::NotConverged(_) | Error::NotPerformed(_) | Error::Empty(_) => 3,
        Error::Interrupted => interrupt::INTERRUPTED,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::wording::ToolWords;
    use crease::wording::{Setting, Vocabulary};

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_setting_is_worded_as_an_option_that_a_command_has() {
        let tool = Arguments::command();
        let options: Vec<String> = tool
            .get_subcommands()
            .flat_map(|command| command.get_arguments().filter_map(|argument| argument.get_long()))
            .map(|name| format!("--{name}"))
            .collect();
        let words = Setting::ALL.map(|setting| ToolWords.setting(setting, None));
        let unknown: Vec<&String> = words.iter().filter(|word| !options.contains(word)).collect();
        // The option of charts exists where charts do.
        assert!(unknown.iter().all(|word| *word == "--full" && cfg!(not(feature = "charts"))), "{unknown:?}");
    }

    #[test]
    fn exit_codes_match_the_documentation() {
        assert_eq!(exit_code(&Error::input("f", "", "bad", "")), 1);
        assert_eq!(
            exit_code(&Error::File { file: "f".to_owned(), source: std::io::Error::other("disk") }),
            1
        );
        assert_eq!(exit_code(&Error::NotConverged("step 3".into())), 3);
    }
}
