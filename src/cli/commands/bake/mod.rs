//! `crease bake`: the main command. Reads a mesh, a wear script and a fabric; writes the worn garment, its sidecar and the
//! report, all three or none.
//!
//! Errors are found before the long computation: files are read, outputs checked, and the garment written once without
//! wear.

mod arguments;
mod input;
mod observer;

pub use arguments::Arguments;

use crate::args::export::print_checks;
use crate::commands::bake::arguments::{FramesOf, SidecarMesh};
use crate::commands::bake::input::BakeInput;
use crate::commands::bake::observer::BakeObserver;
use crate::commands::worn_job::{
    FrameSource, KeptFiles, SideFiles, WornJob, WornResult, beside_stream, outcome,
};
use crate::files::checkpoints::CheckpointFile;
use crate::files::frame_folder::FrameFolder;
use crate::files::output::{is_stream, name_of as output_name};
use crate::runtime::console;
use crate::runtime::interrupt::Interrupt;
use crate::runtime::progress::Progress;
use crate::runtime::threads::on_threads;
use crate::runtime::wording::ToolWords;
use crease::internal::bake::{BakeReport, BakeResult, ModelDecision};
use crease::internal::report::{Report, crossing_counts, source_crossings};
use crease_model::error::{Error, Result};
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let interrupt = Interrupt::listen()?;
    let mut progress = Progress::new(arguments.run.quiet, arguments.run.json);
    progress.stage("read");
    on_threads(arguments.run.threads, || match &arguments.output {
        Some(output) => bake_into(&arguments, output, &mut progress, &interrupt),
        None => {
            let input = BakeInput::read(&arguments)?;
            input.check_body_motion()?;
            explain(&input, &arguments, arguments.run.json)
        }
    })
}

fn bake_into(
    arguments: &Arguments,
    output: &Path,
    progress: &mut Progress,
    interrupt: &Interrupt,
) -> Result<()> {
    let side_files = SideFiles {
        apply: arguments.apply,
        detail: Some((&arguments.refine, None)),
        export: Some(&arguments.export),
        preview: arguments.preview,
        ..SideFiles::default()
    };
    let inputs = [arguments.mesh.as_path(), arguments.wear.as_path(), Path::new(&arguments.fabric)];
    if is_stream(output) && (arguments.explain || arguments.resume) {
        let option = if arguments.explain { "--explain" } else { "--resume" };
        return Err(beside_stream(option));
    }
    let mut job = WornJob::start(&arguments.run, output, inputs, side_files)?;
    let mut input = BakeInput::read(arguments)?;
    if arguments.explain && !arguments.run.json {
        explain(&input, arguments, false)?;
    }
    job.accept_mesh(&mut input.mesh, &arguments.mesh, input.refinement.as_ref())?;
    job.warn_before_run(std::mem::take(&mut input.earlier_warnings));
    if let (Some(earlier), true) = (&input.earlier, arguments.run.is_verbose()) {
        let sidecar = &earlier.sidecar;
        console::message(&format!("goes on with the memory in {sidecar} (--forget leaves it out)"));
    }
    input.check_writers(&job.files().extras())?;
    let start = source_crossings(&input.mesh.garment);
    job.inputs_read();

    let interval = Duration::from_secs_f64(arguments.checkpoint_every);
    let mut checkpoints = CheckpointFile::beside(&job.files().worn, interval);
    checkpoints.path().map_or(Ok(()), |path| job.check(path))?;
    let method = arguments.method().name();
    let (baked, stale_frames) = match simulate(&input, arguments, progress, &mut checkpoints, interrupt)? {
        Simulated::Finished { baked, stale_frames } => (*baked, stale_frames),
        Simulated::Stopped { work, kept } => {
            let report = Report::of_stopped(&input.mesh.garment, &work, start.len(), &ToolWords);
            let report = Report { method: method.to_owned(), ..report };
            progress.finish();
            return Err(job.write_stopped(report, kept)?);
        }
    };
    job.warn(stale_frames);
    job.warn_of_failure(baked.report.inside_body_reason.as_deref());
    let empty_reason = baked.report.empty_reason.as_ref().map(|reason| reason.worded(&ToolWords));
    job.warn_of_failure(empty_reason.as_deref());

    progress.stage("write");
    let computed = Instant::now();
    let garment = &input.mesh.garment;
    let counts = crossing_counts(garment, &baked.worn, &start);
    let mut report = Report::of_bake(garment, &baked, counts, &ToolWords);
    report.method = method.to_owned();
    let mut sidecar =
        input.sidecar(&baked.worn, arguments.run_description(&baked, input.earlier.as_ref()))?;
    let has_own_mesh = baked.simulated.garment.triangles != garment.triangles;
    if arguments.sidecar_mesh == SidecarMesh::Simulated && has_own_mesh {
        sidecar = sidecar.with_simulated(&baked.simulated.garment, &baked.simulated.worn)?;
    }
    let result = WornResult {
        mesh: &input.mesh,
        worn: &baked.worn,
        fabric: &input.fabric,
        sidecar: &sidecar,
        side_files: SideFiles {
            detail: Some((&arguments.refine, input.refinement.as_ref())),
            frames: arguments.frames.as_deref().map(|folder| FrameSource { folder, rate: arguments.fps }),
            ..side_files
        },
        computed,
    };
    let mut written = job.write(&result, report)?;
    checkpoints.remove();
    progress.finish();
    written.print(print_summary)?;
    let worn = output_name(written.worn());
    let report = &baked.report;
    if let Some(failure) = &report.not_performed {
        return Err(Error::NotPerformed(failure.clone()));
    }
    let failed = report.inside_body_reason.as_ref().or(report.unconverged_reason.as_ref());
    outcome(
        failed.map(|reason| format!("{reason}; the unconverged result is in {worn}")),
        empty_reason.map(|reason| format!("{reason}; the result is in {worn}")),
    )
}

