//! Adds the worn target to the meshes of a glTF document, by editing its raw JSON.
//!
//! The content of the input stays; the specification then asks for three changes beyond the worn primitives: every
//! primitive of a mesh has the same number of targets (those not worn get zeros), default weights match the number of
//! targets (of the mesh, and of a node that overrides them), and so do animated weights at every key
//! (`animated_weights`).
//!
//! A mesh that several nodes show has one shape for all of them, and the reader makes pieces of it for the first only:
//! then all of them wear it. Where another node has pieces of its own, unworn or worn differently, the worn node gets its
//! own copy of the mesh, so that the other keeps its shape.
//! A mesh that was worn before (it names a sidecar) has its old worn target replaced: two would add up.

use crate::gltf::animated_weights::{WeightEdit, edit_animations};
use crate::gltf::append::{Appender, Purpose};
use crate::gltf::names::{
    DRACO_EXTENSION, EXTRAS_KEY, FORMER_REST_ANGLE_ATTRIBUTE, REST_ANGLE_CHANGE_ATTRIBUTE,
    STIFFNESS_ATTRIBUTE, WORN_TARGET,
};
use crate::gltf::worn_target::WornTarget;
use crease_model::error::{Error, Result};
use crease_model::garment::GltfDocument;
use serde_json::{Map, Value, json};

/// Primitive of the document with its worn target.
pub(super) struct WornPrimitive {
    pub(super) node: Option<usize>,
    pub(super) mesh: usize,
    pub(super) primitive: usize,
    pub(super) target: WornTarget,
}

/// Mesh as shown by one node, with its worn primitives.
struct Instance<'a> {
    node: Option<usize>,
    mesh: usize,
    primitives: Vec<&'a WornPrimitive>,
}

/// Index of the worn target among the targets of a mesh.
struct TargetIndex {
    /// Number of targets before this edit.
    old_count: usize,
    /// Index of the worn one: `old_count`, or less if an earlier one was replaced.
    index: usize,
}

/// Adds the targets of `worn` to the document in `appender`, which is a copy of `document`; `claimed` are the nodes that
/// have pieces, worn or not; `extras` is merged into the extras of every worn mesh.
pub(super) fn add_worn_targets(
    file: &str,
    appender: &mut Appender,
    document: &GltfDocument,
    worn: &[WornPrimitive],
    claimed: &[usize],
    extras: &Map<String, Value>,
) -> Result<()> {
    let instances = group(worn);
    let mut edited_in_place = Vec::new();
    for instance in &instances {
        let users = users_of(appender, instance.mesh);
        let follows = |node: usize| instance.node.is_none_or(|own| own == node) || !claimed.contains(&node);
        // Another worn node gets its own copy later and then no longer shows this mesh.
        let leaves = |node: usize| instances.iter().any(|i| i.mesh == instance.mesh && i.node == Some(node));
        let in_place = !edited_in_place.contains(&instance.mesh)
            && users.iter().all(|&node| follows(node) || leaves(node));
        let nodes: Vec<usize> = match instance.node {
            Some(node) if !in_place => vec![node],
            _ => users.into_iter().filter(|&node| follows(node)).collect(),
        };
        let Some(mut mesh) = document.json["meshes"].get(instance.mesh).and_then(Value::as_object).cloned()
        else {
            let location = format!("meshes[{}]", instance.mesh);
            return Err(Error::input(file, location, "is not there", "export the file again"));
        };
        let target = edit_mesh(file, appender, &mut mesh, instance, extras)?;
        if in_place {
            edited_in_place.push(instance.mesh);
            appender.list("meshes")[instance.mesh] = Value::Object(mesh);
        } else {
            let copy = appender.push("meshes", Value::Object(mesh));
            nodes.iter().for_each(|&node| set_node_mesh(appender, node, copy));
        }
        extend_node_weights(appender, &nodes, &target);
        if target.index == target.old_count {
            let edited = in_place.then_some(instance.mesh);
            edit_animations(appender, document, &nodes, edited, target.old_count, WeightEdit::Add)?;
        }
    }
    Ok(())
}

