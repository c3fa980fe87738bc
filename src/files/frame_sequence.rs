//! A folder of numbered OBJ frames, read in order.

use crate::files::garment_file::read_asset_file;
use crate::files::read::{file_name, merge_errors};
use crate::files::reference::ReferenceFolders;
use crease_io::ReadOptions;
use crease_model::error::{Error, Result};
use crease_model::garment::{SourceAsset, SourceFormat};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Reads the numbered .obj files of `folder` in order. A gap in the numbers is an error, as is any unreadable file.
pub fn read_frames(folder: &Path, options: &ReadOptions) -> Result<Vec<SourceAsset>> {
    let paths = frame_paths(folder)?;
    let mut errors = Vec::new();
    let mut frames = Vec::with_capacity(paths.len());
    for path in paths {
        // All unreadable files are reported at once, since sequences are long.
        match read_asset_file(&path, options) {
            Ok((asset, _)) if asset.format == SourceFormat::Obj => frames.push(asset),
            Ok((asset, _)) => {
                errors.push(Error::input(asset.file, "", "is not an OBJ file", "export the frames as .obj"))
            }
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() { Ok(frames) } else { Err(merge_errors(errors)) }
}

/// Returns the paths of the numbered .obj files of `folder` in order.
pub fn frame_paths(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |source| Error::File { file: file_name(folder), source };
    let own = ReferenceFolders::of_frames(folder);
    let mut numbered: Vec<(u64, String, PathBuf)> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        let stem = path.file_stem().and_then(OsStr::to_str).unwrap_or_default().to_owned();
        let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let (name, number) = stem.split_at(stem.len() - digits);
        if let (true, Ok(number)) = (is_obj, number.parse::<u64>()) {
            own.check(&path)?;
            numbered.push((number, name.to_owned(), path));
        }
    }
    numbered.sort();
    let refuse = |message: String, help: &str| Err(Error::input(file_name(folder), "", message, help));
    let Some((first, name, _)) = numbered.first() else {
        return refuse("has no numbered .obj files".into(), "name the folder that holds frame_0000.obj, ...");
    };
    for (next, (number, other, _)) in (*first..).zip(&numbered) {
        if other != name {
            return refuse(
                format!("holds frames of several names: \"{name}\" and \"{other}\""),
                "keep one sequence in a folder",
            );
        }
        if *number != next {
            let missing = if *number == next + 1 {
                format!("{next} is")
            } else {
                format!("{next} to {} are", number - 1)
            };
            return refuse(
                format!("frame {missing} missing between \"{name}{first}\" and \"{name}{number}\""),
                "export the whole sequence",
            );
        }
    }
    Ok(numbered.into_iter().map(|(_, _, path)| path).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_frames_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let message = || frame_paths(folder.path()).map(|paths| paths.len()).map_err(|e| e.to_string());
        assert!(message().expect_err("is empty").contains("no numbered .obj files"));
        for number in [8, 9, 10, 13] {
            std::fs::write(folder.path().join(format!("f{number}.obj")), "").expect("writes");
        }
        let error = message().expect_err("11 and 12 are missing");
        assert!(error.contains("frame 11 to 12 are missing"), "{error}");
        std::fs::remove_file(folder.path().join("f13.obj")).expect("removes");
        assert_eq!(message(), Ok(3), "10 comes after 9");
    }
}
