//! The checkpoint file of a run, OUT.checkpoint: written after every action, at intervals within actions, and when the
//! run is asked to stop. It is written under another name and then renamed, and removed when the results are written.
//!
//! Failure to write a checkpoint (a full disk) is only a notice, as the run itself may still succeed.

use crate::bake::Checkpoint;
use crate::files::output::is_stream;
use crate::files::read::{file_name, folder_of, read_bytes};
use crease_model::error::Result;
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

    /// Removes what a run that was killed while it wrote a checkpoint has left. To be called by the run that has the lock of the outputs.
    pub fn remove_parts(&self) {
        let Some(path) = &self.path else { return };
        let prefix = part_prefix(path);
        for entry in std::fs::read_dir(folder_of(path)).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(&prefix) && name.ends_with(PART_SUFFIX) {
                // A leftover does no harm.
                let _ = std::fs::remove_file(entry.path());
            }
        }
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
        }
    }
}

/// Start of the temporary names of the checkpoint `path`.
fn part_prefix(path: &Path) -> String {
    format!(".{}-", path.file_name().unwrap_or_default().to_string_lossy())
}

/// End of the temporary names of checkpoints.
const PART_SUFFIX: &str = ".part";

/// Writes the checkpoint `path` whole or not at all.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // The folder of the outputs is made with the first file in it.
    let folder = folder_of(path);
    std::fs::create_dir_all(folder)?;
    // A new file with a random part in its name, which is removed if it cannot be written whole.
    let mut builder = tempfile::Builder::new();
    let mut file = builder.prefix(&part_prefix(path)).suffix(PART_SUFFIX).tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map(drop).map_err(|failure| failure.error)
}
