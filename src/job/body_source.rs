//! The body that a garment is worn on: from its own file, from the file of the garment, or from a folder of frames.

use crate::files::{GarmentFile, file_name, format_with_frame, read_asset_file, read_frames};
use crate::job::garment_source::ReadGarment;
use crate::wear::{Action, WearScript};
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, compare_body_size, read_body, read_body_frames, read_garment_skin};
use crease_model::body::{AnimatedBody, BodyMotion, GarmentSkin};
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::garment::{Severity, SourceFormat, SourcePiece, UpAxis};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Body that a garment is worn on.
#[derive(Debug, Clone)]
pub struct BodyOptions {
    /// Its file, which may be that of the garment; a folder of numbered frames; or `-` for the standard input.
    pub path: PathBuf,
    /// Node, mesh or group that is the body; `None` for the whole file except the garment.
    pub node: Option<String>,
    /// Joints or parts that the garment does not rest on: of a joint what it and those below it move.
    pub without: Vec<String>,
    /// Unit of the file [m]; `None` for that of the garment or of the format.
    pub unit_m: Option<f64>,
    /// Up axis of the file; `None` for that of the garment or of the format.
    pub up: Option<UpAxis>,
    /// Frames per second of a folder of frames.
    pub frames_per_second: Option<f64>,
    /// Part of a skinned garment that stays where its joints carry it.
    pub hold: BodyHold,
}

/// Part of a garment, skinned in its file, that stays where its joints carry it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum BodyHold {
    /// Upper borders, and cloth without a body under it.
    #[default]
    Upper,
    /// None: only contact holds the garment.
    Nothing,
    /// Where this vertex attribute is 1.
    Attribute(String),
}

/// The skin of a garment on its body, or the reason why there is none.
pub(super) type SkinOrReason = std::result::Result<Arc<GarmentSkin>, Message>;

/// Returns a warning if a part of the file of `garment` that is not worn lies under it, as a shirt under a jacket, and `script` wears the
/// garment where it is.
pub(super) fn left_out_under(garment: &ReadGarment, script: &WearScript) -> Option<Message> {
    let GarmentFile { asset, garment: cloth, .. } = &garment.mesh;
    if script.flatten().any(|action| matches!(*action, Action::Lay(_))) {
        return None;
    }
    let triangles: Vec<[u32; 3]> = cloth.triangles.iter().map(|t| t.map(|p| p.0)).collect();
    let over = AnimatedBody::new("", "", BodyMotion::Still, &cloth.points, &triangles);
    let under = asset.pieces.iter().filter(|piece| !piece.worn).find(|piece| {
        let points: Vec<Vec3> =
            (0..piece.positions.len()).filter_map(|vertex| piece.scene_position(vertex)).collect();
        over.lies_over(&points)
    })?;
    let what = format!(
        "\"{}\" lies under the garment and is left out, so that nothing holds the garment there; ",
        under.name
    );
    let body = Setting::Body.to(file_name(garment.name()));
    Some(Message::from(what) + body + " " + Setting::BodyNode.to_name(&under.name) + " makes it the body")
}

