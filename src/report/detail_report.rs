//! Report of a detail map.

use crease_io::gltf::DetailMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A normal map of fine wrinkles.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DetailReport {
    /// Name of the material, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Texels per side.
    pub texels: u64,
    /// Whether the material of the worn file refers to the map.
    pub in_material: bool,
    /// Mean angle between the normals of the map and those of the coarse mesh [degrees].
    pub mean_tilt_deg: f64,
    /// Texels that two parts of the garment use with different normals [%].
    #[serde(rename = "contradicted_percent", alias = "conflicting_texel_percent")]
    pub conflicting_texel_percent: f64,
    /// Heights of black and white in the height map [m].
    pub height_range_m: [f32; 2],
    /// File of the normal map, if it is not in the material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_map: Option<String>,
    /// File of the height map, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_map: Option<String>,
    /// File of the angles of creases, white for 180 degrees, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crease_map: Option<String>,
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
            crease_map: None,
        }
    }
}
