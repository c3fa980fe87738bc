//! Jobs on this machine, N at a time, each in its own process.

use crate::commands::batch::arguments::{Arguments, Shard};
use crate::commands::batch::job;
use crate::commands::batch::job::{JobOutcome, JobSettings, JobState};
use crate::commands::batch::jobs::{Job, Jobs};
use crate::runtime::console;
use crate::runtime::interrupt::Interrupt;
use crease_model::error::{Error, Result};
use serde_json::json;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs the jobs of a shard, or all. A job that failed or is doubtful does not stop the others, but makes the call fail in the end.
pub fn run(jobs: &Jobs, arguments: &Arguments, interrupt: &Interrupt) -> Result<()> {
    let shard = arguments.shard.unwrap_or(Shard::ALL);
    let mine: Vec<&Job> = jobs
        .list
        .iter()
        .enumerate()
        .filter(|(number, _)| shard.contains(*number))
        .map(|(_, job)| job)
        .collect();
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let at_once = arguments.parallel.map_or(processors, usize::from).min(mine.len()).max(1);
    let threads = arguments.threads.map_or((processors / at_once).max(1), usize::from);
    let settings = JobSettings { threads, retries: arguments.retries };
    let next = AtomicUsize::new(0);
    let outcomes: Mutex<Vec<Result<JobState>>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                while let Some(job) = mine.get(next.fetch_add(1, Ordering::SeqCst)) {
                    if interrupt.is_requested() {
                        return;
                    }
                    let outcome = job::run(jobs, job, settings, interrupt);
                    if let Ok(mut outcomes) = outcomes.lock() {
                        let position = Position { number: outcomes.len() + 1, count: mine.len() };
                        outcomes.push(outcome.map(|outcome| {
                            print(arguments, job, &outcome, position);
                            outcome.record.state
                        }));
                    }
                }
            });
        }
    });
    let states: Vec<JobState> =
        outcomes.into_inner().unwrap_or_default().into_iter().collect::<Result<_>>()?;
    if interrupt.is_requested() {
        return Err(Error::Interrupted);
    }
    let failed = states.iter().filter(|state| **state == JobState::Failed).count();
    if failed > 0 {
        let message = format!("{failed} of {} jobs failed", mine.len());
        let help = format!("see NAME.job.json in {}", jobs.output.display());
        return Err(Error::input(jobs.file.display().to_string(), "", message, help));
    }
    let doubtful = states.iter().filter(|state| **state == JobState::NotConverged).count();
    if doubtful > 0 {
        let reason = format!(
            "{doubtful} of {} jobs ended early, did not converge or have an empty result: see NAME.job.json in {}",
            mine.len(),
            jobs.output.display()
        );
        return Err(Error::NotConverged(reason.into()));
    }
    Ok(())
}

/// Position of a finished job among those of the shard.
#[derive(Debug, Clone, Copy)]
struct Position {
    /// Number of the job in the order of completion, from 1.
    number: usize,
    /// Jobs of the shard.
    count: usize,
}

/// Prints the outcome of a job.
fn print(arguments: &Arguments, job: &Job, outcome: &JobOutcome, position: Position) {
    let (JobOutcome { record, skipped }, Position { number, count }) = (outcome, position);
    let skipped = *skipped;
    if arguments.json {
        let line = json!({
            "job": job.name, "state": record.state, "skipped": skipped, "tries": record.attempts,
            "wall_s": record.wall_s, "number": number, "of": count, "message": record.message,
        });
        return console::message(&line.to_string());
    }
    let state = match record.state {
        _ if skipped => "done before".to_owned(),
        JobState::Done => format!("done in {:.1} s", record.wall_s),
        JobState::NotConverged => {
            format!("done in {:.1} s, not converged or empty: see its report", record.wall_s)
        }
        JobState::Interrupted => "interrupted".to_owned(),
        JobState::Begun | JobState::Failed => format!("failed: {}", record.message.replace('\n', "; ")),
    };
    if !arguments.quiet || record.state == JobState::Failed {
        console::message(&format!("[{number}/{count}] {}: {state}", job.name));
    }
}