impl BodyOptions {
    /// Reads the body for `garment`.
    pub(super) fn read(&self, garment: &ReadGarment) -> Result<AnimatedBody> {
        let (ReadGarment { mesh, reading: options, .. }, path) = (garment, garment.name());
        let body = &self.path;
        let same =
            body == path || matches!((body.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
        let own_format = if body.is_dir() { None } else { format_with_frame(body)? };
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
        Ok(body)
    }

    /// Reads the skin of `garment` for `body`.
    pub(super) fn read_skin(&self, garment: &ReadGarment, body: &AnimatedBody) -> Result<SkinOrReason> {
        let ReadGarment { mesh, reading: options, .. } = garment;
        let held = match &self.hold {
            BodyHold::Nothing => {
                return Ok(Err(Message::from("switched off by ") + Setting::Hold.to("none")));
            }
            BodyHold::Upper => None,
            BodyHold::Attribute(attribute) => {
                let masked = ReadOptions { mask: Some(attribute.clone()), ..options.clone() };
                let (asset, _) = read_asset_file(garment.name(), &masked).map_err(of_hold)?;
                Some(asset.worn_pieces().flat_map(held_vertices).collect())
            }
        };
        let is_marked = held.is_some();
        match read_garment_skin(&mesh.asset, held, body) {
            Ok(skin) => Ok(Ok(Arc::new(skin))),
            Err(reason) if is_marked => {
                let message = format!("nothing of it can be held: {reason}");
                let help = Message::from("leave out ") + Setting::Hold;
                Err(Error::input(&mesh.asset.file, "", message, help))
            }
            Err(reason) => Ok(Err(reason.into())),
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
            unit_m: self.unit_m.or(unit_m),
            up: self.up.or(up),
            garment: self.node.clone(),
            mask: None,
            sewing_mask: None,
            any_size: true,
            skip_damaged: true,
            weld_m: None,
            allow_folder: garment.allow_folder.clone(),
        }
    }

    /// Numbers of the pieces of the file `path` that are left out by name.
    fn left_out_pieces(&self, path: &Path, options: &ReadOptions) -> Result<Vec<usize>> {
        let mut all = Vec::new();
        for name in &self.without {
            let options = ReadOptions { garment: Some(name.clone()), any_size: true, ..options.clone() };
            // A name that no part has is that of a joint.
            match read_asset_file(path, &options) {
                Ok((asset, _)) => all.extend((0..asset.pieces.len()).filter(|k| asset.pieces[*k].worn)),
                Err(Error::Input(_)) => {}
                Err(other) => return Err(other),
            }
        }
        Ok(all)
    }

    /// Leaves out of `body` what the joints move that are left out by name. Names of parts, which are left out already, are none of
    /// joints.
    fn leave_out_joints(&self, body: &mut AnimatedBody) -> Result<()> {
        for name in &self.without {
            match body.leave_out(name) {
                Ok(count) => {
                    let file = body.file.clone();
                    body.add_note(format!(
                        "{file}: {count} triangles that \"{name}\" moves are no part of the body"
                    ));
                }
                Err(error) if !self.names_part(name) => {
                    let message = Message::from(Setting::BodyWithout)
                        + format!(": it has {}, and no part of that name", error.message);
                    return Err(Error::input(&body.file, "", message, error.help));
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
        read_asset_file(&self.path, &options).is_ok()
    }

    /// Returns the body in the file of the garment: the pieces that are named, or all that are not worn and do not lie
    /// over the garment.
    fn read_in_garment_file(
        &self,
        mesh: &GarmentFile,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<AnimatedBody> {
        let asset = &mesh.asset;
        let worn: Vec<bool> = asset.pieces.iter().map(|piece| piece.worn).collect();
        let chosen = match &self.node {
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
        let over = if self.node.is_none() { layers_over(mesh, &pieces) } else { Vec::new() };
        let mut number = 0..;
        pieces.retain(|_| !number.next().is_some_and(|k| over.iter().any(|(other, _)| *other == k)));
        if pieces.is_empty() {
            let message = "body and garment are the same part of this file";
            let help = Message::from("name the garment with ")
                + Setting::Garment
                + " (and the body with "
                + Setting::BodyNode
                + ")";
            return Err(Error::input(&asset.file, "", message, help));
        }
        let mut body = read_body(asset, &pieces)?;
        for (_, name) in over {
            let text =
                format!("{}: \"{name}\" lies over the garment and is no part of the body (", asset.file);
            body.add_note(Message::from(text) + Setting::BodyNode + " names what is)");
        }
        Ok(body)
    }

    fn read_frames_of(
        &self,
        folder: &Path,
        options: &ReadOptions,
        format: SourceFormat,
    ) -> Result<AnimatedBody> {
        let Some(rate) = self.frames_per_second else {
            let message = "a folder of frames has no rate of its own";
            let help = Message::from("give it with ") + Setting::BodyFrameRate;
            return Err(Error::input(file_name(folder), "", message, help));
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

/// The error of an attribute of held points, which the reader of files knows as the mask.
fn of_hold(error: Error) -> Error {
    changed(error, |one| one.help = one.help.clone().with_setting(Setting::Mask, Setting::Hold))
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

/// The error of a part chosen as the body, which the reader of files knows as the garment.
fn of_body_node(error: Error) -> Error {
    changed(error, |one| {
        one.message = one.message.replace("no garment called", "no body called").into();
        one.help = one.help.clone().with_setting(Setting::Garment, Setting::BodyNode);
    })
}

/// The error with each of its diagnostics changed.
fn changed(mut error: Error, change: impl FnMut(&mut Diagnostic)) -> Error {
    if let Error::Input(all) = &mut error {
        all.iter_mut().for_each(change);
    }
    error
}
