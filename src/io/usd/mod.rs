//! USD: reads the meshes of files ([`reader`]), and writes the worn garment as a scene, as text (`--export usd`).
//!
//! ```text
//! /Garment               SkelRoot; a deformable body for simulators
//!   /Garment/PIECE       what renderers show: a mesh per worn piece with texture coordinates, normals and a material, the
//!                        shape of the file, and the wear as blend shape `worn`; bound to the skeleton
//!   /Garment/Skeleton    joints of the file (one without movement if it has none), and an animation that holds `worn` at 1
//!   /Garment/Frames      with `--frames`: the garment over time, points as time samples; hidden
//!   /Garment/Simulation  what simulators of deformables read: one welded mesh with rest angles
//!   /Garment/Materials   surface and physical material
//! ```
//!
//! Metres, y up. Vertices of the pieces are those of the file. Base colours and normal maps are pictures beside the scene ([`texture`]).

mod cloth;
mod prim;
#[cfg(feature = "usd")]
mod reader;
mod scene;
mod signature;
mod simulation;
mod skeleton;
mod texture;

pub use scene::{UsdFrames, UsdScene, UsdShape};
pub use simulation::{UsdaMemory, read_usda, wrapped_deg};
pub use texture::{UsdTexture, usd_textures};

#[cfg(feature = "usd")]
pub(super) use reader::read_usd;
pub use signature::{FILE_EXTENSIONS, is_usd};

use crate::usd::cloth::{cloth_meshes, frames_mesh, materials};
use crate::usd::prim::Prim;
use crate::usd::simulation::simulation_mesh;
use crate::usd::skeleton::UsdSkeleton;
use crease_model::error::Result;

/// Writes `scene` as USDA text.
///
/// # Errors
/// [`crease_model::error::Error::Input`] for a skin that cannot be read, and for shapes beyond single precision.
pub fn write_usda(scene: &UsdScene) -> Result<Vec<u8>> {
    let UsdScene { name, asset, garment, worn, rest, fabric, frames } = *scene;
    let skeleton = UsdSkeleton::of_asset(asset)?;
    let shape = UsdShape { worn: &worn.displacement, rest, rest_angle: &worn.memory.rest_angle };
    let mut root = Prim::new("SkelRoot", "Garment").api(&["PhysicsDeformableBodyAPI"]);
    let cloth = cloth_meshes(asset, garment, worn, &skeleton)?;
    root = root.line(format!("float3[] extent = {}", cloth.extent));
    for mesh in cloth.meshes {
        root = root.child(mesh);
    }
    root = root.child(skeleton.prim());
    if let Some(frames) = frames.filter(|frames| !frames.positions.is_empty()) {
        root = root.child(frames_mesh(asset, &frames));
    }
    root = root.child(simulation_mesh(garment, &shape)).child(materials(asset, fabric, name));
    let times = frames.map_or(String::new(), |frames| {
        let end = frames.positions.len().saturating_sub(1);
        format!("    startTimeCode = 0\n    endTimeCode = {end}\n    timeCodesPerSecond = {0}\n    framesPerSecond = {0}\n", frames.rate)
    });
    let mut text = format!(
        "#usda 1.0\n(\n    defaultPrim = \"Garment\"\n{times}    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
    );
    root.write(&mut text, 0);
    Ok(text.into_bytes())
}
