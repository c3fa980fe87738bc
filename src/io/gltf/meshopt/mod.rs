//! `EXT_meshopt_compression`: buffer views whose content is compressed. They are decoded when a document is read, into the
//! buffer that stands for the plain data, and the extension is taken out of the document: what is written is not compressed.

mod codec;
mod filter;
#[cfg(test)]
mod tests;

use crate::gltf::json_cursor::Cursor;
use codec::{decode_attributes, decode_sequence, decode_triangles};
use crease_model::error::Result;
use filter::undo_filter;
use serde_json::Value;

/// Name of the extension.
pub(super) const MESHOPT_EXTENSION: &str = "EXT_meshopt_compression";
/// Largest ratio of decoded to compressed bytes: four bits stand for 16 equal elements.
const MAX_RATIO: usize = 64;

/// Decodes all compressed buffer views into `buffers`; those whose plain data are in the file are left alone.
pub(super) fn decode_views(root: &Cursor, buffers: &mut [Vec<u8>]) -> Result<()> {
    let is_plain: Vec<bool> = buffers.iter().map(|buffer| !buffer.is_empty()).collect();
    for view in root.entries("bufferViews") {
        let packed = view.member("extensions").member(MESHOPT_EXTENSION);
        let target = view.required_index("buffer")?;
        if !packed.exists() || is_plain.get(target) == Some(&true) {
            continue;
        }
        let decoded = decode_view(&packed, buffers)?;
        let start = view.index("byteOffset")?.unwrap_or(0);
        let stated = view.required_index("byteLength")?;
        if stated != decoded.len() {
            return Err(
                view.error(format!("states {stated} bytes, its compressed data have {}", decoded.len()))
            );
        }
        let slot =
            root.entry("buffers", target).required_index("byteLength").ok().zip(buffers.get_mut(target));
        let end = start.checked_add(stated);
        match (slot, end) {
            (Some((size, buffer)), Some(end)) if end <= size => {
                buffer.resize(buffer.len().max(end), 0);
                buffer[start..end].copy_from_slice(&decoded);
            }
            _ => return Err(view.error(format!("lies outside of buffers[{target}]"))),
        }
    }
    Ok(())
}

/// Decodes the content of a view from its member `packed`.
fn decode_view(packed: &Cursor, buffers: &[Vec<u8>]) -> Result<Vec<u8>> {
    let number = packed.required_index("buffer")?;
    let start = packed.index("byteOffset")?.unwrap_or(0);
    let length = packed.required_index("byteLength")?;
    let (stride, count) = (packed.required_index("byteStride")?, packed.required_index("count")?);
    let data = start.checked_add(length).and_then(|end| buffers.get(number)?.get(start..end));
    let Some(data) = data else {
        return Err(packed.error(format!("its data lie outside of buffers[{number}]")));
    };
    let size = count.checked_mul(stride).filter(|size| *size <= MAX_RATIO * length);
    let (Some(_), 1..=256) = (size, stride) else {
        return Err(packed.error(format!("{count} elements of {stride} bytes cannot be in {length}")));
    };
    let mode = packed.text("mode").unwrap_or_default();
    let filter = packed.text("filter").unwrap_or("NONE");
    let indices = |all: Vec<u32>| -> Option<Vec<u8>> {
        match stride {
            2 => Some(all.into_iter().flat_map(|i| (i as u16).to_le_bytes()).collect()),
            4 => Some(all.into_iter().flat_map(u32::to_le_bytes).collect()),
            _ => None,
        }
    };
    let decoded = match mode {
        "ATTRIBUTES" if stride.is_multiple_of(4) => decode_attributes(data, count, stride)
            .and_then(|mut bytes| undo_filter(filter, stride, &mut bytes).map(|()| bytes)),
        "TRIANGLES" => decode_triangles(data, count).and_then(indices),
        "INDICES" => decode_sequence(data, count).and_then(indices),
        _ => None,
    };
    decoded.ok_or_else(|| {
        packed.error(format!(
            "its data (mode {mode:?}, filter {filter:?}, {stride} bytes an element) are damaged"
        ))
    })
}

/// Takes the extension out of `document`, whose views are decoded.
pub(super) fn remove_extension(document: &mut Value) {
    for list in ["bufferViews", "buffers"] {
        for entry in document.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten() {
            let Some(own) = entry.as_object_mut() else { continue };
            let Some(extensions) = own.get_mut("extensions").and_then(Value::as_object_mut) else { continue };
            extensions.shift_remove(MESHOPT_EXTENSION);
            if extensions.is_empty() {
                own.shift_remove("extensions");
            }
        }
    }
    for list in ["extensionsUsed", "extensionsRequired"] {
        let Some(root) = document.as_object_mut() else { return };
        let Some(names) = root.get_mut(list).and_then(Value::as_array_mut) else { continue };
        names.retain(|name| name.as_str() != Some(MESHOPT_EXTENSION));
        if names.is_empty() {
            root.shift_remove(list);
        }
    }
}
