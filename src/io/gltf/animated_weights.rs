//! Extends animated morph weights by the worn target.
//!
//! A weights channel has one number per target at every key (glTF 2.0, 3.11), so its outputs are too short for a mesh that
//! gains the worn target. Each gets a new output accessor with the worn target's weight, 1 at every key: the garment
//! stays worn whatever else is animated. Cubic splines have three groups per key (in-tangents, values, out-tangents);
//! the worn target's tangents are 0. A sampler that other channels use stays, and the channel gets a copy.
//! Channels are found by node, and by `KHR_animation_pointer` to the weights of the node or of the mesh.

use crate::Result;
use crate::garment::GltfDocument;
use crate::io::gltf::accessor::Accessors;
use crate::io::gltf::append::{Appender, Purpose};
use serde_json::{Map, Value, json};

/// Extends every weights channel of `nodes`, and of `mesh` where it was edited itself, from `old_count` targets to one
/// more. `appender` holds a copy of `document`.
pub(super) fn extend_animations(
    appender: &mut Appender,
    document: &GltfDocument,
    nodes: &[usize],
    mesh: Option<usize>,
    old_count: usize,
) -> Result<()> {
    if !appender.json().contains_key("animations") {
        return Ok(());
    }
    for i in 0..appender.list("animations").len() {
        let Some(Value::Object(mut animation)) = appender.list("animations").get(i).cloned() else {
            continue;
        };
        if extend_animation(appender, document, &mut animation, nodes, mesh, old_count)? {
            appender.list("animations")[i] = Value::Object(animation);
        }
    }
    Ok(())
}

/// Extends the channels of one animation; returns whether any was extended.
fn extend_animation(
    appender: &mut Appender,
    document: &GltfDocument,
    animation: &mut Map<String, Value>,
    nodes: &[usize],
    mesh: Option<usize>,
    old_count: usize,
) -> Result<bool> {
    let (Some(mut channels), Some(mut samplers)) = (
        animation.get("channels").and_then(Value::as_array).cloned(),
        animation.get("samplers").and_then(Value::as_array).cloned(),
    ) else {
        return Ok(false);
    };
    let affected: Vec<bool> = channels.iter().map(|c| animates_weights(c, nodes, mesh)).collect();
    let sampler_of = |channel: &Value| channel["sampler"].as_u64().and_then(|s| usize::try_from(s).ok());
    for s in 0..samplers.len() {
        let users: Vec<usize> =
            (0..channels.len()).filter(|&c| sampler_of(&channels[c]) == Some(s)).collect();
        if !users.iter().any(|&c| affected[c]) {
            continue;
        }
        let mut sampler = samplers[s].clone();
        let Some(output) = extended_output(document, &sampler, old_count)? else { continue };
        sampler["output"] = json!(appender.scalars(&output, Purpose::Animation));
        if users.iter().all(|&c| affected[c]) {
            samplers[s] = sampler;
        } else {
            for &c in users.iter().filter(|&&c| affected[c]) {
                channels[c]["sampler"] = json!(samplers.len());
            }
            samplers.push(sampler);
        }
    }
    animation.insert("channels".into(), Value::Array(channels));
    animation.insert("samplers".into(), Value::Array(samplers));
    Ok(affected.contains(&true))
}

/// Returns whether `channel` animates all weights of one of `nodes` or of `mesh`.
fn animates_weights(channel: &Value, nodes: &[usize], mesh: Option<usize>) -> bool {
    let target = &channel["target"];
    match target["path"].as_str() {
        Some("weights") => target["node"].as_u64().is_some_and(|n| nodes.iter().any(|&own| own as u64 == n)),
        Some("pointer") => {
            let pointer = target["extensions"]["KHR_animation_pointer"]["pointer"].as_str().unwrap_or("");
            nodes.iter().any(|node| pointer == format!("/nodes/{node}/weights"))
                || mesh.is_some_and(|mesh| pointer == format!("/meshes/{mesh}/weights"))
        }
        _ => false,
    }
}

/// Returns the sampler's output with the worn weight in every group; `None` if the sampler is incomplete.
fn extended_output(document: &GltfDocument, sampler: &Value, old_count: usize) -> Result<Option<Vec<f32>>> {
    let index = |key: &str| sampler[key].as_u64().and_then(|i| usize::try_from(i).ok());
    let (Some(input), Some(output)) = (index("input"), index("output")) else { return Ok(None) };
    let accessors = Accessors::new(document);
    let key_count = accessors.table(input, "animation sampler")?.row_count();
    let old = accessors.table(output, "animation sampler")?.values;
    let worn: &[f32] = if sampler["interpolation"] == "CUBICSPLINE" { &[0.0, 1.0, 0.0] } else { &[1.0] };
    let group_count = key_count * worn.len();
    if group_count == 0 {
        return Ok(None);
    }
    let mut numbers = Vec::with_capacity(group_count * (old_count + 1));
    for group in 0..group_count {
        // A file with too few weights is completed with zeros, as viewers do.
        let weight = |target: usize| old.get(group * old_count + target).map_or(0.0, |&w| w as f32);
        numbers.extend((0..old_count).map(weight));
        numbers.push(worn[group % worn.len()]);
    }
    Ok(Some(numbers))
}
