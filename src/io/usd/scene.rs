//! What a USD file is made of, and the names in it.

use crease_geometry::math::Vec3;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourceAsset, WornGarment};

/// Path of the root.
pub(super) const ROOT: &str = "/Garment";
/// Path of the materials.
pub(super) const MATERIALS: &str = "/Garment/Materials";
/// Name of the physical material.
pub(super) const PHYSICS_MATERIAL: &str = "Fabric";

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
    /// Name of its file without the ending, to which the names of its textures are added.
    pub name: &'a str,
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
