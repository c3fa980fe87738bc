//! The lock of a run, OUT.lock: two runs with one OUT would mix their frames and checkpoints. The system frees it when its process ends,
//! however it ends; the file is removed at the end of the run.

use crate::files::read::file_name;
use crease_model::error::{Error, Result};
use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Lock of the outputs of one run, held until it is dropped.
#[derive(Debug)]
pub struct RunLock {
    path: PathBuf,
    /// Folder that was made for the file.
    made: Option<PathBuf>,
    /// The file; `None` once it is free.
    file: Option<File>,
}

impl RunLock {
    /// Takes the lock of the worn garment `worn`; makes its folder. `None` where the file system has no locks.
    ///
    /// # Errors
    /// [`Error::Input`] if another run has it; [`Error::File`] if the file cannot be made.
    pub fn take(worn: &Path) -> Result<Option<Self>> {
        let path = worn.with_extension("lock");
        let failed = |source| Error::File { file: file_name(&path), source };
        let refuse = |message: &str, help: &str| Err(Error::input(file_name(worn), "", message, help));
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        if let Some(folder) = folder {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        let made = folder.map(Path::to_owned);
        loop {
            match path.symlink_metadata() {
                Ok(there) if !there.is_file() => {
                    return refuse(
                        "its lock, the file beside it that ends in .lock, is a link or a folder",
                        "remove it, or choose another name for the output",
                    );
                }
                _ => {}
            }
            let file =
                File::options().create(true).truncate(false).write(true).open(&path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) if is_at(&file, &path) => return Ok(Some(Self { path, made, file: Some(file) })),
                // The run that had it has removed the file since.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return refuse(
                        "another run writes it now",
                        "wait for the end of that run, or choose another name for the output",
                    );
                }
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                    let _ = std::fs::remove_file(&path);
                    return Ok(None);
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
        }
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        // Removed while it is locked, or it could be that of the next run.
        let _ = std::fs::remove_file(&self.path);
        drop(self.file.take());
        // Fails if something was written there.
        if let Some(folder) = &self.made {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Whether `file` is the one at `path` still.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |data: &std::fs::Metadata| (data.dev(), data.ino());
    matches!((file.metadata(), path.metadata()), (Ok(a), Ok(b)) if place(&a) == place(&b))
}

#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_run_at_a_time_has_the_lock_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let worn = folder.path().join("new/out.glb");
        let first = RunLock::take(&worn).expect("is free").expect("there are locks");
        let text = RunLock::take(&worn).expect_err("is taken").to_string();
        assert!(text.contains("out.glb: another run writes it now"), "{text}");
        drop(first);
        assert!(!folder.path().join("new").exists());
        // A run that was killed leaves the file without a lock.
        std::fs::write(folder.path().join("out.lock"), "").expect("writes");
        drop(RunLock::take(&folder.path().join("out.glb")).expect("is free"));
        assert_eq!(std::fs::read_dir(folder.path()).expect("lists").count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_its_place_is_not_followed() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("made-by-a-link");
        std::os::unix::fs::symlink(&target, folder.path().join("out.lock")).expect("links");
        assert!(
            RunLock::take(&folder.path().join("out.glb"))
                .expect_err("is refused")
                .to_string()
                .contains("a link")
        );
        assert!(!target.exists());
    }
}
