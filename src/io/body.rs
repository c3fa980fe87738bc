//! Creates an animated body from a mesh file or from a sequence of them.
//!
//! A glTF gives the chosen pieces with their skeleton and clips, an OBJ its pieces without motion, a sequence of OBJ files
//! their positions over time. Files of a sequence must agree in their vertices and triangles.

use crate::gltf::read_rig;
use crate::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::body::{AnimatedBody, BodyMotion, Sequence};
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::garment::{SourceAsset, SourcePiece};

/// Creates the body of `pieces` of `asset`. Fails if its skeleton or clips are damaged.
pub fn read_body(asset: &SourceAsset, pieces: &[&SourcePiece]) -> Result<AnimatedBody> {
    let motion = match read_rig(asset, pieces)? {
        Some(rig) => BodyMotion::Rig(Box::new(rig)),
        None => BodyMotion::Still,
    };
    Ok(with_motion(asset, pieces, motion))
}

/// Creates the body of the worn pieces of the first of `frames`, moving through all of them at `rate` frames per second.
pub fn read_body_frames(frames: &[SourceAsset], rate: f64) -> Result<AnimatedBody> {
    let sequence = sequence_from_assets(frames, rate)?;
    let Some(first) = frames.first() else { return Err(no_frames()) };
    let pieces: Vec<&SourcePiece> = first.worn_pieces().collect();
    Ok(with_motion(first, &pieces, BodyMotion::Sequence(sequence)))
}

fn with_motion(asset: &SourceAsset, pieces: &[&SourcePiece], motion: BodyMotion) -> AnimatedBody {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for piece in pieces {
        let first = vertices.len() as u32;
        triangles.extend(piece.triangles.iter().map(|t| t.map(|v| first.saturating_add(v))));
        vertices.extend(positions(piece));
    }
    AnimatedBody::new(asset.file.clone(), asset.sha256.clone(), motion, &vertices, &triangles)
}

/// Returns the positions of the worn vertices over time. Fails with one error per frame whose vertices or triangles are not
/// those of the first.
pub fn sequence_from_assets(frames: &[SourceAsset], rate: f64) -> Result<Sequence> {
    if !(rate > 0.0 && rate.is_finite()) {
        let message = format!("{rate} frames per second cannot be");
        return Err(Error::input(
            "frames",
            "",
            message,
            Message::from("give the rate with ") + Setting::FrameRate,
        ));
    }
    let Some(first) = frames.first() else { return Err(no_frames()) };
    let (mut errors, mut all) = (Vec::new(), Vec::with_capacity(frames.len()));
    let reference = first.worn_triangles();
    for asset in frames {
        let vertices: Vec<Vec3> = asset.worn_pieces().flat_map(positions).collect();
        let expected = all.first().map_or(vertices.len(), Vec::len);
        if vertices.len() != expected {
            let message =
                format!("{} vertices, the first frame ({}) has {expected}", vertices.len(), first.file);
            errors.push(Diagnostic::new(&asset.file, "", message, "export all frames from one mesh"));
        } else if asset.worn_triangles() != reference {
            let message = format!("its triangles are not those of the first frame ({})", first.file);
            errors.push(Diagnostic::new(&asset.file, "", message, "export all frames from one mesh"));
        }
        all.push(vertices);
    }
    let count = errors.len();
    errors.truncate(TUNING.max_listed_frames);
    if count > TUNING.max_listed_frames {
        errors.push(Diagnostic::new(
            "frames",
            "",
            format!("{} more like that", count - TUNING.max_listed_frames),
            "",
        ));
    }
    if errors.is_empty() { Ok(Sequence { rate, frames: all }) } else { Err(Error::Input(errors)) }
}

fn no_frames() -> Error {
    Error::input("frames", "", "there are none", "name a folder of numbered .obj files")
}

/// Returns the positions of a piece's vertices [m].
fn positions(piece: &SourcePiece) -> impl Iterator<Item = Vec3> + '_ {
    (0..piece.positions.len()).map(|v| piece.scene_position(v).unwrap_or_else(Vec3::zeros))
}
