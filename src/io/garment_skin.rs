//! Reads the skin of a garment: its worn pieces with their joints and weights.

use crate::gltf::read_rig;
use crease_model::body::{AnimatedBody, GarmentSkin};
use crease_model::garment::{SourceAsset, SourceFormat};

/// Reads the skin of the worn pieces of `asset` for `body`. `held` is, per worn vertex, 1 where it is held and 0 where it is
/// not, if the file says so.
///
/// # Errors
/// The reason why the garment cannot follow the body, also where its skin is damaged: the garment can be simulated without.
pub fn read_garment_skin(
    asset: &SourceAsset,
    held: Option<Vec<f64>>,
    body: &AnimatedBody,
) -> Result<GarmentSkin, String> {
    let pieces: Vec<_> = asset.worn_pieces().collect();
    let rig = match read_rig(asset, &pieces) {
        Ok(Some(rig)) => rig,
        Ok(None) => {
            return Err(match asset.format {
                SourceFormat::Usd => "the skin of a USD file is not read: a .glb keeps it".to_owned(),
                SourceFormat::Arrays => "a mesh from arrays has no skin".to_owned(),
                _ => "an OBJ file has no skin".to_owned(),
            });
        }
        Err(error) => return Err(format!("its skin cannot be read: {error}")),
    };
    let same_file = asset.sha256 == body.sha256;
    GarmentSkin::new(rig, &asset.worn_triangles(), held, body, same_file).map_err(str::to_owned)
}