/// Groups worn primitives by node and mesh, in order of first occurrence; duplicates count once.
fn group(worn: &[WornPrimitive]) -> Vec<Instance<'_>> {
    let mut instances: Vec<Instance> = Vec::new();
    for primitive in worn {
        let same = |i: &&mut Instance| i.node == primitive.node && i.mesh == primitive.mesh;
        match instances.iter_mut().find(same) {
            Some(instance) => {
                if instance.primitives.iter().all(|p| p.primitive != primitive.primitive) {
                    instance.primitives.push(primitive);
                }
            }
            None => instances.push(Instance {
                node: primitive.node,
                mesh: primitive.mesh,
                primitives: vec![primitive],
            }),
        }
    }
    instances
}

/// Returns the nodes that show `mesh`.
fn users_of(appender: &Appender, mesh: usize) -> Vec<usize> {
    let nodes = appender.json().get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let shows = |node: &Value| node["mesh"].as_u64() == Some(mesh as u64);
    nodes.iter().enumerate().filter(|(_, node)| shows(node)).map(|(i, _)| i).collect()
}

fn set_node_mesh(appender: &mut Appender, node: usize, mesh: usize) {
    if let Some(node) = appender.list("nodes").get_mut(node).and_then(Value::as_object_mut) {
        node.insert("mesh".into(), json!(mesh));
    }
}

/// Adds the target to every primitive of `mesh`, with attributes, names, weights and extras.
fn edit_mesh(
    file: &str,
    appender: &mut Appender,
    mesh: &mut Map<String, Value>,
    instance: &Instance,
    extras: &Map<String, Value>,
) -> Result<TargetIndex> {
    let mut none = Vec::new();
    let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut).unwrap_or(&mut none);
    let old_count =
        primitives.iter().filter_map(|p| p["targets"].as_array()).map(Vec::len).max().unwrap_or(0);
    for worn in &instance.primitives {
        let location = || format!("meshes[{}].primitives[{}]", instance.mesh, worn.primitive);
        let Some(attributes) = primitives.get(worn.primitive).and_then(|p| p.get("attributes")) else {
            return Err(Error::input(file, location(), "has no attributes", "export the file again"));
        };
        let (found, wanted) = (accessor_count(appender, &attributes["POSITION"]), worn.target.position.len());
        if found != Some(wanted) {
            let message = format!("has {} vertices in the file, {wanted} in the garment", found.unwrap_or(0));
            return Err(Error::input(
                file,
                location(),
                message,
                "give the document the garment was made from",
            ));
        }
    }
    let index = old_worn_target(mesh.get("extras"), old_count).unwrap_or(old_count);
    let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
    for (i, primitive) in primitives.into_iter().flatten().enumerate() {
        let worn = instance.primitives.iter().find(|p| p.primitive == i);
        if let Some(primitive) = primitive.as_object_mut() {
            edit_primitive(appender, primitive, worn.map(|p| &p.target), index, old_count);
        }
    }
    let weights = extended_weights(mesh.get("weights"), old_count, index);
    mesh.insert("weights".into(), weights);
    add_extras(mesh, extras, old_count, index);
    Ok(TargetIndex { old_count, index })
}

/// Sets the worn target, or zeros for a primitive that is not worn, at `index` of the targets.
fn edit_primitive(
    appender: &mut Appender,
    primitive: &mut Map<String, Value>,
    worn: Option<&WornTarget>,
    index: usize,
    old_count: usize,
) {
    let target = match worn {
        Some(worn) => append_worn_target(appender, worn),
        // An earlier worn target of a primitive that is not worn now stays.
        None if index < old_count => return,
        None => {
            let Some(count) =
                primitive.get("attributes").and_then(|a| accessor_count(appender, &a["POSITION"]))
            else {
                return;
            };
            json!({"POSITION": appender.zero_positions(count)})
        }
    };
    if let (Some(worn), Some(attributes)) =
        (worn, primitive.get_mut("attributes").and_then(Value::as_object_mut))
    {
        let rest_change = appender.scalars(&worn.rest_change_deg, Purpose::Vertex);
        let stiffness = appender.scalars(&worn.stiffness, Purpose::Vertex);
        if let Some(normals) = &worn.base_normal {
            attributes.insert("NORMAL".into(), json!(appender.vectors(normals, Purpose::Vertex)));
        }
        attributes.shift_remove(FORMER_REST_ANGLE_ATTRIBUTE);
        attributes.insert(REST_ANGLE_CHANGE_ATTRIBUTE.into(), json!(rest_change));
        attributes.insert(STIFFNESS_ATTRIBUTE.into(), json!(stiffness));
        // Compressed data would be decoded in another order of vertices than that of the target; the plain data that was
        // read stays.
        if let Some(extensions) = primitive.get_mut("extensions").and_then(Value::as_object_mut) {
            extensions.shift_remove(DRACO_EXTENSION);
        }
    }
    match primitive.get_mut("targets").and_then(Value::as_array_mut) {
        Some(targets) => match targets.get_mut(index) {
            Some(slot) => *slot = target,
            None => targets.push(target),
        },
        None => {
            primitive.insert("targets".into(), json!([target]));
        }
    }
}

