//! `--body` and its options: the body a garment is worn on, from its own file, from the garment's, or from a folder of
//! frames.

use crate::cli::args::common::{MeshReading, Metres, positive};
use crate::cli::files::input::name_of;
use crate::cli::files::mesh_file::{MeshFile, read_asset_at};
use clap::Args;
use crease::body::AnimatedBody;
use crease::garment::{SourceAsset, SourceFormat, SourcePiece};
use crease::{Error, Result};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The body a garment is worn on.
#[derive(Debug, Clone, Args)]
pub struct BodyArgs {
    /// Body it is worn on: .glb, .gltf or .obj (may be the garment's own file), or a folder of numbered .obj frames
    #[arg(long, value_name = "BODY")]
    pub body: Option<PathBuf>,
    /// Node, mesh or group that is the body [default: all of its file but the garment]
    #[arg(long, value_name = "NODE|GROUP", requires = "body")]
    pub body_node: Option<String>,
    /// Unit of the body's file: m, dm, cm, mm, in or metres [default: that of the garment's file, metres for glTF]
    #[arg(long, value_name = "UNIT", value_parser = crate::cli::args::common::unit, requires = "body")]
    pub body_unit: Option<Metres>,
    /// Frames per second of a folder of frames
    #[arg(long, value_name = "N", value_parser = positive, requires = "body")]
    pub body_fps: Option<f64>,
}

impl BodyArgs {
    /// The body, if one is wanted for the garment `mesh`, which was read from `path` as `reading` says.
    pub fn read(
        &self,
        path: &Path,
        reading: &MeshReading,
        mesh: &MeshFile,
    ) -> Result<Option<Arc<AnimatedBody>>> {
        let Some(body) = &self.body else { return Ok(None) };
        let same = matches!((body.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
        let wearer = if body.is_dir() {
            self.of_frames(body, reading)?
        } else if same {
            self.of_own_file(&mesh.asset, reading)?
        } else {
            let (asset, _) = read_asset_at(body, &self.reading(body, reading))?;
            let pieces: Vec<&SourcePiece> = asset.worn_pieces().collect();
            AnimatedBody::from_pieces(&asset, &pieces)?
        };
        Ok(Some(Arc::new(wearer)))
    }

    /// How the body's file is read.
    fn reading(&self, body: &Path, garment: &MeshReading) -> MeshReading {
        let is_gltf =
            body.extension().is_some_and(|e| ["glb", "gltf"].iter().any(|own| e.eq_ignore_ascii_case(own)));
        let unit = self.body_unit.or(if is_gltf { Some(Metres(1.0)) } else { garment.unit });
        MeshReading {
            unit: Some(unit.unwrap_or(Metres(1.0))),
            up: if is_gltf { None } else { garment.up },
            garment: self.body_node.clone(),
        }
    }

    /// The body in the garment's own file: the pieces called `--body-node`, or all that is not worn.
    fn of_own_file(&self, asset: &SourceAsset, reading: &MeshReading) -> Result<AnimatedBody> {
        let worn: Vec<bool> = asset.pieces.iter().map(|piece| piece.worn).collect();
        let chosen = match &self.body_node {
            None => worn.iter().map(|worn| !worn).collect(),
            Some(node) => self.called(node, asset, reading)?,
        };
        let pairs = asset.pieces.iter().zip(chosen.iter().zip(&worn));
        let pieces: Vec<&SourcePiece> =
            pairs.filter(|(_, (chosen, worn))| **chosen && !**worn).map(|(piece, _)| piece).collect();
        if pieces.is_empty() {
            let what = "body and garment are the same part of this file";
            let cure = "name the garment with --garment (and the body with --body-node)";
            return Err(Error::input(&asset.file, "", what, cure));
        }
        AnimatedBody::from_pieces(asset, &pieces)
    }

    /// Which pieces of the garment's file answer to `node`: reading it again is the one place that knows all names.
    fn called(&self, node: &str, asset: &SourceAsset, reading: &MeshReading) -> Result<Vec<bool>> {
        let garment = Some(node.to_owned());
        let unit = Some(Metres(asset.unit_m));
        let again = MeshReading { garment, unit, ..reading.clone() };
        let (again, _) = read_asset_at(Path::new(&asset.file), &again)?;
        Ok(again.pieces.iter().map(|piece| piece.worn).collect())
    }

    fn of_frames(&self, folder: &Path, reading: &MeshReading) -> Result<AnimatedBody> {
        let Some(rate) = self.body_fps else {
            let what = "a folder of frames has no rate of its own";
            return Err(Error::input(name_of(folder), "", what, "give it with --body-fps"));
        };
        let frames = read_frames(folder, &self.reading(Path::new("frame.obj"), reading))?;
        AnimatedBody::from_frames(&frames, rate)
    }
}

/// The numbered .obj files of `folder`, in order. A number that is missing between the first and the last is a fault.
pub fn read_frames(folder: &Path, reading: &MeshReading) -> Result<Vec<SourceAsset>> {
    let paths = frame_paths(folder)?;
    let mut faults = Vec::new();
    let mut frames = Vec::with_capacity(paths.len());
    for path in paths {
        // A sequence is large: a file that cannot be read is told beside the others.
        match read_asset_at(&path, reading) {
            Ok((asset, _)) if asset.format == SourceFormat::Obj => frames.push(asset),
            Ok((asset, _)) => {
                faults.push(Error::input(asset.file, "", "is no OBJ file", "export the frames as .obj"))
            }
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(frames) } else { Err(crate::cli::commands::bake::merged(faults.into_iter())) }
}

/// The numbered .obj files of `folder`, in order.
fn frame_paths(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |source| Error::File { file: name_of(folder), source };
    let mut numbered: Vec<(u64, String, PathBuf)> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        let stem = path.file_stem().and_then(OsStr::to_str).unwrap_or_default().to_owned();
        let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let (name, number) = stem.split_at(stem.len() - digits);
        if let (true, Ok(number)) = (is_obj, number.parse::<u64>()) {
            numbered.push((number, name.to_owned(), path));
        }
    }
    numbered.sort();
    let refuse = |what: String, cure: &str| Err(Error::input(name_of(folder), "", what, cure));
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
        let fault = message().expect_err("11 and 12 are missing");
        assert!(fault.contains("frame 11 to 12 are missing"), "{fault}");
        std::fs::remove_file(folder.path().join("f13.obj")).expect("removes");
        assert_eq!(message(), Ok(3), "10 comes after 9");
    }
}
