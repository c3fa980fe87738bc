//! One job: a call of `crease bake --resume` in a process of its own, so that whatever happens to it happens to it
//! alone, and the record of how it went, NAME.job.json.

use crate::cli::commands::batch::jobs::{Job, Jobs};
use crate::cli::files::input;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::interrupt::{INTERRUPTED, Interrupt};
use crease::{Error, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How a job went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// Under way, or killed on the way.
    Begun,
    /// Its files are there.
    Done,
    /// Its files are there, but the end is no state of rest (exit code 3).
    NotConverged,
    /// It was refused (exit codes 1, 2) or broke down again and again.
    Failed,
    /// It was asked to stop and left a checkpoint.
    Interrupted,
}

/// What NAME.job.json says.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Record {
    /// Always crease-job/1.
    pub format: String,
    /// Hash of what goes in.
    pub key: String,
    /// How it went.
    pub state: JobState,
    /// Exit code of the last try; `None` if it was killed.
    pub code: Option<i32>,
    /// Processes started.
    pub tries: u32,
    /// Seconds, over all tries of this run of the batch.
    pub wall_s: f64,
    /// What it said when it failed.
    pub message: String,
    /// Hash by name of each file that came out.
    pub outputs: BTreeMap<String, String>,
}

impl Record {
    fn begun(key: String) -> Self {
        Self {
            format: "crease-job/1".to_owned(),
            key,
            state: JobState::Begun,
            code: None,
            tries: 0,
            wall_s: 0.0,
            message: String::new(),
            outputs: BTreeMap::new(),
        }
    }

    /// What an earlier run of the batch wrote about the job.
    pub fn read(jobs: &Jobs, job: &Job) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(record_path(jobs, job)).ok()?).ok()
    }

    fn write(&self, jobs: &Jobs, job: &Job) -> Result<()> {
        let mut outputs = Outputs::new([]);
        outputs.add(&record_path(jobs, job), format!("{:#}\n", serde_json::json!(self)).as_bytes())?;
        outputs.commit()
    }

    /// Whether everything it says came out is there, unchanged.
    pub fn stands(&self, jobs: &Jobs, key: &str) -> bool {
        let there =
            |(name, hash): (&String, &String)| hash_of(&jobs.output.join(name)).as_ref() == Some(hash);
        self.key == key
            && matches!(self.state, JobState::Done | JobState::NotConverged)
            && !self.outputs.is_empty()
            && self.outputs.iter().all(there)
    }
}

fn record_path(jobs: &Jobs, job: &Job) -> PathBuf {
    jobs.worn(job).with_extension("job.json")
}

fn hash_of(path: &Path) -> Option<String> {
    let bytes = std::fs::read(path).ok()?;
    Some(Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// What `crease bake` writes beside OUT.glb, by ending.
const OUTPUTS: [&str; 3] = ["glb", "crease.json", "report.json"];

/// How jobs are run.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    /// Threads of the job.
    pub threads: usize,
    /// Further tries after it was killed or broke down.
    pub retries: u32,
}

/// Runs a job to its end unless that has been done; also whether it was skipped.
pub fn run(jobs: &Jobs, job: &Job, how: Running, interrupt: &Interrupt) -> Result<(Record, bool)> {
    let key = jobs.key(job)?;
    let worn = jobs.worn(job);
    match Record::read(jobs, job) {
        Some(record) if record.stands(jobs, &key) => return Ok((record, true)),
        Some(record) if record.key == key => {}
        // What an older version of the job left to go on from is of no use.
        _ => drop(std::fs::remove_file(worn.with_extension("checkpoint"))),
    }
    let mut record = Record::begun(key);
    record.write(jobs, job)?;
    let began = Instant::now();
    let log = worn.with_extension("log");
    while record.state == JobState::Begun {
        let status = one_try(jobs, job, how.threads, &log, interrupt)?;
        record.tries += 1;
        record.code = status.code();
        record.state = match record.code {
            _ if interrupt.asked() && !status.success() => JobState::Interrupted,
            Some(0) => JobState::Done,
            Some(3) => JobState::NotConverged,
            Some(1 | 2) => JobState::Failed,
            _ if record.tries > how.retries => JobState::Failed,
            _ => JobState::Begun,
        };
    }
    record.wall_s = began.elapsed().as_secs_f64();
    match record.state {
        JobState::Done | JobState::NotConverged => {
            for ending in OUTPUTS {
                let path = worn.with_extension(ending);
                let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                // The report says how long it took, and differs from run to run: it is not hashed.
                if let (Some(name), Some(hash), true) = (name, hash_of(&path), ending != "report.json") {
                    record.outputs.insert(name, hash);
                }
            }
            let _ = std::fs::remove_file(&log);
        }
        _ => record.message = last_words(&log, status_words(record.code)),
    }
    record.write(jobs, job)?;
    Ok((record, false))
}

fn status_words(code: Option<i32>) -> String {
    match code {
        Some(code) if code == i32::from(INTERRUPTED) => "interrupted".to_owned(),
        Some(code) => format!("ended with code {code}"),
        None => "was killed".to_owned(),
    }
}

/// The end of what the job said.
fn last_words(log: &Path, otherwise: String) -> String {
    let text =
        std::fs::read(log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    match lines.as_slice() {
        [] => otherwise,
        lines => lines[lines.len().saturating_sub(10)..].join("\n"),
    }
}

/// How often a job is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(20);

fn one_try(jobs: &Jobs, job: &Job, threads: usize, log: &Path, interrupt: &Interrupt) -> Result<ExitStatus> {
    let failed = |source| Error::File { file: input::name_of(log), source };
    let log_file = std::fs::File::create(log).map_err(failed)?;
    let own = std::env::current_exe().map_err(|source| Error::File { file: "crease".to_owned(), source })?;
    let mut command = Command::new(own);
    // Paths as the job file has them, from its folder: they stand in what comes out.
    command.current_dir(&jobs.folder).args([
        "bake",
        &job.garment,
        "--wear",
        &job.wear,
        "--fabric",
        &job.fabric,
    ]);
    command.arg("-o").arg(jobs.worn(job)).args(["--resume", "--quiet", "--threads", &threads.to_string()]);
    command.args(&jobs.bake).stdin(Stdio::null()).stdout(Stdio::null()).stderr(log_file);
    let mut child = command.spawn().map_err(failed)?;
    let mut told = false;
    loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            return Ok(status);
        }
        if interrupt.asked() && !told {
            told = true;
            ask_to_stop(&mut child);
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

/// Asks a job to leave a checkpoint and stop; kills it where there is no asking. Its last checkpoint is good either way.
fn ask_to_stop(child: &mut Child) {
    let asked = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    if !asked.is_ok_and(|status| status.success()) {
        let _ = child.kill();
    }
}
