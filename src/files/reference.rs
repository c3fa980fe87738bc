//! Files that a file names: a buffer or a picture of a glTF, a layer of a USD stage, the sidecar of a worn mesh, a frame of a folder,
//! the inputs of a batch. A file of a stranger may name anything, so only what lies in its folder or below is read, after links are
//! resolved, or in one more folder that the user allows; and only what is a regular file.

use crate::files::read::{STANDARD_STREAM, file_name, read_regular};
use crease_model::error::{Error, Message, Result, Setting};
use std::path::{Component, Path, PathBuf};

/// Folders in which the files that a file names may lie.
#[derive(Debug, Clone)]
pub struct ReferenceFolders {
    /// File that names the others, for messages.
    file: PathBuf,
    /// Its folder, as the user named it.
    base: PathBuf,
    /// Folders without links.
    allowed: Vec<PathBuf>,
    /// What to do about a file outside of them; `None` where the user can allow a folder.
    cure: Option<&'static str>,
}

/// Returns the path of the sidecar of the worn mesh `file`, which names it `name`: the one called as the mesh is, if there is one, as a
/// worn pair may have been renamed together; else the one of that name.
///
/// # Errors
/// [`Error::Input`] if it lies outside the folder of `file`, links resolved.
pub fn sidecar_path(file: &Path, name: &str) -> Result<PathBuf> {
    let cure = Some("put the sidecar beside the mesh, and export the mesh again or name the sidecar itself");
    let folders = ReferenceFolders { cure, ..ReferenceFolders::of_file(file, None) };
    let renamed = file.with_extension("crease.json");
    if renamed.is_file() {
        folders.check(&renamed)?;
        return Ok(renamed);
    }
    folders.path_of(name)
}

impl ReferenceFolders {
    /// The folder of `file`, and `more`, if that is given.
    pub fn of_file(file: &Path, more: Option<&Path>) -> Self {
        Self::of_folder(file, file.parent().unwrap_or(Path::new("")), more)
    }

    /// The folder `base`, and `more`, if that is given; `file` is what names the files, for messages.
    pub fn of_folder(file: &Path, base: &Path, more: Option<&Path>) -> Self {
        let real = |folder: &Path| {
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            folder.canonicalize().ok()
        };
        let allowed = [Some(base), more].into_iter().flatten().filter_map(real).collect();
        Self { file: file.to_owned(), base: base.to_owned(), allowed, cure: None }
    }

    /// The folder of frames `folder` alone.
    pub fn of_frames(folder: &Path) -> Self {
        Self { cure: Some("copy the frames into the folder"), ..Self::of_folder(folder, folder, None) }
    }

    /// Returns the path of the file called `name`.
    ///
    /// # Errors
    /// [`Error::Input`] if it is a network address or lies outside the folders; one that is missing inside them is no error here.
    pub fn path_of(&self, name: &str) -> Result<PathBuf> {
        if name.contains("://") {
            let message = "is a network address, which is not supported";
            return Err(Error::input(file_name(&self.file), name, message, "export the mesh as .glb"));
        }
        // A file of that name, not the standard input.
        let path = if name == STANDARD_STREAM { Path::new(".").join(name) } else { self.base.join(name) };
        self.check(&path)?;
        Ok(path)
    }

    /// Checks that `path` lies in the folders, whether it exists or not.
    ///
    /// # Errors
    /// [`Error::Input`] that names it.
    pub fn check(&self, path: &Path) -> Result<()> {
        // What does not exist is judged by the part of it that does.
        let real = path.ancestors().find_map(|part| {
            let rest = path.strip_prefix(part).ok()?;
            let part = if part.as_os_str().is_empty() { Path::new(".") } else { part };
            // The end of a link that leads to nothing is unknown.
            let is_dangling = part.symlink_metadata().is_ok() && !part.exists();
            Some((!is_dangling).then_some(part.canonicalize().ok()?)?.join(rest))
        });
        let climbs = |real: &Path| real.components().any(|part| part == Component::ParentDir);
        let is_inside =
            |real: &PathBuf| !climbs(real) && self.allowed.iter().any(|folder| real.starts_with(folder));
        if real.as_ref().is_some_and(is_inside) {
            return Ok(());
        }
        let message = format!("lies outside the folder of {}", file_name(&self.file));
        if let Some(cure) = self.cure {
            return Err(Error::input(file_name(path), "", message, cure));
        }
        let folder = real.as_deref().and_then(Path::parent).filter(|real| !climbs(real));
        let allow = match folder {
            Some(folder) => Setting::AllowFolder.to(folder.display().to_string()),
            None => Setting::AllowFolder.to("DIR"),
        };
        let help = Message::from("put it there, or, if you trust the file, allow its folder with ") + allow;
        Err(Error::input(file_name(path), "", message, help))
    }

