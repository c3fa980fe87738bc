//! Morph targets in the shape that the file shows: base plus every target by its default weight, that of the node where it
//! has weights, else of the mesh (glTF 2.0 specification, 3.7.2.2).
//!
//! The target `worn` of an earlier bake is left out: a garment is worn from its shape before the wear.

use crate::gltf::accessor::Accessors;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::names::{EXTRAS_KEY, WORN_TARGET};
use crease_geometry::math::Vec3;
use crease_model::error::Result;

/// Returns the default weights of the targets of mesh `mesh` as `node` shows it; missing ones are 0.
pub(super) fn default_weights(root: &Cursor, mesh: usize, node: Option<usize>) -> Vec<f64> {
    let mesh = root.entry("meshes", mesh);
    let node = node.map(|node| root.entry("nodes", node)).filter(|node| node.member("weights").exists());
    let mut weights = node.unwrap_or_else(|| mesh.clone()).number_list("weights");
    let extras = mesh.member("extras");
    if extras.member(EXTRAS_KEY).exists() {
        for (weight, name) in weights.iter_mut().zip(extras.entries("targetNames")) {
            if name.as_text() == Some(WORN_TARGET) {
                *weight = 0.0;
            }
        }
    }
    weights
}

/// Adds the displacements of `attribute` of the targets of `primitive`, by their weights, to `rows`.
pub(super) fn add_targets(
    accessors: &Accessors,
    primitive: &Cursor,
    weights: &[f64],
    attribute: &str,
    rows: &mut [Vec3],
) -> Result<()> {
    for (target, weight) in primitive.entries("targets").iter().zip(weights).filter(|(_, w)| **w != 0.0) {
        let Some(index) = target.index(attribute)? else { continue };
        let table = accessors.table_of(index, 3, Some(rows.len()), target.path())?;
        for (row, delta) in rows.iter_mut().zip(table.rows()) {
            *row += Vec3::from_column_slice(delta) * *weight;
        }
    }
    Ok(())
}
