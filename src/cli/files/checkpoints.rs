//! The checkpoint of a run on the disk, OUT.checkpoint: written after every action, now and then between, and when
//! the run is asked to stop; always whole, under another name first. Gone when the results are there.
//!
//! A checkpoint that cannot be written (a full disk) is a warning: the run may still end well.

use crate::cli::files::input;
use crate::cli::runtime::console;
use crease::Result;
use crease::bake::Checkpoint;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Short actions that follow one another faster than this share a checkpoint.
const AFTER_ACTION: Duration = Duration::from_secs(1);

/// Keeps the latest checkpoint of one run.
#[derive(Debug)]
pub struct CheckpointFile {
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// The latest one, if it is not on the disk yet.
    waiting: Option<Checkpoint>,
    failed: bool,
}

impl CheckpointFile {
    /// Beside the worn garment `worn`; between actions at most once in `every`.
    pub fn beside(worn: &Path, every: Duration) -> Self {
        let path = worn.with_extension("checkpoint");
        Self { path, every, written: Instant::now(), waiting: None, failed: false }
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What an earlier run left, with its name for messages.
    pub fn read(&self) -> Result<Option<(String, Checkpoint)>> {
        if !self.path.exists() {
            return Ok(None);
        }
        let file = input::name_of(&self.path);
        let checkpoint = Checkpoint::parse(&file, &input::bytes(&self.path)?)?;
        Ok(Some((file, checkpoint)))
    }

    /// Takes the next one.
    pub fn keep(&mut self, now: Checkpoint) {
        let wait = if now.position.is_before_action() { self.every.min(AFTER_ACTION) } else { self.every };
        self.waiting = Some(now);
        if self.written.elapsed() >= wait {
            self.flush();
        }
    }

    /// Writes the latest one if it is not on the disk yet.
    pub fn flush(&mut self) {
        let Some(checkpoint) = self.waiting.take() else { return };
        let written = self.write(&checkpoint.to_bytes());
        self.written = Instant::now();
        if let (Err(error), false) = (&written, self.failed) {
            console::say(&format!(
                "warning: {}: {error}; the run goes on without",
                input::name_of(&self.path)
            ));
            self.failed = true;
        }
    }

    /// Always the same other name, so that a run that is killed again and again does not fill the folder.
    fn part(&self) -> PathBuf {
        self.path.with_extension("checkpoint-part")
    }

    fn write(&self, bytes: &[u8]) -> std::io::Result<()> {
        let mut file = File::create(self.part())?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(self.part(), &self.path)
    }

    /// The results are there: it is of no more use.
    pub fn remove(&self) {
        // Nobody is worse off if it stays: it is that of a finished run.
        let _ = std::fs::remove_file(&self.path);
        let _ = std::fs::remove_file(self.part());
    }
}
