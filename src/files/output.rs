//! Output files, written whole or not at all: under temporary names in the same folder, and renamed together at the end.
//! An interrupted or failed run leaves existing files untouched.

use crate::files::read::{STANDARD_STREAM, file_name};
use crease_model::error::{Error, Result};
use std::fs::{File, Permissions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Writes the content of a file.
type WriteContent<'a> = dyn Fn(&mut dyn Write) -> std::io::Result<()> + 'a;

/// Files to be written together. Dropping it without [`Outputs::commit`] discards them.
#[derive(Debug)]
pub struct Outputs {
    /// Input files of the command, which must not be overwritten.
    inputs: Vec<PathBuf>,
    pending: Vec<PendingFile>,
    /// Bytes for the standard output.
    stream: Vec<u8>,
}

#[derive(Debug)]
struct PendingFile {
    target: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// Complete file under a temporary name in the same folder.
    Temporary(NamedTempFile),
    /// Bytes for a device or a pipe, which renaming would replace.
    Direct(Vec<u8>),
}

impl Outputs {
    /// Creates an empty list of outputs, none of which may be one of `inputs`.
    pub fn new<'a>(inputs: impl IntoIterator<Item = &'a Path>) -> Self {
        let inputs = inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect();
        Self { inputs, pending: Vec::new(), stream: Vec::new() }
    }

    /// Checks that `path` can be written; `-` is the standard output. To be called before a long run.
    pub fn check(&self, path: &Path) -> Result<()> {
        if is_stream(path) {
            return Ok(());
        }
        let refuse = |message: &str, help: &str| Err(Error::input(output_name(path), "", message, help));
        if path.is_dir() {
            return refuse("is a folder, cannot be written as a file", "name a file in it");
        }
        if path.canonicalize().is_ok_and(|real| self.inputs.contains(&real)) {
            return refuse(
                "is read by this command and would be overwritten",
                "give the output another name",
            );
        }
        // A folder that does not exist is made when the file is written; its nearest ancestor has to take it.
        let folder = folder_of(path).ancestors().map(or_current).find(|folder| folder.exists());
        let folder = folder.unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return refuse("its folder is a file", "choose another folder");
        }
        // Creating a file is the only reliable test; permissions alone do not suffice.
        let is_ordinary_file = !path.exists() || path.is_file();
        if is_ordinary_file && tempfile::tempfile_in(folder).is_err() {
            return refuse(
                "its folder cannot be written to",
                "choose another folder, or change its permissions",
            );
        }
        Ok(())
    }

    /// Adds the file `path` with the content `bytes`; it appears on commit.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        self.add_written(path, &|out| out.write_all(bytes))
    }

    /// Adds the file `path` with what `write` writes, which need not be in memory as a whole; it appears on commit.
    pub fn add_written(&mut self, path: &Path, write: &WriteContent) -> Result<()> {
        self.check(path)?;
        if is_stream(path) {
            return write(&mut self.stream).map_err(|source| failed(path, source));
        }
        std::fs::create_dir_all(folder_of(path)).map_err(|source| failed(path, source))?;
        // Symbolic links are followed, so that they stay links.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let content = if target.exists() && !target.is_file() {
            let mut bytes = Vec::new();
            write(&mut bytes).map_err(|source| failed(path, source))?;
            Content::Direct(bytes)
        } else {
            Content::Temporary(write_temporary(&target, write).map_err(|source| failed(path, source))?)
        };
        self.pending.push(PendingFile { target, content });
        Ok(())
    }

    /// Names of the files in the order in which they were added, and their sizes [bytes].
    pub fn sizes(&self) -> Vec<(String, u64)> {
        let size = |pending: &PendingFile| match &pending.content {
            Content::Temporary(file) => file.as_file().metadata().map_or(0, |data| data.len()),
            Content::Direct(bytes) => bytes.len() as u64,
        };
        self.pending.iter().map(|pending| (file_name(&pending.target), size(pending))).collect()
    }

    /// Renames all files to their final names. Returns the bytes for the standard output.
    pub fn commit(self) -> Result<Vec<u8>> {
        for PendingFile { target, content } in self.pending {
            match content {
                Content::Temporary(file) => file.persist(&target).map(drop).map_err(|e| e.error),
                Content::Direct(bytes) => {
                    File::options().write(true).open(&target).and_then(|mut f| f.write_all(&bytes))
                }
            }
            .map_err(|source| failed(&target, source))?;
        }
        Ok(self.stream)
    }
}

/// The path as the user wrote it, for messages; `-` is the standard output.
pub fn output_name(path: &Path) -> String {
    if is_stream(path) { "standard output".to_owned() } else { file_name(path) }
}

