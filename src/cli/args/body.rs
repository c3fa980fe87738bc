//! `--body` and its options: the body that a garment is worn on, from its own file, from the file of the garment, or from
//! a folder of frames.

use crate::cli::args::mesh::up_axis;
use crate::cli::args::values::{Metres, positive, unit};
use crate::cli::files::frame_sequence::read_frames;
use crate::cli::files::input::name_of;
use clap::Args;
use crease::body::AnimatedBody;
use crease::files::{GarmentFile, read_asset_file};
use crease::garment::{Severity, SourceAsset, SourceFormat, SourcePiece, UpAxis};
use crease::io::{ReadOptions, compare_body_size};
use crease::{Diagnostic, Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Body that a garment is worn on.
#[derive(Debug, Clone, Args)]
pub struct BodyArgs {
    /// Body that the garment is worn on: .glb, .gltf or .obj (may be the file of the garment), or a folder of numbered .obj frames
    #[arg(long, value_name = "BODY")]
    body: Option<PathBuf>,
    /// Node, mesh or group that is the body [default: the whole file except the garment]
    #[arg(long, value_name = "NODE|GROUP", requires = "body")]
    body_node: Option<String>,
    /// Unit of the body file: m, dm, cm, mm, in or metres [default: --unit; metres for a glTF beside an OBJ]
    #[arg(long, value_name = "UNIT", allow_negative_numbers = true, value_parser = unit, requires = "body")]
    body_unit: Option<Metres>,
    /// Up axis of the body file: y or z [default: --up; y for a glTF beside an OBJ]
    #[arg(long, value_name = "AXIS", value_parser = up_axis, requires = "body")]
    body_up: Option<UpAxis>,
    /// Frames per second of a folder of frames
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = positive, requires = "body")]
    body_fps: Option<f64>,
}

impl BodyArgs {
    /// Whether a body was given.
    pub fn is_given(&self) -> bool {
        self.body.is_some()
    }

    /// Reads the body, if one was given, for the garment `mesh`, which was read from `path` with `options`.
    pub fn read(
        &self,
        path: &Path,
        options: &ReadOptions,
        mesh: &GarmentFile,
    ) -> Result<Option<Arc<AnimatedBody>>> {
        let Some(body) = &self.body else { return Ok(None) };
        let same = matches!((body.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
        let reading = self.body_options(body, options, mesh.asset.format);
        let mut body = if body.is_dir() {
            self.read_frames_of(body, options, mesh.asset.format)?
        } else if same {
            self.read_in_garment_file(&mesh.asset, options)?
        } else {
            let (asset, diagnostics) = read_asset_file(body, &reading).map_err(of_body_node)?;
            let pieces: Vec<&SourcePiece> = asset.worn_pieces().collect();
            let mut body = AnimatedBody::from_pieces(&asset, &pieces)?;
            for diagnostic in diagnostics.into_iter().filter(|d| d.severity == Severity::Warning) {
                body.add_note(format!("{}: {}", asset.file, diagnostic.message));
            }
            body
        };
        let unit_m = if same { mesh.asset.unit_m } else { reading.unit_m.unwrap_or(1.0) };
        let boxes = mesh.asset.worn_bounds().zip(body.bounds());
        if let Some(note) = boxes.and_then(|(garment, own)| compare_body_size(garment, own, unit_m)) {
            body.add_note(format!("{}: {note}", body.file));
        }
        Ok(Some(Arc::new(body)))
    }

    /// Options to read the body file `body` with, where `garment` are those of the garment file. A glTF beside an OBJ is in
    /// metres, y up; other files are taken to come from where the garment does.
    fn body_options(&self, body: &Path, garment: &ReadOptions, format: SourceFormat) -> ReadOptions {
        let is_gltf =
            body.extension().is_some_and(|e| ["glb", "gltf"].iter().any(|own| e.eq_ignore_ascii_case(own)));
        let is_like_garment = !is_gltf || format == SourceFormat::Gltf;
        let of_garment = garment.clone();
        let (unit_m, up) = if is_like_garment { (of_garment.unit_m, of_garment.up) } else { (None, None) };
        ReadOptions {
            unit_m: Some(self.body_unit.map(|unit| unit.0).or(unit_m).unwrap_or(1.0)),
            up: self.body_up.or(up),
            garment: self.body_node.clone(),
            mask: None,
            any_size: true,
            skip_damaged: true,
            weld_m: None,
        }
    }

    /// Returns the body in the file of the garment: the pieces named by `--body-node`, or all that are not worn.
    fn read_in_garment_file(&self, asset: &SourceAsset, options: &ReadOptions) -> Result<AnimatedBody> {
        let worn: Vec<bool> = asset.pieces.iter().map(|piece| piece.worn).collect();
        let chosen = match &self.body_node {
            None => worn.iter().map(|worn| !worn).collect(),
            Some(node) => pieces_named(node, asset, options)?,
        };
        let pairs = asset.pieces.iter().zip(chosen.iter().zip(&worn));
        let pieces: Vec<&SourcePiece> =
            pairs.filter(|(_, (chosen, worn))| **chosen && !**worn).map(|(piece, _)| piece).collect();
        if pieces.is_empty() {
            let message = "body and garment are the same part of this file";
            let help = "name the garment with --garment (and the body with --body-node)";
            return Err(Error::input(&asset.file, "", message, help));
        }
        AnimatedBody::from_pieces(asset, &pieces)
    }

    fn read_frames_of(
        &self,
        folder: &Path,
        options: &ReadOptions,
        format: SourceFormat,
    ) -> Result<AnimatedBody> {
        let Some(rate) = self.body_fps else {
            let message = "a folder of frames has no rate of its own";
            return Err(Error::input(name_of(folder), "", message, "give it with --body-fps"));
        };
        let frames = read_frames(folder, &self.body_options(Path::new("frame.obj"), options, format))?;
        AnimatedBody::from_frames(&frames, rate)
    }
}

/// Flags the pieces of the garment file that `node` names. The file is read again, since only the reader knows all names
/// of a piece.
fn pieces_named(node: &str, asset: &SourceAsset, options: &ReadOptions) -> Result<Vec<bool>> {
    let options = ReadOptions {
        garment: Some(node.to_owned()),
        unit_m: Some(asset.unit_m),
        any_size: true,
        ..options.clone()
    };
    let (again, _) = read_asset_file(Path::new(&asset.file), &options).map_err(of_body_node)?;
    Ok(again.pieces.iter().map(|piece| piece.worn).collect())
}

/// The error of a part chosen by `--body-node`, which the reader of files knows as the garment.
fn of_body_node(error: Error) -> Error {
    let renamed =
        |text: &str| text.replace("no garment called", "no body called").replace("--garment", "--body-node");
    match error {
        Error::Input(all) => Error::Input(
            all.into_iter()
                .map(|one| Diagnostic { message: renamed(&one.message), help: renamed(&one.help), ..one })
                .collect(),
        ),
        other => other,
    }
}