/// Outcome of the simulation.
enum Simulated {
    /// It came to the end of the script.
    Finished {
        baked: Box<BakeResult>,
        /// Warning if the folder of frames holds frames of an earlier run.
        stale_frames: Option<String>,
    },
    /// It could not recover and ended before that.
    Stopped { work: Box<BakeReport>, kept: KeptFiles },
}

/// Runs the simulation.
fn simulate(
    input: &BakeInput,
    arguments: &Arguments,
    progress: &mut Progress,
    checkpoints: &mut CheckpointFile,
    interrupt: &Interrupt,
) -> Result<Simulated> {
    let resumed = if arguments.resume { checkpoints.read()? } else { None };
    let frames_written = resumed.as_ref().map_or(0, |saved| saved.checkpoint.counts.frames.shown);
    let mut frames = match &arguments.frames {
        Some(folder) => Some(FrameFolder::new(folder, &arguments.mesh, frames_written as usize)?),
        None => None,
    };
    let frames_of_simulated = arguments.frames_of == FramesOf::Simulated;
    if let Some(frames) = &mut frames {
        input.show_vertices(frames);
    }
    let action_count = input.script.flatten().count();
    let mut observer = BakeObserver {
        progress,
        frames,
        checkpoints,
        interrupt,
        frames_of_simulated,
        action_count,
        stopped: None,
    };
    interrupt.set_exit_immediately(false);
    let mut bake = input.bake(arguments);
    if let Some(saved) = &resumed {
        bake = bake.resume(&saved.file, saved.checkpoint.clone());
    }
    let outcome = bake.run_with(&mut observer);
    let saved = observer.checkpoints.path().filter(|path| path.exists());
    let mut baked = match (outcome, observer.stopped.take()) {
        (Ok(baked), _) => baked,
        (Err(Error::NotConverged(_)), Some(mut work)) => {
            work.decisions.extend(input.no_leash());
            let last_frame = observer.frames.and_then(|frames| frames.last_frame());
            let kept = KeptFiles { checkpoint: saved.map(Path::to_owned), last_frame };
            return Ok(Simulated::Stopped { work: Box::new(work), kept });
        }
        (Err(error), _) => {
            if let (Some(saved), Error::Interrupted) = (saved, &error) {
                let saved = saved.display();
                let text = "the same command with --resume continues it";
                console::message(&format!("the run is saved in {saved}: {text}"));
            }
            return Err(error);
        }
    };
    baked.report.decisions.extend(input.no_leash());
    interrupt.set_exit_immediately(false);
    let stale = observer.frames.and_then(|frames| frames.stale_frame());
    let stale_frames = stale
        .map(|path| format!("{} and any after it are from an earlier run with more frames", path.display()));
    Ok(Simulated::Finished { baked: Box::new(baked), stale_frames })
}

/// Prints the inputs and the plan on stdout.
fn explain(input: &BakeInput, arguments: &Arguments, as_json: bool) -> Result<()> {
    let mut plan = input.plan(arguments);
    let body = plan.decisions.iter().position(|decision| decision.name == "body");
    let body = body.map(|k| plan.decisions.remove(k));
    let mut of_input = input.decisions();
    of_input.splice(1..1, body);
    plan.decisions.splice(0..0, of_input);
    if as_json {
        let list: Vec<Value> = plan
            .decisions
            .iter()
            .map(|decision| json!({"name": decision.name, "on": decision.on, "why": decision.why.worded(&ToolWords)}))
            .collect();
        return console::data(&format!("{:#}\n", Value::Array(list)));
    }
    let line = |decision: &ModelDecision| {
        let why = decision.why.worded(&ToolWords);
        format!("{:<16}{:<5}{why}\n", decision.name, if decision.on { "on" } else { "off" })
    };
    console::data(&plan.decisions.iter().map(line).collect::<String>())
}

fn print_summary(worn: &str, report: &Report) {
    print_checks(&report.exports);
    console::message(&format!(
        "{worn}: {} points, {:.1} s of wear in {} steps and {:.1} s; {} crossings",
        report.points, report.simulated_s, report.steps, report.wall_s, report.crossings,
    ));
}
