//! The common frame of the commands that produce a worn garment: `bake`, `transfer`, `remember`. It prints what a job reports and
//! its outcome.

use crate::args::run::RunArgs;
use crate::files::output::is_stream;
use crate::runtime::console;
use crate::runtime::interrupt::Interrupt;
use crate::runtime::progress::{Progress, StepProgress};
use crate::runtime::wording::ToolWords;
use crease::internal::bake::{BakeProgress, Observer};
use crease::internal::job::{JobNotice, JobObserver, JobOutputs, JobPhase, JobReport, OutputOptions};
use crease::internal::report::{FineReport, WrittenFile};
use crease_model::error::{Error, Result, Vocabulary};

/// Checks that nothing is asked for that needs a place beside a garment that goes to the standard output; `json` is the report.
pub fn check_stream(output: &OutputOptions, json: bool) -> Result<()> {
    if !output.path.as_deref().is_some_and(is_stream) {
        return Ok(());
    }
    let beside = [
        ("--json", json),
        ("--preview", output.preview),
        ("--export", !output.exports.is_empty()),
        ("--fine", output.fine),
        ("--map-files", output.detail.is_some_and(|detail| detail.files)),
    ];
    beside.iter().find(|(_, is_given)| *is_given).map_or(Ok(()), |(option, _)| Err(beside_stream(option)))
}

/// The error of `option`, which needs a place that the standard output does not have.
pub fn beside_stream(option: &str) -> Error {
    let message = format!("takes the garment, and {option} needs a place of its own");
    Error::input("standard output", "", message, "name a file with -o")
}

/// Pairs of triangles that intersect in a result, in words: those that are new, those of the input, and all in the result.
pub fn crossings_text([added, at_start, in_result]: [usize; 3]) -> String {
    match at_start {
        0 => format!("{added} crossings"),
        _ => format!("{added} new crossings, {in_result} in the file written ({at_start} in the input)"),
    }
}

/// Connection of a job with the terminal: notices, and for a bake progress and interruption.
pub struct Terminal<'a> {
    /// Whether messages for people are printed.
    pub is_verbose: bool,
    /// Progress display and signal handlers of a bake.
    pub bake: Option<(&'a mut Progress, &'a Interrupt)>,
}

impl Observer for Terminal<'_> {
    fn progress(&mut self, now: &BakeProgress) {
        let Some((progress, _)) = &mut self.bake else { return };
        progress.step(
            now.stage,
            StepProgress {
                simulated_s: now.time,
                total_s: now.total,
                step: now.steps,
                events: now.events.gradual + now.events.critical,
            },
        );
    }

    fn should_stop(&mut self) -> bool {
        self.bake.as_ref().is_some_and(|(_, interrupt)| interrupt.is_requested())
    }
}

impl JobObserver for Terminal<'_> {
    fn phase(&mut self, phase: JobPhase) {
        let Some((progress, interrupt)) = &mut self.bake else { return };
        interrupt.set_exit_immediately(phase == JobPhase::Relax);
        if phase == JobPhase::Write {
            progress.stage("write");
        }
    }

    fn words(&self) -> &'static dyn Vocabulary {
        &ToolWords
    }

    fn notice(&mut self, notice: JobNotice) {
        match notice {
            JobNotice::NoCheckpoint(text) | JobNotice::NoFrames(text) => print_warning(text),
            _ if !self.is_verbose => {}
            JobNotice::Warning(text) => print_warning(text),
            JobNotice::EarlierMemory(sidecar) => {
                console::message(&format!("goes on with the memory in {sidecar} (--forget leaves it out)"));
            }
        }
    }
}

/// Writes the outputs of a job, all or none, and prints the outcome: warnings and `summary`, which receives the name of the worn
/// garment, as text, or the report as JSON. Fails as the job did.
pub fn finish<R: JobReport>(
    mut outputs: JobOutputs<R>,
    run: &RunArgs,
    terminal: Terminal,
    summary: impl FnOnce(&str, &R),
) -> Result<()> {
    let stream = outputs.write()?;
    if !stream.is_empty() {
        console::data(&stream)?;
    }
    if let Some((progress, _)) = terminal.bake {
        progress.finish();
    }
    if run.is_verbose() {
        outputs.fresh_warnings().for_each(|text| print_warning(text));
        if outputs.worn.is_some() {
            summary(&outputs.name(), &outputs.report);
        }
    }
    if run.json {
        console::data(&outputs.report.json())?;
    }
    outputs.failure.map_or(Ok(()), Err)
}

/// Prints the sizes of the `files` of a run.
pub fn print_files(files: &[WrittenFile], fine: Option<&FineReport>) {
    if let Some(fine) = fine {
        let FineReport { file, vertices, triangles, crossings } = fine;
        console::message(&format!(
            "{file}: {vertices} vertices, {triangles} triangles; {crossings} crossings"
        ));
    }
    let size = |file: &WrittenFile| format!("{} {:.1} MB", file.file, file.bytes as f64 / 1e6);
    let sizes: Vec<String> = files.iter().map(size).collect();
    if !sizes.is_empty() {
        console::message(&format!("written: {}", sizes.join(", ")));
    }
}

fn print_warning(text: &str) {
    console::message(&format!("warning: {text}"));
}