/// Whether `path` is the standard output.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new(STANDARD_STREAM)
}

fn folder_of(path: &Path) -> &Path {
    or_current(path.parent().unwrap_or(Path::new("")))
}

/// The folder, or the current one for an empty path.
fn or_current(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

fn write_temporary(target: &Path, write: &WriteContent) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".crease-").suffix(".tmp");
    // Temporary files are private by default; outputs get ordinary permissions.
    let permissions = target.metadata().map(|there| there.permissions()).ok().or_else(default_permissions);
    if let Some(permissions) = permissions.clone() {
        builder.permissions(permissions);
    }
    let mut file = builder.tempfile_in(folder_of(target))?;
    let mut buffered = BufWriter::new(file.as_file_mut());
    write(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    file.as_file().sync_all()?;
    Ok(file)
}

/// Permissions 666, from which the system subtracts the user's umask.
#[cfg(unix)]
fn default_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn default_permissions() -> Option<Permissions> {
    None
}

fn failed(path: &Path, source: std::io::Error) -> Error {
    Error::File { file: output_name(path), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_together_on_commit_and_not_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let (a, b) = (folder.path().join("a.glb"), folder.path().join("a.json"));
        std::fs::write(&b, "before").expect("writes");
        let mut outputs = Outputs::new([]);
        outputs.add(&a, b"one").expect("adds");
        outputs.add(&b, b"two").expect("adds");
        assert!(!a.exists());
        assert_eq!(std::fs::read(&b).expect("reads"), b"before");
        outputs.commit().expect("commits");
        assert_eq!(
            (std::fs::read(&a).expect("reads"), std::fs::read(&b).expect("reads")),
            (b"one".to_vec(), b"two".to_vec())
        );
        assert_eq!(std::fs::read_dir(folder.path()).expect("lists").count(), 2);
    }

    #[test]
    fn without_commit_nothing_is_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut outputs = Outputs::new([]);
        outputs.add(&folder.path().join("a"), b"one").expect("adds");
        drop(outputs);
        assert_eq!(std::fs::read_dir(folder.path()).expect("lists").count(), 0);
    }

    #[test]
    fn inputs_and_folders_are_refused_and_missing_folders_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let input = folder.path().join("in.glb");
        std::fs::write(&input, "mesh").expect("writes");
        let mut outputs = Outputs::new([input.as_path()]);
        let mut message = |path: &Path| outputs.add(path, b"x").expect_err("refused").to_string();
        assert!(message(&folder.path().join("./in.glb")).contains("would be overwritten"));
        assert!(message(folder.path()).contains("is a folder"));
        assert!(message(&input.join("out.glb")).contains("its folder is a file"));
        assert_eq!(std::fs::read(&input).expect("reads"), b"mesh");
        let deep = folder.path().join("none/deeper/out.glb");
        outputs.check(&deep).expect("can be made");
        assert!(!folder.path().join("none").exists(), "checking makes nothing");
        outputs.add(&deep, b"new").expect("adds");
        outputs.commit().expect("commits");
        assert_eq!(std::fs::read(&deep).expect("reads"), b"new");
    }

    /// Nobody can create a file in /proc.
    #[cfg(target_os = "linux")]
    #[test]
    fn unwritable_folders_are_refused_beforehand() {
        let refusal = Outputs::new([]).check(Path::new("/proc/out.glb")).expect_err("is refused");
        assert!(refusal.to_string().contains("cannot be written to"), "{refusal}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_links_stay_what_they_are() {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt};
        let folder = tempfile::tempdir().expect("a folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        std::fs::write(&real, "old").expect("writes");
        std::fs::set_permissions(&real, Permissions::from_mode(0o640)).expect("sets");
        std::os::unix::fs::symlink(&real, &link).expect("links");
        let fresh = folder.path().join("fresh");
        let mut outputs = Outputs::new([]);
        outputs.add(Path::new("/dev/null"), b"x").expect("adds");
        outputs.add(&link, b"new").expect("adds");
        outputs.add(&fresh, b"new").expect("adds");
        outputs.commit().expect("commits");
        assert!(std::fs::metadata("/dev/null").expect("is there").file_type().is_char_device());
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&real).expect("reads"), b"new");
        let mode = |path: &Path| path.metadata().expect("is there").permissions().mode() & 0o777;
        assert_eq!(mode(&real), 0o640);
        // The same as any other program's file: 666 minus the umask.
        let plain = folder.path().join("plain");
        std::fs::write(&plain, "").expect("writes");
        assert_eq!(mode(&fresh), mode(&plain));
    }
}
