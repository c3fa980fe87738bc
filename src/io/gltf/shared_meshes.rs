//! Gives every node of the scene a mesh of its own where several show one: mirrored sleeves, a pair of socks, a stand of two bars.
//! A mesh keeps one set of wrinkles, so the copies are meshes of the document; they have the accessors in common. Copies no bytes.

use crate::gltf::json_cursor::Cursor;
use crate::tuning::TUNING;
use serde_json::{Value, json};

/// Copies, in the document `json`, every mesh that a few of the nodes that `shown` flags show, for each but the first of them. All nodes
/// count where none is flagged.
pub(super) fn copy_shared_meshes(json: &mut Value, shown: &[bool]) {
    let root = Cursor::root(json);
    let nodes = root.entries("nodes");
    let mesh_of = |node: &Cursor| node.index("mesh").ok().flatten();
    let counted = |number: usize| shown.get(number).copied().unwrap_or(false);
    let any_shown = nodes.iter().enumerate().any(|(number, node)| counted(number) && mesh_of(node).is_some());
    let count = root.length("meshes");
    let mut showing: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (number, node) in nodes.iter().enumerate().filter(|(number, _)| !any_shown || counted(*number)) {
        if let Some(list) = mesh_of(node).and_then(|mesh| showing.get_mut(mesh)) {
            list.push(number);
        }
    }
    let (mut copies, mut left) = (Vec::new(), TUNING.max_copied_vertices);
    for (mesh, list) in showing.iter().enumerate() {
        let others = list.get(1..).unwrap_or_default();
        let vertices = vertex_count(&root, mesh).saturating_mul(others.len());
        if others.len() <= TUNING.max_mesh_copies && vertices <= left {
            left -= vertices;
            copies.extend(others.iter().map(|node| (*node, mesh)));
        }
    }
    for (node, mesh) in copies {
        let Some(meshes) = json["meshes"].as_array_mut() else { return };
        let copy = meshes[mesh].clone();
        meshes.push(copy);
        let index = meshes.len() - 1;
        json["nodes"][node]["mesh"] = json!(index);
    }
}

/// Returns the number of vertices that the primitives of a mesh state.
fn vertex_count(root: &Cursor, mesh: usize) -> usize {
    let primitives = root.entry("meshes", mesh).entries("primitives");
    let positions = primitives.iter().filter_map(|p| p.member("attributes").index("POSITION").ok().flatten());
    let counts = positions.filter_map(|index| root.entry("accessors", index).index("count").ok().flatten());
    counts.fold(0, usize::saturating_add)
}
