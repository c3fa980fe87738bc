//! `--body` and its options: the body that a garment is worn on, from its own file, from the file of the garment, or from
//! a folder of frames.

use crate::args::mesh::up_axis;
use crate::args::values::{Metres, positive, unit};
use crate::files::frame_sequence::read_frames;
use crate::files::input::{self, name_of};
use clap::Args;
use crease::internal::files::{GarmentFile, read_asset_file};
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, compare_body_size, read_body, read_body_frames, read_garment_skin};
use crease_model::body::{AnimatedBody, BodyMotion, GarmentSkin};
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::garment::{Severity, SourceFormat, SourcePiece, UpAxis};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Body that a garment is worn on.
#[derive(Debug, Clone, Args)]
pub struct BodyArgs {
    /// Body that the garment is worn on: .glb, .gltf, .obj or USD, which does not move (may be the file of the garment), a folder of numbered .obj frames, or - for the standard input
    #[arg(long, value_name = "BODY")]
    body: Option<PathBuf>,
    /// Node, mesh or group that is the body [default: the whole file except the garment]
    #[arg(long, value_name = "NODE|GROUP", requires = "body")]
    body_node: Option<String>,
    /// Joints or parts that the garment does not rest on, with commas between them, such as hair or hands: of a joint what it and those
    /// below it move
    #[arg(long, value_name = "NAMES", requires = "body")]
    body_without: Option<String>,
    /// Unit of the body file: m, dm, cm, mm, in or metres [default: --unit; metres for a glTF beside an OBJ, its own for a USD file]
    #[arg(long, value_name = "UNIT", allow_negative_numbers = true, value_parser = unit, requires = "body")]
    body_unit: Option<Metres>,
    /// Up axis of the body file: y or z [default: --up; y for a glTF beside an OBJ, its own for a USD file]
    #[arg(long, value_name = "AXIS", value_parser = up_axis, requires = "body")]
    body_up: Option<UpAxis>,
    /// Frames per second of a folder of frames
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = positive, requires = "body")]
    body_fps: Option<f64>,
    /// What of a garment that is skinned in its file stays where its joints carry it, the rest within a distance that grows from there:
    /// upper (upper borders, and cloth without a body under it), none, or the vertex attribute that is 1 there, as in COLOR_0.r
    /// or _PIN
    #[arg(long, value_name = "WHAT", default_value = "upper", requires = "body")]
    hold: String,
}

/// The skin of a garment on its body, or the reason why there is none.
pub type SkinOrReason = std::result::Result<Arc<GarmentSkin>, String>;

