//! The checkpoint file of a run, OUT.checkpoint: written after every action, at intervals within actions, and when the
//! run is asked to stop. It is written under another name and then renamed, and removed when the results are written.
//!
//! Failure to write a checkpoint (a full disk) is only a warning, as the run itself may still succeed.

use crate::cli::files::input;
use crate::cli::runtime::console;
use crease::Result;
use crease::bake::Checkpoint;
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

/// Writer of the latest checkpoint of one run.
#[derive(Debug)]
pub struct CheckpointFile {
    path: PathBuf,
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
        let path = worn.with_extension("checkpoint");
        Self { path, interval, last_write: Instant::now(), pending: None, failed: false }
    }

    /// Path of the checkpoint file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the checkpoint of an earlier run; `None` if there is none.
    pub fn read(&self) -> Result<Option<SavedCheckpoint>> {
        if !self.path.exists() {
            return Ok(None);
        }
        let file = input::name_of(&self.path);
        let checkpoint = Checkpoint::parse(&file, &input::bytes(&self.path)?)?;
        Ok(Some(SavedCheckpoint { file, checkpoint }))
    }

    /// Accepts the next checkpoint and writes it if the interval has passed.
    pub fn update(&mut self, now: Checkpoint) {
        let wait = if now.position.is_before_action() {
            self.interval.min(MIN_ACTION_INTERVAL)
        } else {
            self.interval
        };
        self.pending = Some(now);
        if self.last_write.elapsed() >= wait {
            self.flush();
        }
    }

    /// Writes the latest checkpoint if it is not written yet.
    pub fn flush(&mut self) {
        let Some(checkpoint) = self.pending.take() else { return };
        let written = self.write(&checkpoint.to_bytes());
        self.last_write = Instant::now();
        if let (Err(error), false) = (&written, self.failed) {
            console::message(&format!(
                "warning: {}: {error}; the run continues without checkpoints",
                input::name_of(&self.path)
            ));
            self.failed = true;
        }
    }

    /// Temporary name; always the same, so that a run that is killed repeatedly does not fill the folder.
    fn part_path(&self) -> PathBuf {
        self.path.with_extension("checkpoint-part")
    }

    fn write(&self, bytes: &[u8]) -> std::io::Result<()> {
        // The folder of the outputs is made with the first file in it.
        if let Some(folder) = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)?;
        }
        let mut file = File::create(self.part_path())?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(self.part_path(), &self.path)
    }

    /// Removes the checkpoint of a finished run. Failures are ignored, since a leftover checkpoint does no harm.
    pub fn remove(&self) {
        let _ = std::fs::remove_file(&self.path);
        let _ = std::fs::remove_file(self.part_path());
    }
}
