//! Node tree: the transform of every node to the scene, and the nodes that the scene shows.
//!
//! The specification asks for a forest; other graphs (two parents, a cycle) are refused, as a traversal would not end or
//! not be unique.

use crate::gltf::json_cursor::Cursor;
use crease_geometry::math::{Mat4, Vec3};
use crease_model::body::skeleton::NodeTransform;
use crease_model::error::{Diagnostic, Error, Result};
use nalgebra::{Quaternion, UnitQuaternion};

/// Nodes of a document.
pub(super) struct SceneNodes {
    /// Per node: transform from own to scene coordinates.
    pub(super) worlds: Vec<Mat4>,
    /// Per node: its parent.
    pub(super) parents: Vec<Option<usize>>,
    /// Per node: whether the default scene shows it.
    pub(super) shown: Vec<bool>,
    /// Per node: the reason why its transform cannot be read. It then flattens everything below it, and only a mesh that
    /// depends on it is refused.
    faults: Vec<Option<Vec<Diagnostic>>>,
}

impl SceneNodes {
    /// Reads the node tree of a document.
    pub(super) fn read(root: &Cursor) -> Result<Self> {
        let nodes = root.entries("nodes");
        let parents = read_parents(&nodes)?;
        let (mut locals, mut faults) = (Vec::new(), Vec::new());
        for node in &nodes {
            let read = read_node_transform(node);
            faults.push(match &read {
                Err(Error::Input(diagnostics)) => Some(diagnostics.clone()),
                _ => None,
            });
            locals.push(read.map_or_else(|_| Mat4::zeros(), |transform| transform.matrix()));
        }
        let order = parents_first(&nodes, &parents)?;
        let mut worlds = locals;
        for &node in &order {
            if let Some(parent) = parents[node] {
                worlds[node] = worlds[parent] * worlds[node];
            }
        }
        let mut shown = shown_roots(root, &parents)?;
        for &node in &order {
            if let Some(parent) = parents[node] {
                shown[node] |= shown[parent];
            }
        }
        Ok(Self { worlds, parents, shown, faults })
    }

    /// Returns the fault of the transform of `node`, or of the nearest node above it that has one.
    pub(super) fn fault_above(&self, node: usize) -> Option<Error> {
        let mut chain = std::iter::successors(Some(node), |up| self.parents.get(*up).copied().flatten());
        chain.find_map(|up| self.faults.get(up).cloned().flatten()).map(Error::Input)
    }
}

fn read_parents(nodes: &[Cursor]) -> Result<Vec<Option<usize>>> {
    let mut parents = vec![None; nodes.len()];
    for (number, node) in nodes.iter().enumerate() {
        for child in node.indices("children")? {
            match parents.get_mut(child) {
                Some(slot @ None) => *slot = Some(number),
                Some(Some(other)) => {
                    return Err(node.error(format!("nodes[{child}] is also a child of nodes[{other}]")));
                }
                None => return Err(node.error(format!("its child nodes[{child}] is not in the file"))),
            }
        }
    }
    Ok(parents)
}

/// Returns the node numbers, each after its parent.
fn parents_first(nodes: &[Cursor], parents: &[Option<usize>]) -> Result<Vec<usize>> {
    let mut order = Vec::with_capacity(parents.len());
    let mut done = vec![false; parents.len()];
    let mut upward = Vec::new();
    for (start, cursor) in nodes.iter().enumerate() {
        let mut at = Some(start);
        while let Some(node) = at.filter(|&node| !done[node]) {
            upward.push(node);
            if upward.len() > parents.len() {
                return Err(cursor.error("it is its own ancestor"));
            }
            at = parents[node];
        }
        while let Some(node) = upward.pop() {
            done[node] = true;
            order.push(node);
        }
    }
    Ok(order)
}

/// Returns whether each node is a root of the default scene; roots of all trees if there is no scene.
fn shown_roots(root: &Cursor, parents: &[Option<usize>]) -> Result<Vec<bool>> {
    if root.length("scenes") == 0 {
        return Ok(parents.iter().map(Option::is_none).collect());
    }
    let scene = root.required_entry("scenes", root.index("scene")?.unwrap_or(0), "scene")?;
    let mut shown = vec![false; parents.len()];
    for node in scene.indices("nodes")? {
        match shown.get_mut(node) {
            Some(slot) => *slot = true,
            None => return Err(scene.error(format!("nodes[{node}] is not in the file"))),
        }
    }
    Ok(shown)
}

/// Reads a node's own transform: `matrix`, or translation, rotation and scale.
pub(super) fn read_node_transform(node: &Cursor) -> Result<NodeTransform> {
    if let Some(columns) = node.numbers::<16>("matrix")? {
        return Ok(NodeTransform::Matrix(Mat4::from_column_slice(&columns)));
    }
    let translation = node.numbers::<3>("translation")?.unwrap_or([0.0; 3]);
    let [x, y, z, w] = node.numbers::<4>("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
    // Single precision leaves quaternions slightly off unit length; they must not scale.
    let Some(rotation) = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9) else {
        return Err(node.error("its rotation is zero"));
    };
    Ok(NodeTransform::Trs { translation: Vec3::from(translation), rotation, scale: Vec3::from(scale) })
}