impl BodyArgs {
    /// Path of the body file.
    pub fn path(&self) -> Option<&Path> {
        self.body.as_deref()
    }

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
        let same =
            body == path || matches!((body.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
        let own_format = if body.is_dir() { None } else { input::format_with_frame(body)? };
        let reading = self.body_options(own_format, options, mesh.asset.format);
        let mut unit_m = reading.unit_m.unwrap_or(1.0);
        let mut body = if body.is_dir() {
            self.read_frames_of(body, options, mesh.asset.format)?
        } else if same {
            unit_m = mesh.asset.unit_m;
            self.read_in_garment_file(mesh, path, options)?
        } else {
            let (asset, diagnostics) = read_asset_file(body, &reading).map_err(of_body_node)?;
            unit_m = asset.unit_m;
            let left_out = self.left_out_pieces(body, &reading)?;
            let is_kept = |(k, _): &(usize, &SourcePiece)| !left_out.contains(k);
            let pieces: Vec<&SourcePiece> =
                asset.pieces.iter().enumerate().filter(is_kept).map(|(_, p)| p).filter(|p| p.worn).collect();
            let mut body = read_body(&asset, &pieces)?;
            for diagnostic in diagnostics.into_iter().filter(|d| d.severity == Severity::Warning) {
                body.add_note(Message::from(format!("{}: ", asset.file)) + diagnostic.message);
            }
            body
        };
        self.leave_out_joints(&mut body)?;
        let boxes = mesh.asset.worn_bounds().zip(body.bounds());
        if let Some(note) = boxes.and_then(|(garment, own)| {
            // Garment and body of one file have one unit.
            let worn_fraction =
                |scale: f64| if same { 1.0 } else { body.worn_fraction(&mesh.garment.points, scale) };
            compare_body_size(garment, own, [mesh.asset.unit_m, unit_m], worn_fraction)
        }) {
            body.add_note(Message::from(format!("{}: ", body.file)) + note);
        }
        Ok(Some(Arc::new(body)))
    }

    /// Reads the skin of the garment `mesh`, which was read from `path` with `options`, for `body`.
    pub fn read_skin(
        &self,
        path: &Path,
        options: &ReadOptions,
        mesh: &GarmentFile,
        body: &AnimatedBody,
    ) -> Result<SkinOrReason> {
        let held = match self.hold.as_str() {
            "none" => return Ok(Err("switched off by --hold none".to_owned())),
            "upper" => None,
            attribute => {
                let masked = ReadOptions { mask: Some(attribute.to_owned()), ..options.clone() };
                let (asset, _) = read_asset_file(path, &masked).map_err(of_hold)?;
                Some(asset.worn_pieces().flat_map(held_vertices).collect())
            }
        };
        let is_marked = held.is_some();
        match read_garment_skin(&mesh.asset, held, body) {
            Ok(skin) => Ok(Ok(Arc::new(skin))),
            Err(reason) if is_marked => {
                let message = format!("nothing of it can be held: {reason}");
                Err(Error::input(&mesh.asset.file, "", message, "leave out --hold"))
            }
            Err(reason) => Ok(Err(reason)),
        }
    }

    /// Options to read the body file with, where `garment` are those of the garment file, whose format is `format`. A glTF beside an
    /// OBJ is in metres, y up, and a USD file states its unit and axis; other files are taken to come from where the garment does.
    fn body_options(
        &self,
        own_format: Option<SourceFormat>,
        garment: &ReadOptions,
        format: SourceFormat,
    ) -> ReadOptions {
        let is_like_garment = own_format.is_none_or(|own| own == format);
        let of_garment = garment.clone();
        let (unit_m, up) = if is_like_garment { (of_garment.unit_m, of_garment.up) } else { (None, None) };
        ReadOptions {
            unit_m: self.body_unit.map(|unit| unit.0).or(unit_m),
            up: self.body_up.or(up),
            garment: self.body_node.clone(),
            mask: None,
            sewing_mask: None,
            any_size: true,
            skip_damaged: true,
            weld_m: None,
        }
    }

    /// Names of `--body-without`.
    fn left_out_names(&self) -> impl Iterator<Item = &str> {
        self.body_without
            .iter()
            .flat_map(|names| names.split(','))
            .map(str::trim)
            .filter(|name| !name.is_empty())
    }

    /// Numbers of the pieces of the file `path` that `--body-without` names.
    fn left_out_pieces(&self, path: &Path, options: &ReadOptions) -> Result<Vec<usize>> {
        let mut all = Vec::new();
        for name in self.left_out_names() {
            let options = ReadOptions { garment: Some(name.to_owned()), any_size: true, ..options.clone() };
            // A name that no part has is that of a joint.
            match read_asset_file(path, &options) {
                Ok((asset, _)) => all.extend((0..asset.pieces.len()).filter(|k| asset.pieces[*k].worn)),
                Err(Error::Input(_)) => {}
                Err(other) => return Err(other),
            }
        }
        Ok(all)
    }

    /// Leaves out of `body` what the joints move that `--body-without` names. Names of parts, which are left out already, are none of
    /// joints.
    fn leave_out_joints(&self, body: &mut AnimatedBody) -> Result<()> {
        for name in self.left_out_names() {
            match body.leave_out(name) {
                Ok(count) => {
                    let file = body.file.clone();
                    body.add_note(format!(
                        "{file}: {count} triangles that \"{name}\" moves are no part of the body"
                    ));
                }
                Err(error) if !self.names_part(name) => {
                    let message = format!("it has {}, and no part of that name", error.message);
                    return Err(Error::input(&body.file, "--body-without", message, error.help));
                }
                Err(_) => {}
            }
        }
        Ok(())
    }

    /// Whether `name` is that of a part of the file of the body.
    fn names_part(&self, name: &str) -> bool {
        let options = ReadOptions {
            garment: Some(name.to_owned()),
            any_size: true,
            skip_damaged: true,
            ..ReadOptions::default()
        };
        self.body.as_ref().is_some_and(|path| read_asset_file(path, &options).is_ok())
    }

    /// Returns the body in the file of the garment: the pieces named by `--body-node`, or all that are not worn and do not lie
    /// over the garment.
    fn read_in_garment_file(
        &self,
        mesh: &GarmentFile,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<AnimatedBody> {
        let asset = &mesh.asset;
        let worn: Vec<bool> = asset.pieces.iter().map(|piece| piece.worn).collect();
        let chosen = match &self.body_node {
            None => worn.iter().map(|worn| !worn).collect(),
            Some(node) => pieces_named(node, path, asset.unit_m, options)?,
        };
        let pairs = asset.pieces.iter().zip(chosen.iter().zip(&worn));
        let left_out = self.left_out_pieces(path, options)?;
        let is_chosen = |(k, (_, (chosen, worn))): &(usize, (&SourcePiece, (&bool, &bool)))| {
            **chosen && !**worn && !left_out.contains(k)
        };
        let mut pieces: Vec<&SourcePiece> =
            pairs.enumerate().filter(is_chosen).map(|(_, (piece, _))| piece).collect();
        let over = if self.body_node.is_none() { layers_over(mesh, &pieces) } else { Vec::new() };
        let mut number = 0..;
        pieces.retain(|_| !number.next().is_some_and(|k| over.iter().any(|(other, _)| *other == k)));
        if pieces.is_empty() {
            let message = "body and garment are the same part of this file";
            let help = "name the garment with --garment (and the body with --body-node)";
            return Err(Error::input(&asset.file, "", message, help));
        }
        let mut body = read_body(asset, &pieces)?;
        for (_, name) in over {
            body.add_note(format!(
                "{}: \"{name}\" lies over the garment and is no part of the body (--body-node names what is)",
                asset.file
            ));
        }
        Ok(body)
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
        let frames = read_frames(folder, &self.body_options(None, options, format))?;
        read_body_frames(&frames, rate)
    }
}

/// Returns the numbers and names of those of `pieces` that lie over the garment of `mesh`; none if all of them do.
fn layers_over(mesh: &GarmentFile, pieces: &[&SourcePiece]) -> Vec<(usize, String)> {
    let lies_over = |(_, piece): &(usize, &&SourcePiece)| {
        let position = |v: usize| piece.scene_position(v).unwrap_or_else(Vec3::zeros);
        let vertices: Vec<Vec3> = (0..piece.positions.len()).map(position).collect();
        AnimatedBody::new("", "", BodyMotion::Still, &vertices, &piece.triangles)
            .lies_over(&mesh.garment.points)
    };
    let over = pieces.iter().enumerate().filter(lies_over);
    let over: Vec<(usize, String)> = over.map(|(k, piece)| (k, piece.name.clone())).collect();
    if over.len() < pieces.len() { over } else { Vec::new() }
}

/// Per vertex of `piece`: how much the file says that it is held.
fn held_vertices(piece: &SourcePiece) -> Vec<f64> {
    piece.mask.clone().unwrap_or_else(|| vec![0.0; piece.positions.len()])
}

/// The error of an attribute named by `--hold`, which the reader of files knows as the mask.
fn of_hold(error: Error) -> Error {
    changed(error, |one| Diagnostic { help: one.help.with_setting(Setting::Mask, Setting::Hold), ..one })
}

/// Flags the pieces of the garment file that `node` names. The file is read again, since only the reader knows all names
/// of a piece.
fn pieces_named(node: &str, path: &Path, unit_m: f64, options: &ReadOptions) -> Result<Vec<bool>> {
    let options = ReadOptions {
        garment: Some(node.to_owned()),
        unit_m: Some(unit_m),
        any_size: true,
        ..options.clone()
    };
    let (again, _) = read_asset_file(path, &options).map_err(of_body_node)?;
    Ok(again.pieces.iter().map(|piece| piece.worn).collect())
}

/// The error of a part chosen by `--body-node`, which the reader of files knows as the garment.
fn of_body_node(error: Error) -> Error {
    changed(error, |one| Diagnostic {
        message: one.message.replace("no garment called", "no body called").into(),
        help: one.help.with_setting(Setting::Garment, Setting::BodyNode),
        ..one
    })
}

/// The error with each of its diagnostics changed.
fn changed(error: Error, change: impl Fn(Diagnostic) -> Diagnostic) -> Error {
    match error {
        Error::Input(all) => Error::Input(all.into_iter().map(change).collect()),
        other => other,
    }
}