/// Appends the numbers of the worn target; returns its entry in `targets`.
pub(super) fn append_worn_target(appender: &mut Appender, worn: &WornTarget) -> Value {
    let mut target = json!({"POSITION": appender.vectors(&worn.position, Purpose::Position)});
    if let Some(normal) = &worn.normal {
        target["NORMAL"] = json!(appender.vectors(normal, Purpose::Vertex));
    }
    if let Some(tangent) = &worn.tangent {
        target["TANGENT"] = json!(appender.vectors(tangent, Purpose::Vertex));
    }
    target
}

/// Returns the number of elements of accessor `index`.
fn accessor_count(appender: &Appender, index: &Value) -> Option<usize> {
    let accessor = appender.json().get("accessors")?.get(usize::try_from(index.as_u64()?).ok()?)?;
    usize::try_from(accessor["count"].as_u64()?).ok()
}

/// Returns the index of the worn target that crease added before, if the extras name a sidecar.
fn old_worn_target(extras: Option<&Value>, old_count: usize) -> Option<usize> {
    let extras = extras?.as_object().filter(|extras| extras.contains_key(EXTRAS_KEY))?;
    let names = extras.get("targetNames")?.as_array()?;
    names.iter().position(|name| name == WORN_TARGET).filter(|&index| index < old_count)
}

/// Returns the weights of all targets: the old ones, 0 where none was given, and 1 for the worn one.
fn extended_weights(old: Option<&Value>, old_count: usize, index: usize) -> Value {
    let mut weights = old.and_then(Value::as_array).cloned().unwrap_or_default();
    weights.resize(old_count.max(index + 1), json!(0.0));
    weights[index] = json!(1.0);
    Value::Array(weights)
}

/// Adds the weight of the worn target to nodes that override the weights of the mesh.
fn extend_node_weights(appender: &mut Appender, nodes: &[usize], target: &TargetIndex) {
    for &node in nodes {
        let node = appender.list("nodes").get_mut(node).and_then(Value::as_object_mut);
        if let Some(node) = node.filter(|node| node.contains_key("weights")) {
            let weights = extended_weights(node.get("weights"), target.old_count, target.index);
            node.insert("weights".into(), weights);
        }
    }
}

/// Merges `extras` into those of the mesh, and names the targets as Blender, three.js and others read them.
fn add_extras(mesh: &mut Map<String, Value>, extras: &Map<String, Value>, old_count: usize, index: usize) {
    let own = mesh.entry("extras").or_insert_with(|| json!({}));
    if !own.is_object() {
        // Extras may be any value; other values are kept within an object.
        *own = json!({"extras": own.take()});
    }
    let Some(own) = own.as_object_mut() else { return };
    for (key, value) in extras {
        own.insert(key.clone(), value.clone());
    }
    let mut names = own.get("targetNames").and_then(Value::as_array).cloned().unwrap_or_default();
    names.truncate(old_count);
    for unnamed in names.len()..old_count {
        names.push(json!(format!("target_{unnamed}")));
    }
    if index == old_count {
        names.push(json!(WORN_TARGET));
    }
    own.insert("targetNames".into(), Value::Array(names));
}
