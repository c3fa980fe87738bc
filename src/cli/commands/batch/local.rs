//! Jobs on this machine: N at a time, each in a process of its own.

use crate::cli::commands::batch::job;
use crate::cli::commands::batch::job::{JobState, Record, Running};
use crate::cli::commands::batch::jobs::{Job, Jobs};
use crate::cli::commands::batch::{Arguments, Shard};
use crate::cli::runtime::console;
use crate::cli::runtime::interrupt::Interrupt;
use crease::{Error, Result};
use serde_json::json;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs the jobs of a shard, or all. Jobs that fail do not stop the others; that any failed is the error.
pub fn run(jobs: &Jobs, arguments: &Arguments, interrupt: &Interrupt) -> Result<()> {
    let shard = arguments.shard.unwrap_or(Shard::ALL);
    let mine: Vec<&Job> =
        jobs.list.iter().enumerate().filter(|(number, _)| shard.holds(*number)).map(|(_, job)| job).collect();
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let at_once = arguments.parallel.map_or(processors, usize::from).min(mine.len()).max(1);
    let threads = arguments.threads.map_or((processors / at_once).max(1), usize::from);
    let how = Running { threads, retries: arguments.retries };
    let next = AtomicUsize::new(0);
    let outcomes: Mutex<Vec<Result<JobState>>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                while let Some(job) = mine.get(next.fetch_add(1, Ordering::SeqCst)) {
                    if interrupt.asked() {
                        return;
                    }
                    let outcome = job::run(jobs, job, how, interrupt);
                    if let Ok(mut outcomes) = outcomes.lock() {
                        let number = outcomes.len() + 1;
                        outcomes.push(outcome.map(|(record, skipped)| {
                            tell(arguments, job, &record, skipped, [number, mine.len()]);
                            record.state
                        }));
                    }
                }
            });
        }
    });
    let states: Vec<JobState> =
        outcomes.into_inner().unwrap_or_default().into_iter().collect::<Result<_>>()?;
    if interrupt.asked() {
        return Err(Error::Interrupted);
    }
    let failed = states.iter().filter(|state| **state == JobState::Failed).count();
    if failed > 0 {
        let what = format!("{failed} of {} jobs failed", mine.len());
        let cure = format!("see NAME.job.json in {}", jobs.output.display());
        return Err(Error::input(jobs.file.display().to_string(), "", what, cure));
    }
    Ok(())
}

fn tell(arguments: &Arguments, job: &Job, record: &Record, skipped: bool, [number, of]: [usize; 2]) {
    if arguments.json {
        let news = json!({
            "job": job.name, "state": record.state, "skipped": skipped, "tries": record.tries,
            "wall_s": record.wall_s, "number": number, "of": of, "message": record.message,
        });
        return console::say(&news.to_string());
    }
    let state = match record.state {
        _ if skipped => "done before".to_owned(),
        JobState::Done => format!("done in {:.1} s", record.wall_s),
        JobState::NotConverged => format!("done in {:.1} s, not at rest", record.wall_s),
        JobState::Interrupted => "interrupted".to_owned(),
        JobState::Begun | JobState::Failed => format!("failed: {}", record.message),
    };
    if !arguments.quiet || record.state == JobState::Failed {
        console::say(&format!("[{number}/{of}] {}: {state}", job.name));
    }
}
