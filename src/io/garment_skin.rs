//! Reads the skin of a garment: its worn pieces with their joints and weights.

use crate::Result;
use crate::body::{AnimatedBody, GarmentSkin};
use crate::garment::SourceAsset;
use crate::io::gltf::read_rig;

/// Reads the skin of the worn pieces of `asset` for `body`. `held` is, per worn vertex, 1 where it is held and 0 where it is
/// not, if the file says so. Returns the reason where the garment cannot follow the body.
///
/// # Errors
/// The skeleton or a clip of the file is damaged.
pub fn read_garment_skin(
    asset: &SourceAsset,
    held: Option<Vec<f64>>,
    body: &AnimatedBody,
) -> Result<std::result::Result<GarmentSkin, &'static str>> {
    let pieces: Vec<_> = asset.worn_pieces().collect();
    let Some(rig) = read_rig(asset, &pieces)? else { return Ok(Err("an OBJ file has no skin")) };
    let same_file = asset.sha256 == body.sha256;
    Ok(GarmentSkin::new(rig, &asset.worn_triangles(), held, body, same_file))
}
