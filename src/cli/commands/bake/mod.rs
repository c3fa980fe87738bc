//! `crease bake`: the main command. Reads a mesh, a wear script and a fabric; writes the worn garment, its sidecar and the
//! report, all three or none.

mod arguments;

pub use arguments::Arguments;

use crate::args::export::print_checks;
use crate::commands::worn_job::{Terminal, beside_stream, crossings_text, finish, print_files};
use crate::files::output::is_stream;
use crate::runtime::console;
use crate::runtime::interrupt::Interrupt;
use crate::runtime::progress::Progress;
use crate::runtime::threads::on_threads;
use crate::runtime::wording::ToolWords;
use crease::internal::bake::ModelDecision;
use crease::internal::job::{BakeJob, WornPaths};
use crease::internal::report::Report;
use crease_model::error::{Error, Result};
use crease_model::printable::printable;
use serde_json::{Value, json};

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let interrupt = Interrupt::listen()?;
    let mut progress = Progress::new(arguments.run.quiet, arguments.run.json);
    progress.stage("read");
    on_threads(arguments.run.threads, || bake(arguments, &mut progress, &interrupt))
}

fn bake(arguments: Arguments, progress: &mut Progress, interrupt: &Interrupt) -> Result<()> {
    let (run, explains, output) = (arguments.run.clone(), arguments.explain, arguments.output.clone());
    if output.as_deref().is_some_and(is_stream) && (explains || arguments.resume) {
        return Err(beside_stream(if explains { "--explain" } else { "--resume" }));
    }
    let job = BakeJob::read(arguments.job_options()?)?;
    let Some(output) = output else {
        job.check_body_motion()?;
        return explain(&job.decisions(), run.json);
    };
    if explains && !run.json {
        explain(&job.decisions(), false)?;
    }
    let mut terminal = Terminal { is_verbose: run.is_verbose(), bake: Some((progress, interrupt)) };
    let outputs = job.run(&mut terminal).inspect_err(|error| {
        let saved = WornPaths::beside(&output).checkpoint().filter(|path| path.exists());
        if let (Error::Interrupted, Some(saved)) = (error, saved) {
            let text = "the same command with --resume continues it";
            console::message(&format!("the run is saved in {}: {text}", saved.display()));
        }
    })?;
    finish(outputs, &run, terminal, print_summary)
}

/// Prints the inputs and the plan on stdout.
fn explain(decisions: &[ModelDecision], as_json: bool) -> Result<()> {
    if as_json {
        let entry = |decision: &ModelDecision| json!({"name": decision.name, "on": decision.on, "why": decision.why.worded(&ToolWords)});
        let list = decisions.iter().map(entry).collect();
        return console::data(&format!("{:#}\n", Value::Array(list)));
    }
    let line = |decision: &ModelDecision| {
        let why = decision.why.worded(&ToolWords);
        let state = if decision.on { "on" } else { "off" };
        format!("{:<16}{state:<5}{}\n", decision.name, printable(&why))
    };
    console::data(&decisions.iter().map(line).collect::<String>())
}

fn print_summary(worn: &str, report: &Report) {
    print_checks(&report.exports);
    print_files(&report.files, report.fine.as_ref());
    console::message(&format!(
        "{worn}: {} points, {:.1} s of wear in {} steps and {:.1} s; {}; {}",
        report.points,
        report.simulated_s,
        report.steps,
        report.wall_s,
        report.shown,
        crossings_text([report.crossings, report.crossings_at_start, report.crossings_in_result]),
    ));
}
