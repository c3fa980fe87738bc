//! One job: a call of `crease bake --resume` in its own process, so that a crash affects no other job, and the record of
//! its outcome, NAME.job.json.

use crate::commands::batch::jobs::{Job, Jobs};
use crate::files::input;
use crate::files::output::{Outputs, commit};
use crate::runtime::executable;
use crate::runtime::interrupt::{INTERRUPTED, Interrupt};
use crease::internal::report::Report;
use crease_model::error::{Error, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// State of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Running, or killed while running.
    Begun,
    /// Finished; its outputs exist.
    Done,
    /// Finished without convergence or with an empty result (exit code 3); its outputs exist.
    NotConverged,
    /// Rejected (exit codes 1, 2), or crashed in every attempt.
    Failed,
    /// Stopped on request, with a checkpoint.
    Interrupted,
}

/// Content of NAME.job.json.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JobRecord {
    /// Always crease-job/1.
    pub format: String,
    /// Hash of all inputs.
    #[serde(rename = "key")]
    pub fingerprint: String,
    /// State of the job.
    pub state: JobState,
    /// Exit code of the last attempt; `None` if it was killed.
    pub code: Option<i32>,
    /// Number of attempts.
    #[serde(rename = "tries")]
    pub attempts: u32,
    /// Wall time of all attempts of this run of the batch [s].
    pub wall_s: f64,
    /// Error messages of a failed job.
    pub message: String,
    /// Hash of each output by file name.
    pub outputs: BTreeMap<String, String>,
}

impl JobRecord {
    fn new(fingerprint: String) -> Self {
        Self {
            format: "crease-job/1".to_owned(),
            fingerprint,
            state: JobState::Begun,
            code: None,
            attempts: 0,
            wall_s: 0.0,
            message: String::new(),
            outputs: BTreeMap::new(),
        }
    }

    /// Reads the record that an earlier run of the batch has left.
    pub fn read(jobs: &Jobs, job: &Job) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(record_path(jobs, job)).ok()?).ok()
    }

    fn write(&self, jobs: &Jobs, job: &Job) -> Result<()> {
        let mut outputs = Outputs::new([]);
        outputs.add(&record_path(jobs, job), format!("{:#}\n", serde_json::json!(self)).as_bytes())?;
        commit(outputs)
    }

    /// Whether the job has finished with these inputs and all its outputs exist unchanged.
    pub fn is_valid(&self, jobs: &Jobs, fingerprint: &str) -> bool {
        let is_unchanged =
            |(name, hash): (&String, &String)| hash_of(&jobs.output.join(name)).as_ref() == Some(hash);
        self.fingerprint == fingerprint
            && matches!(self.state, JobState::Done | JobState::NotConverged)
            && !self.outputs.is_empty()
            && self.outputs.iter().all(is_unchanged)
    }
}

fn record_path(jobs: &Jobs, job: &Job) -> PathBuf {
    jobs.worn(job).with_extension("job.json")
}

