//! A body to be worn on, from a mesh file or from a sequence of them.
//!
//! Of a glTF the chosen pieces with their skeleton and clips, of an OBJ its pieces as they stand, of a sequence of OBJ
//! files their places over time. Files of a sequence must agree in their vertices; what is missing is named.

use crate::body::{AnimatedBody, BodyMotion, Sequence};
use crate::garment::{SourceAsset, SourcePiece};
use crate::io::gltf::read_rig;
use crate::math::Vec3;
use crate::{Diagnostic, Error, Result};

/// Frames told in one message.
const FRAMES_TOLD: usize = 5;

impl AnimatedBody {
    /// The body made of `pieces` of `asset`.
    pub fn from_pieces(asset: &SourceAsset, pieces: &[&SourcePiece]) -> Result<Self> {
        let motion = match read_rig(asset, pieces)? {
            Some(rig) => BodyMotion::Rig(Box::new(rig)),
            None => BodyMotion::Still,
        };
        Ok(Self::of_motion(asset, pieces, motion))
    }

    /// The body of the worn pieces of the first of `frames`, moving through all of them at `rate` frames per second.
    pub fn from_frames(frames: &[SourceAsset], rate: f64) -> Result<Self> {
        let sequence = sequence_from_assets(frames, rate)?;
        let Some(first) = frames.first() else { return Err(no_frames()) };
        let pieces: Vec<&SourcePiece> = first.worn_pieces().collect();
        Ok(Self::of_motion(first, &pieces, BodyMotion::Sequence(sequence)))
    }

    fn of_motion(asset: &SourceAsset, pieces: &[&SourcePiece], motion: BodyMotion) -> Self {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for piece in pieces {
            let first = vertices.len() as u32;
            triangles.extend(piece.triangles.iter().map(|t| t.map(|v| first.saturating_add(v))));
            vertices.extend(places(piece));
        }
        Self::new(asset.file.clone(), asset.sha256.clone(), motion, &vertices, &triangles)
    }
}

/// Places of the worn vertices over time, all frames checked against the first.
pub fn sequence_from_assets(frames: &[SourceAsset], rate: f64) -> Result<Sequence> {
    if !(rate > 0.0 && rate.is_finite()) {
        let what = format!("{rate} frames per second cannot be");
        return Err(Error::input("frames", "", what, "give the rate with --fps"));
    }
    let Some(first) = frames.first() else { return Err(no_frames()) };
    let (mut faults, mut all) = (Vec::new(), Vec::with_capacity(frames.len()));
    let reference = first.worn_triangles();
    for asset in frames {
        let vertices: Vec<Vec3> = asset.worn_pieces().flat_map(places).collect();
        let expected = all.first().map_or(vertices.len(), Vec::len);
        if vertices.len() != expected {
            let what =
                format!("{} vertices, the first frame ({}) has {expected}", vertices.len(), first.file);
            faults.push(Diagnostic::new(&asset.file, "", what, "export all frames from one mesh"));
        } else if asset.worn_triangles() != reference {
            let what = format!("its triangles are not those of the first frame ({})", first.file);
            faults.push(Diagnostic::new(&asset.file, "", what, "export all frames from one mesh"));
        }
        all.push(vertices);
    }
    let count = faults.len();
    faults.truncate(FRAMES_TOLD);
    if count > FRAMES_TOLD {
        faults.push(Diagnostic::new("frames", "", format!("{} more like that", count - FRAMES_TOLD), ""));
    }
    if faults.is_empty() { Ok(Sequence { rate, frames: all }) } else { Err(Error::Input(faults)) }
}

fn no_frames() -> Error {
    Error::input("frames", "", "there are none", "name a folder of numbered .obj files")
}

/// Places of a piece's vertices [m].
fn places(piece: &SourcePiece) -> impl Iterator<Item = Vec3> + '_ {
    (0..piece.positions.len()).map(|v| piece.scene_position(v).unwrap_or_else(Vec3::zeros))
}
