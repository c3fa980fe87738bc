//! Edits animated morph weights: a target is added, inverted or removed.
//!
//! A weights channel has one number per target at every key (glTF 2.0, 3.11), so its outputs are too short for a mesh that
//! gains the worn target. Each gets a new output accessor with the worn target's weight, 1 at every key: the garment
//! stays worn whatever else is animated. Cubic splines have three groups per key (in-tangents, values, out-tangents);
//! the worn target's tangents are 0. A sampler that other channels use stays, and the channel gets a copy.
//! Channels are found by node, and by `KHR_animation_pointer` to the weights of the node or of the mesh.

use crate::gltf::accessor::Accessors;
use crate::gltf::append::{Appender, Purpose};
use crease_model::error::Result;
use crease_model::garment::GltfDocument;
use serde_json::{Map, Value, json};

/// Edit of the weights of all keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WeightEdit {
    /// The worn target is added, with weight 1.
    Add,
    /// Weights w of a target become 1 - w.
    Invert { target: usize },
    /// A target is removed.
    Remove { target: usize },
}

/// Number of targets before an edit of their weights.
#[derive(Clone, Copy)]
struct WeightTargets {
    old_count: usize,
    edit: WeightEdit,
}

/// Edits every weights channel of `nodes`, and of `mesh` where it was edited itself, which have `old_count` targets.
/// `appender` holds a copy of `document`.
pub(super) fn edit_animations(
    appender: &mut Appender,
    document: &GltfDocument,
    nodes: &[usize],
    mesh: Option<usize>,
    old_count: usize,
    edit: WeightEdit,
) -> Result<()> {
    if !appender.json().contains_key("animations") {
        return Ok(());
    }
    // Without targets there is nothing left to animate.
    let is_last = edit == (WeightEdit::Remove { target: 0 }) && old_count == 1;
    for i in 0..appender.list("animations").len() {
        let Some(Value::Object(mut animation)) = appender.list("animations").get(i).cloned() else {
            continue;
        };
        if is_last {
            let channels = animation.get_mut("channels").and_then(Value::as_array_mut);
            channels.into_iter().for_each(|all| all.retain(|c| !animates_weights(c, nodes, mesh)));
            appender.list("animations")[i] = Value::Object(animation);
            continue;
        }
        if edit_animation(appender, document, &mut animation, nodes, mesh, WeightTargets { old_count, edit })?
        {
            appender.list("animations")[i] = Value::Object(animation);
        }
    }
    if is_last {
        // The specification asks for at least one channel.
        appender.list("animations").retain(|a| a["channels"].as_array().is_none_or(|all| !all.is_empty()));
        appender.remove_if_empty("animations");
    }
    Ok(())
}

/// Edits the channels of one animation; returns whether any was edited.
fn edit_animation(
    appender: &mut Appender,
    document: &GltfDocument,
    animation: &mut Map<String, Value>,
    nodes: &[usize],
    mesh: Option<usize>,
    targets: WeightTargets,
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
        let Some(output) = targets.edited_output(document, &sampler)? else { continue };
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

impl WeightTargets {
    /// Returns the output of `sampler` after the edit; `None` where it has no keys.
    fn edited_output(self, document: &GltfDocument, sampler: &Value) -> Result<Option<Vec<f32>>> {
        let index = |key: &str| sampler[key].as_u64().and_then(|i| usize::try_from(i).ok());
        let (Some(input), Some(output)) = (index("input"), index("output")) else { return Ok(None) };
        let accessors = Accessors::new(document);
        let key_count = accessors.table(input, "animation sampler")?.row_count();
        let old = accessors.table(output, "animation sampler")?.values;
        // Whether each group of a key holds values, not tangents.
        let is_value: &[bool] =
            if sampler["interpolation"] == "CUBICSPLINE" { &[false, true, false] } else { &[true] };
        let group_count = key_count * is_value.len();
        if group_count == 0 {
            return Ok(None);
        }
        let mut numbers = Vec::with_capacity(group_count * (self.old_count + 1));
        for group in 0..group_count {
            let one = if is_value[group % is_value.len()] { 1.0 } else { 0.0 };
            // A file with too few weights is completed with zeros, as viewers do.
            let weight = |target: usize| old.get(group * self.old_count + target).map_or(0.0, |&w| w as f32);
            for target in 0..self.old_count {
                match self.edit {
                    WeightEdit::Invert { target: own } if own == target => numbers.push(one - weight(target)),
                    WeightEdit::Remove { target: own } if own == target => {}
                    _ => numbers.push(weight(target)),
                }
            }
            if self.edit == WeightEdit::Add {
                numbers.push(one);
            }
        }
        Ok(Some(numbers))
    }
}
