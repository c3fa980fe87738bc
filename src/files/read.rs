//! Whole files and the standard input, with error messages that help.

use crease_model::error::{Error, Result};
use crease_model::json::kind_of_mesh;
use std::fs::{File, FileType};
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::OnceLock;

/// The name of the standard input among the names of input files, and of the standard output among those of outputs; `./-` is a
/// file of that name.
pub const STANDARD_STREAM: &str = "-";

/// Longest file that is read [bytes]: indices have 32 bits, and a file this long cannot overflow them.
pub(super) const MAX_BYTES: u64 = u32::MAX as u64;

/// Start of what Git LFS leaves in the place of a file that was not fetched.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// The path as the user wrote it, for messages; `-` is the standard input.
pub fn file_name(path: &Path) -> String {
    if path == Path::new(STANDARD_STREAM) { "standard input".to_owned() } else { path.display().to_string() }
}

/// The folder of the file `path`; "." for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Reads all bytes of a file, or of the standard input for `-`, which is kept for the life of the process: it can be read once
/// only, and several options may name it.
///
/// # Errors
/// [`Error::Input`] if there is no such file, if it is a folder or not readable for this user; [`Error::File`] otherwise.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let file = file_name(path);
    if path == Path::new(STANDARD_STREAM) {
        return standard_input().map_err(|source| Error::File { file, source });
    }
    // A pipe is what a shell makes of the output of a program.
    read_limited(path, &file, |kind| kind.is_file() || is_pipe(kind), None)
}

/// Reads a regular file that another file names: all of it, or the first `needed` bytes.
///
/// # Errors
/// Those of [`read_bytes`], and [`Error::Input`] if it is a pipe, too.
pub fn read_regular(path: &Path, needed: Option<u64>) -> Result<Vec<u8>> {
    // Opening a pipe would wait for its writer.
    read_limited(path, &file_name(path), |kind| kind.is_file(), needed)
}

/// Reads the file at `path`, called `file`, of a kind that `is_read`, to its end or to `needed` bytes; its length is checked before, where it
/// has one.
fn read_limited(
    path: &Path,
    file: &str,
    is_read: impl Fn(FileType) -> bool,
    needed: Option<u64>,
) -> Result<Vec<u8>> {
    let kind = std::fs::metadata(path).map_err(|source| unreadable(file, source))?.file_type();
    if !is_read(kind) {
        return Err(irregular(file, kind));
    }
    let opened = File::open(path).map_err(|source| unreadable(file, source))?;
    let failed = |source| Error::File { file: file.to_owned(), source };
    let length = opened.metadata().map_err(failed)?.len();
    let wanted = needed.map_or(length, |needed| needed.min(length));
    if wanted > MAX_BYTES {
        return Err(too_long(file));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(wanted as usize).map_err(|_| failed(ErrorKind::OutOfMemory.into()))?;
    let end = needed.unwrap_or(u64::MAX).min(MAX_BYTES + 1);
    opened.take(end).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_long(file));
    }
    if bytes.starts_with(LFS_POINTER) {
        let message = "is the pointer of Git LFS to a file, not the file";
        return Err(Error::input(file, "", message, "fetch the file with `git lfs pull`"));
    }
    Ok(bytes)
}

/// Refuses what is compressed with gzip, which meshes and texts are not.
///
/// # Errors
/// [`Error::Input`] with the cure.
pub(super) fn refuse_gzip(path: &Path, bytes: &[u8]) -> Result<()> {
    if !bytes.starts_with(&[0x1F, 0x8B]) {
        return Ok(());
    }
    Err(Error::input(file_name(path), "", "is compressed with gzip", "unpack it with gunzip"))
}

fn too_long(file: &str) -> Error {
    Error::input(file, "", "longer than 4 GiB", "split it, or leave out what is not the garment")
}

fn irregular(file: &str, kind: FileType) -> Error {
    match kind.is_dir() {
        true => Error::input(file, "", "is a folder, not a file", "name the file in it"),
        false => Error::input(file, "", "is no regular file", "name a file"),
    }
}

#[cfg(unix)]
fn is_pipe(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_kind: FileType) -> bool {
    false
}

/// The error of a file called `file` that cannot be opened.
fn unreadable(file: &str, source: std::io::Error) -> Error {
    match source.kind() {
        ErrorKind::NotFound => {
            Error::input(file, "", "there is no such file", "check the name and the folder")
        }
        ErrorKind::PermissionDenied => {
            Error::input(file, "", "permission denied", "make the file readable for this user")
        }
        _ => Error::File { file: file.to_owned(), source },
    }
}

/// Returns all bytes of the standard input.
fn standard_input() -> std::io::Result<Vec<u8>> {
    static CONTENT: OnceLock<Vec<u8>> = OnceLock::new();
    // The lock is held for all of it: a second reader waits for the content.
    let input = std::io::stdin().lock();
    if let Some(bytes) = CONTENT.get() {
        return Ok(bytes.clone());
    }
    let mut bytes = Vec::new();
    input.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(CONTENT.get_or_init(|| bytes).clone())
}

/// Reads a UTF-8 text file.
///
/// # Errors
/// Those of [`read_bytes`], and [`Error::Input`] with the line of the first byte that is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = read_bytes(path)?;
    refuse_gzip(path, &bytes)?;
    String::from_utf8(bytes).map_err(|broken| {
        if let Some(kind) = kind_of_mesh(broken.as_bytes()) {
            let help = "give the mesh as the garment, and a text file here";
            return Error::input(file_name(path), "", format!("is {kind}, not text"), help);
        }
        let at = broken.utf8_error().valid_up_to();
        let before = broken.as_bytes().get(..at).unwrap_or_default();
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        Error::input(file_name(path), format!("line {line}"), "is not UTF-8 text", "save it as UTF-8")
    })
}

/// Merges the diagnostics of several errors into one error. An error without diagnostics takes precedence.
pub fn merge_errors(errors: impl IntoIterator<Item = Error>) -> Error {
    let mut diagnostics = Vec::new();
    for error in errors {
        match error {
            Error::Input(more) => diagnostics.extend(more),
            other => return other,
        }
    }
    Error::Input(diagnostics)
}

/// Writes a file, or replaces it.
pub(super) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    std::fs::write(path, bytes).map_err(|source| Error::File { file: file_name(path), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_for_another_file_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let refusal = |content: &[u8]| {
            let path = folder.path().join("a.json");
            std::fs::write(&path, content).expect("writes");
            read_text(&path).expect_err("is refused").to_string()
        };
        assert!(
            refusal(b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n").contains("git lfs pull")
        );
        assert!(refusal(&[0x1F, 0x8B, 8, 0]).contains("unpack it with gunzip"));
    }

    #[test]
    fn what_cannot_be_read_is_explained() {
        let folder = tempfile::tempdir().expect("a folder");
        let message = |path: &Path| read_text(path).expect_err("cannot be read").to_string();
        assert!(message(folder.path()).contains("is a folder"));
        assert!(message(&folder.path().join("none.json")).contains("there is no such file"));
        let broken = folder.path().join("broken.json");
        std::fs::write(&broken, b"{\n\xff}").expect("writes");
        assert!(message(&broken).contains("line 2: is not UTF-8"));
    }
}