fn hash_of(path: &Path) -> Option<String> {
    let bytes = std::fs::read(path).ok()?;
    Some(Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Extensions of the outputs of `crease bake`.
const OUTPUT_EXTENSIONS: [&str; 3] = ["glb", "crease.json", "report.json"];

/// Settings of all jobs.
#[derive(Debug, Clone, Copy)]
pub struct JobSettings {
    /// Worker threads of a job.
    pub threads: usize,
    /// Retries after a crash.
    pub retries: u32,
}

/// Outcome of a job.
#[derive(Debug)]
pub struct JobOutcome {
    /// Record of the job.
    pub record: JobRecord,
    /// Whether it had finished before.
    pub skipped: bool,
}

/// Runs a job to its end, unless it has finished before.
pub fn run(jobs: &Jobs, job: &Job, settings: JobSettings, interrupt: &Interrupt) -> Result<JobOutcome> {
    let fingerprint = jobs.fingerprint(job)?;
    let worn = jobs.worn(job);
    match JobRecord::read(jobs, job) {
        Some(record) if record.is_valid(jobs, &fingerprint) => {
            return Ok(JobOutcome { record, skipped: true });
        }
        Some(record) if record.fingerprint == fingerprint => {}
        // A checkpoint of other inputs cannot be resumed.
        _ => drop(std::fs::remove_file(worn.with_extension("checkpoint"))),
    }
    let mut record = JobRecord::new(fingerprint);
    record.write(jobs, job)?;
    let started = Instant::now();
    let log = worn.with_extension("log");
    while record.state == JobState::Begun {
        let status = attempt(jobs, job, settings.threads, &log, interrupt)?;
        record.attempts += 1;
        record.code = status.code();
        record.state = match record.code {
            _ if interrupt.is_requested() && !status.success() => JobState::Interrupted,
            Some(0) => JobState::Done,
            Some(3) => JobState::NotConverged,
            Some(1 | 2) => JobState::Failed,
            _ if record.attempts > settings.retries => JobState::Failed,
            _ => JobState::Begun,
        };
    }
    record.wall_s = started.elapsed().as_secs_f64();
    match record.state {
        JobState::NotConverged if has_stopped(&worn) => record.message = end_of_log(&log, String::new()),
        JobState::Done | JobState::NotConverged => {
            for extension in OUTPUT_EXTENSIONS {
                let path = worn.with_extension(extension);
                let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                // The report holds wall times, which differ between runs, and is not hashed.
                if let (Some(name), Some(hash), true) = (name, hash_of(&path), extension != "report.json") {
                    record.outputs.insert(name, hash);
                }
            }
            let _ = std::fs::remove_file(&log);
        }
        _ => record.message = end_of_log(&log, describe_code(record.code)),
    }
    record.write(jobs, job)?;
    Ok(JobOutcome { record, skipped: false })
}

/// Whether the report beside `worn` is of a run that ended before its script and made no garment.
fn has_stopped(worn: &Path) -> bool {
    let bytes = std::fs::read(worn.with_extension("report.json")).unwrap_or_default();
    serde_json::from_slice::<Report>(&bytes).is_ok_and(|report| report.stopped.is_some())
}

fn describe_code(code: Option<i32>) -> String {
    match code {
        Some(code) if code == i32::from(INTERRUPTED) => "interrupted".to_owned(),
        Some(code) => format!("ended with code {code}"),
        None => "was killed".to_owned(),
    }
}

/// Returns the last lines of a log.
fn end_of_log(log: &Path, otherwise: String) -> String {
    let text =
        std::fs::read(log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    match lines.as_slice() {
        [] => otherwise,
        lines => lines[lines.len().saturating_sub(10)..].join("\n"),
    }
}

/// Interval at which a running job is polled.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Runs the process of a job once.
fn attempt(jobs: &Jobs, job: &Job, threads: usize, log: &Path, interrupt: &Interrupt) -> Result<ExitStatus> {
    let failed = |source| Error::File { file: input::name_of(log), source };
    let log_file = std::fs::File::create(log).map_err(failed)?;
    let mut command = Command::new(executable::path()?);
    // Paths are passed as written in the job file, since the outputs contain them.
    command.current_dir(&jobs.folder).args([
        "bake",
        &job.garment,
        "--wear",
        &job.wear,
        "--fabric",
        &job.fabric,
    ]);
    command.arg("-o").arg(jobs.worn(job)).args(["--resume", "--quiet", "--threads", &threads.to_string()]);
    if let Some(folder) = &jobs.allow_folder {
        command.arg("--allow-folder").arg(folder);
    }
    command.args(&jobs.bake).stdin(Stdio::null()).stdout(Stdio::null()).stderr(log_file);
    let mut child = command.spawn().map_err(failed)?;
    let mut notified = false;
    loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            return Ok(status);
        }
        if interrupt.is_requested() && !notified {
            notified = true;
            request_stop(&mut child);
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// Asks a job to write a checkpoint and stop, or kills it where signals are not available. Its last checkpoint stays valid.
fn request_stop(child: &mut Child) {
    let sent = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    if !sent.is_ok_and(|status| status.success()) {
        let _ = child.kill();
    }
}
