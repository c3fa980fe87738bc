//! Writes the worn garment as a USD scene, as text (`--export usd`).
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
//! Metres, y up. Vertices of the pieces are those of the file. Textures stay in the glTF: only base colours are written.

mod cloth;
mod prim;
mod simulation;
mod skeleton;

pub use simulation::{UsdaMemory, read_usda, wrapped_deg};

use crate::Result;
use crate::fabric::Fabric;
use crate::garment::{Garment, SourceAsset, WornGarment};
use crate::io::usd::cloth::{cloth_meshes, frames_mesh, materials};
use crate::io::usd::prim::Prim;
use crate::io::usd::simulation::simulation_mesh;
use crate::io::usd::skeleton::UsdSkeleton;
use crate::math::Vec3;

/// Path of the root.
const ROOT: &str = "/Garment";
/// Path of the materials.
const MATERIALS: &str = "/Garment/Materials";
/// Name of the physical material.
const PHYSICS_MATERIAL: &str = "Fabric";

/// Shapes of a garment for simulators.
#[derive(Debug, Clone, Copy)]
pub struct UsdShape<'a> {
    /// Displacement of the worn shape, one per point [m].
    pub worn: &'a [Vec3],
    /// Displacement of the rest shape, one per point [m].
    pub rest: &'a [Vec3],
    /// Rest angle, one per hinge [rad].
    pub rest_angle: &'a [f64],
}

/// The garment over time.
#[derive(Debug, Clone, Copy)]
pub struct UsdFrames<'a> {
    /// Frames per second.
    pub rate: f64,
    /// Per frame: one position per vertex of the worn pieces [m].
    pub positions: &'a [Vec<Vec3>],
}

/// What a file is made of.
#[derive(Debug, Clone, Copy)]
pub struct UsdScene<'a> {
    /// File of the garment.
    pub asset: &'a SourceAsset,
    /// Garment made from it.
    pub garment: &'a Garment,
    /// Its wear.
    pub worn: &'a WornGarment,
    /// Rest shape, as displacement, one per point [m].
    pub rest: &'a [Vec3],
    /// Its fabric.
    pub fabric: &'a Fabric,
    /// Frames, if there are any.
    pub frames: Option<UsdFrames<'a>>,
}

/// Writes `scene` as USDA text.
///
/// # Errors
/// [`crate::Error::Input`] for a skin that cannot be read, and for shapes beyond single precision.
pub fn write_usda(scene: &UsdScene) -> Result<Vec<u8>> {
    let UsdScene { asset, garment, worn, rest, fabric, frames } = *scene;
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
    root = root.child(simulation_mesh(garment, &shape)).child(materials(asset, fabric));
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