    /// Reads the file called `name`: all of it, or the first `needed` bytes.
    ///
    /// # Errors
    /// Those of [`Self::path_of`] and of [`read_referenced`].
    pub fn read(&self, name: &str, needed: Option<u64>) -> Result<Vec<u8>> {
        read_referenced(&self.path_of(name)?, needed)
    }
}

/// Reads the file at `path`, which another names: all of it, or the first `needed` bytes.
///
/// # Errors
/// Those of [`read_regular`]. That of a missing file has no advice: the reader of the file that names it knows where it belongs.
pub(super) fn read_referenced(path: &Path, needed: Option<u64>) -> Result<Vec<u8>> {
    if !path.exists() {
        return Err(Error::input(file_name(path), "", "there is no such file", ""));
    }
    read_regular(path, needed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `IN/a.gltf`, `IN/deep/b.bin`, `secret.bin` and `other/c.bin` beside IN.
    fn scene() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path().canonicalize().expect("is there");
        for name in ["IN/a.gltf", "IN/deep/b.bin", "secret.bin", "other/c.bin"] {
            let path = root.join(name);
            std::fs::create_dir_all(path.parent().expect("has one")).expect("makes");
            std::fs::write(path, name).expect("writes");
        }
        (folder, root)
    }

    fn refusal(folders: &ReferenceFolders, name: &str) -> String {
        folders.read(name, None).expect_err(name).to_string()
    }

    #[test]
    fn only_files_in_the_folder_or_below_are_read() {
        let (_folder, root) = scene();
        let folders = ReferenceFolders::of_file(&root.join("IN/a.gltf"), None);
        for name in ["deep/b.bin", "./deep/../deep/b.bin", "../IN/deep/b.bin"] {
            assert_eq!(folders.read(name, None).expect(name), b"IN/deep/b.bin");
        }
        assert_eq!(folders.read("deep/b.bin", Some(2)).expect("is read"), b"IN");
        let absolute = root.join("secret.bin").display().to_string();
        // The second is no folder, the last does not exist: neither tells whether something is there.
        for name in [
            "../secret.bin",
            "missing/../../secret.bin",
            &absolute,
            "../nothing.bin",
            "deep/../../other/c.bin",
        ] {
            let text = refusal(&folders, name);
            assert!(
                text.contains("lies outside the folder of") && text.contains("ReadOptions::allow_folder"),
                "{text}"
            );
        }
        assert!(refusal(&folders, "nothing.bin").contains("there is no such file"));
        assert!(refusal(&folders, "deep").contains("is a folder"));
        assert!(refusal(&folders, "http://a/b.bin").contains("network address"));
    }

    #[test]
    fn one_more_folder_can_be_allowed() {
        let (_folder, root) = scene();
        let folders = ReferenceFolders::of_file(&root.join("IN/a.gltf"), Some(&root.join("IN/../other")));
        assert_eq!(folders.read("../other/c.bin", None).expect("is read"), b"other/c.bin");
        assert!(refusal(&folders, "../secret.bin").contains("lies outside"));
    }

    /// A sidecar called as the mesh is comes first, and lies in the folder of the mesh, as one that the mesh names.
    #[cfg(unix)]
    #[test]
    fn a_sidecar_called_as_the_mesh_lies_in_its_folder() {
        let (_folder, root) = scene();
        let inside = root.join("IN");
        let [own, linked] = ["own.glb", "linked.glb"].map(|name| inside.join(name));
        let beside = inside.join("own.crease.json");
        std::fs::write(&beside, "{}").expect("writes");
        std::os::unix::fs::symlink(root.join("secret.bin"), inside.join("linked.crease.json"))
            .expect("links");
        assert_eq!(sidecar_path(&own, "old.crease.json").expect("is inside"), beside);
        let error = sidecar_path(&linked, "old.crease.json").expect_err("is outside").to_string();
        assert!(error.contains("lies outside the folder of"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_nowhere_else_and_devices_are_not_read() {
        use std::os::unix::fs::symlink;
        let (_folder, root) = scene();
        let inside = root.join("IN");
        symlink(root.join("secret.bin"), inside.join("file")).expect("links");
        symlink(&root, inside.join("folder")).expect("links");
        symlink(root.join("not-there"), inside.join("dangling")).expect("links");
        symlink("deep/b.bin", inside.join("own")).expect("links");
        let folders = ReferenceFolders::of_file(&inside.join("a.gltf"), None);
        assert_eq!(folders.read("own", None).expect("is read"), b"IN/deep/b.bin");
        assert!(refusal(&folders, "dangling").contains("there is no such file"));
        for name in ["file", "folder/secret.bin", "folder/other/c.bin"] {
            let text = refusal(&folders, name);
            assert!(text.contains("lies outside the folder of"), "{name}: {text}");
        }
        let socket = inside.join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).expect("binds");
        assert!(refusal(&folders, "socket").contains("is no regular file"));
        let devices = ReferenceFolders::of_file(Path::new("/dev/a.gltf"), None);
        assert!(refusal(&devices, "zero").contains("is no regular file"));
    }
}
