//! References of a primitive to materials.

use serde_json::Value;

/// Extension that gives a primitive several materials to choose from.
pub(super) const VARIANTS: &str = "KHR_materials_variants";

/// Index in a JSON value.
pub(super) fn index_of(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|i| usize::try_from(i).ok())
}

/// Returns the mappings of `KHR_materials_variants` of a primitive.
pub(super) fn variant_mappings(primitive: &Value) -> impl Iterator<Item = &Value> {
    primitive["extensions"][VARIANTS]["mappings"].as_array().into_iter().flatten()
}
