//! What the report of a bake says of a detail map.

use crate::io::gltf::DetailMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A normal map of fine wrinkles.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DetailReport {
    /// Name of the material, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Texels a side.
    pub texels: u64,
    /// Whether the material of the worn file refers to it.
    pub in_material: bool,
    /// Mean angle between the map's directions and the bare coarse mesh [degrees].
    pub mean_tilt_deg: f64,
    /// Texels that two places of the garment claim differently, because they share a part of the picture [%].
    #[serde(alias = "contradicted_percent")]
    pub conflicting_texel_percent: f64,
    /// What black and white of the height map stand for [m].
    pub height_range_m: [f32; 2],
    /// The normal map's file, where it is not in the material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_map: Option<String>,
    /// The height map's file, where one was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_map: Option<String>,
}

impl DetailReport {
    /// Creates the report of a map of `texels` x `texels`.
    pub fn new(map: &DetailMap, texels: u64) -> Self {
        Self {
            material: map.material.clone(),
            texels,
            in_material: map.in_material,
            mean_tilt_deg: map.mean_tilt_deg,
            conflicting_texel_percent: 100.0 * map.conflicting_fraction,
            height_range_m: map.height_range_m,
            normal_map: None,
            height_map: None,
        }
    }
}
