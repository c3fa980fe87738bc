//! The checkpoint file of a run, OUT.checkpoint: written after every action, at intervals within actions, and when the
//! run is asked to stop. It is written under another name and then renamed, and removed when the results are written.
//!
//! Failure to write a checkpoint (a full disk) is only a notice, as the run itself may still succeed.

use crate::bake::Checkpoint;
use crate::files::output::is_stream;
use crate::files::read::{file_name, read_bytes};
use crease_model::error::Result;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Minimum time between checkpoints at action boundaries, so that short actions do not each write one.
const MIN_ACTION_INTERVAL: Duration = Duration::from_secs(1);

/// Checkpoint that an earlier run has left.
#[derive(Debug)]
pub struct SavedCheckpoint {
    /// Name of its file, for messages.
    pub file: String,
    /// Its content.
    pub checkpoint: Checkpoint,
}

/// Writer of the latest checkpoint of one run; it writes none for a garment that goes to the standard output.
#[derive(Debug)]
pub struct CheckpointFile {
    path: Option<PathBuf>,
    /// Minimum time between checkpoints within an action.
    interval: Duration,
    last_write: Instant,
    /// Latest checkpoint, if it is not written yet.
    pending: Option<Checkpoint>,
    /// Whether a failure to write has been reported.
    failed: bool,
}

impl CheckpointFile {
    /// Creates the writer for the worn garment `worn`, with at most one checkpoint per `interval` within actions.
    pub fn beside(worn: &Path, interval: Duration) -> Self {
        let path = (!is_stream(worn)).then(|| worn.with_extension("checkpoint"));
        Self { path, interval, last_write: Instant::now(), pending: None, failed: false }
    }

    /// Path of the checkpoint file.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Reads the checkpoint of an earlier run; `None` if there is none.
    pub fn read(&self) -> Result<Option<SavedCheckpoint>> {
        let Some(path) = self.path().filter(|path| path.exists()) else { return Ok(None) };
        let file = file_name(path);
        let checkpoint = Checkpoint::parse(&file, &read_bytes(path)?)?;
        Ok(Some(SavedCheckpoint { file, checkpoint }))
    }

    /// Accepts the next checkpoint and writes it if the interval has passed. Returns what [`Self::flush`] does.
    pub fn update(&mut self, now: Checkpoint) -> Option<String> {
        let wait = if now.position.is_before_action() {
            self.interval.min(MIN_ACTION_INTERVAL)
        } else {
            self.interval
        };
        self.pending = Some(now);
        if self.last_write.elapsed() >= wait {
            return self.flush();
        }
        None
    }

    /// Writes the latest checkpoint if it is not written yet. Returns a warning for the first that cannot be written.
    pub fn flush(&mut self) -> Option<String> {
        let (checkpoint, path) = (self.pending.take()?, self.path.as_ref()?);
        let written = write(path, &checkpoint.to_bytes());
        self.last_write = Instant::now();
        let error = written.err().filter(|_| !self.failed)?;
        self.failed = true;
        Some(format!("{}: {error}; the run continues without checkpoints", file_name(path)))
    }

    /// Removes the checkpoint of a finished run. Failures are ignored, since a leftover checkpoint does no harm.
    pub fn remove(&self) {
        if let Some(path) = &self.path {
            let _ = std::fs::remove_file(path);
            let _ = std::fs::remove_file(part_path(path));
        }
    }
}

/// Temporary name of the checkpoint `path`; always the same, so that a run that is killed repeatedly does not fill the folder.
fn part_path(path: &Path) -> PathBuf {
    path.with_extension("checkpoint-part")
}

/// Writes the checkpoint `path` whole or not at all.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // The folder of the outputs is made with the first file in it.
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)?;
    }
    let mut file = File::create(part_path(path))?;
    file.write_all(bytes)?;
    file.sync_all()?;
    std::fs::rename(part_path(path), path)
}
