//! Loads the buffers of a document: the binary chunk of a GLB, data addresses, and external files, which the caller
//! fetches. A buffer without data (fallback of a compression) is empty; reading it fails.

use crate::error_list::ErrorList;
use crate::gltf::json_cursor::Cursor;
use crate::read::Resolve;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use crease_model::error::{Diagnostic, Error, Message, Result};
use crease_model::garment::{ImportDiagnostic, Severity};
use serde_json::{Value, json};

/// Base64 decoder that accepts any padding, as writers disagree about it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Bytes that stand for a buffer that is not read: the least that a view of it can have.
const UNUSED_BYTES: usize = 4;

/// Use of the buffers of a document.
pub(super) struct BufferUse {
    /// Per buffer: end of the last view in it that something refers to; `None` where nothing does.
    ends: Vec<Option<u64>>,
    /// Per view: whether something refers to it.
    views: Vec<bool>,
}

/// Returns which buffers accessors, pictures or extensions of `json` use.
pub(super) fn used_buffers(json: &Value) -> BufferUse {
    let list = |name: &str| json[name].as_array().map_or(&[][..], Vec::as_slice);
    let mut views = vec![false; list("bufferViews").len()];
    let others = json.as_object().into_iter().flatten().filter(|(key, _)| *key != "bufferViews");
    others.for_each(|(_, value)| mark_views(value, &mut views));
    let mut ends = vec![None; list("buffers").len()];
    for view in list("bufferViews").iter().zip(&views).filter(|(_, used)| **used).map(|(view, _)| view) {
        let extensions = view["extensions"].as_object().into_iter().flatten().map(|(_, value)| value);
        for part in std::iter::once(view).chain(extensions) {
            let number = |name: &str| part[name].as_u64().unwrap_or(0);
            let buffer = part["buffer"].as_u64().and_then(|b| usize::try_from(b).ok());
            if let Some(slot) = buffer.and_then(|buffer| ends.get_mut(buffer)) {
                *slot = (*slot).max(Some(number("byteOffset").saturating_add(number("byteLength"))));
            }
        }
    }
    BufferUse { ends, views }
}

/// Flags the views that `value` names in members called `bufferView`.
fn mark_views(value: &Value, views: &mut [bool]) {
    match value {
        Value::Array(list) => list.iter().for_each(|entry| mark_views(entry, views)),
        Value::Object(members) => {
            for (key, member) in members {
                let named = (key == "bufferView").then(|| member.as_f64()).flatten();
                match named.and_then(|number| views.get_mut(number as usize)) {
                    Some(slot) => *slot = true,
                    None => mark_views(member, views),
                }
            }
        }
        _ => {}
    }
}

/// Removes the files that nothing uses from the document: their addresses, and views of them. Returns a note for each.
pub(super) fn drop_unused(
    json: &mut Value,
    buffers: &mut [Vec<u8>],
    used: &BufferUse,
) -> Vec<ImportDiagnostic> {
    let mut notes = Vec::new();
    for (number, bytes) in buffers.iter_mut().enumerate() {
        let entry = &mut json["buffers"][number];
        if used.ends.get(number) != Some(&None)
            || entry["uri"].as_str().is_none_or(|uri| uri.starts_with("data:"))
        {
            continue;
        }
        let uri = entry["uri"].as_str().unwrap_or_default();
        notes.push(ImportDiagnostic {
            severity: Severity::Note,
            location: format!("buffers[{number}]"),
            message: format!("nothing uses the file \"{uri}\": not read, and left out of what is written")
                .into(),
        });
        *bytes = vec![0; UNUSED_BYTES];
        if let Some(entry) = entry.as_object_mut() {
            entry.remove("uri");
            entry.insert("byteLength".into(), UNUSED_BYTES.into());
        }
        let views = json["bufferViews"].as_array_mut().into_iter().flatten().zip(&used.views);
        for (view, _) in
            views.filter(|(view, used)| !**used && view["buffer"].as_u64() == Some(number as u64))
        {
            *view = json!({"buffer": number, "byteOffset": 0, "byteLength": UNUSED_BYTES});
        }
    }
    notes
}

/// Returns the bytes of every entry of `buffers` that is used; `binary` is the chunk of the GLB.
pub(super) fn load_buffers(
    root: &Cursor,
    mut binary: Option<Vec<u8>>,
    used: &BufferUse,
    resolve: &mut Resolve,
    errors: &mut ErrorList,
) -> Vec<Vec<u8>> {
    let mut buffers = Vec::new();
    for (number, entry) in root.entries("buffers").iter().enumerate() {
        let end = used.ends.get(number).copied().flatten();
        let stated = errors.take(entry.index("byteLength")).flatten().unwrap_or(0);
        let bytes = match entry.text("uri") {
            Some(uri) if end.is_none() && !uri.starts_with("data:") => None,
            Some(uri) => {
                // A stated length that is too short is tolerated.
                let needed = end.unwrap_or(0).max(stated as u64);
                errors.take(load_uri(entry, uri, &mut |name| resolve(name, Some(needed))))
            }
            None if number == 0 => Some(binary.take().unwrap_or_default()),
            None => Some(Vec::new()),
        };
        let bytes = bytes.unwrap_or_default();
        if errors.is_empty() && !bytes.is_empty() && bytes.len() < stated {
            errors.push(
                entry.path(),
                format!("it states {stated} bytes and has {}", bytes.len()),
                "copy or export the file again; it may be cut off",
            );
        }
        buffers.push(bytes);
    }
    buffers
}

fn load_uri(entry: &Cursor, uri: &str, resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Vec<u8>> {
    let Some(data) = uri.strip_prefix("data:") else {
        return resolve_uri(uri, resolve).map_err(|error| match error {
            Error::Input(errors) => {
                let named = |mut one: Diagnostic| {
                    one.location = entry.path().to_string();
                    one.message = Message::from(format!("the file \"{uri}\": ")) + one.message;
                    if one.help.is_empty() {
                        one.help = "put it beside the .gltf, or export as .glb".into();
                    }
                    one
                };
                Error::Input(errors.into_iter().map(named).collect())
            }
            other => Error::input(
                "glTF",
                entry.path(),
                format!("\"{uri}\" cannot be read: {other}"),
                "put the file beside the .gltf, or export as .glb",
            ),
        });
    };
    let Some((kind, text)) = data.split_once(',') else {
        return Err(entry.error("its data address has no comma, and so no data"));
    };
    // RFC 2397: the data are base64 text or bytes, both percent-encoded.
    let bytes = percent_decoded_bytes(text);
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Ok(bytes);
    }
    let compact: Vec<u8> = bytes.into_iter().filter(|byte| !byte.is_ascii_whitespace()).collect();
    BASE64.decode(compact).map_err(|error| entry.error(format!("its base64 text is damaged: {error}")))
}

/// Decodes base64 text; `None` for other text.
pub(super) fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let compact: Vec<u8> = text.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
    BASE64.decode(compact).ok()
}

/// Fetches the file of a relative address: percent-decoded, as it is written, or with the backslashes of another system.
pub(super) fn resolve_uri(uri: &str, resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Vec<u8>> {
    let decoded = percent_decoded(uri);
    resolve(&decoded).or_else(|error| {
        let mut others = vec![uri.to_owned(), decoded.replace('\\', "/")];
        others.retain(|other| *other != decoded);
        others.iter().find_map(|other| resolve(other).ok()).ok_or(error)
    })
}

/// Decodes percent signs: "my%20mesh.bin" is the file "my mesh.bin".
fn percent_decoded(uri: &str) -> String {
    String::from_utf8(percent_decoded_bytes(uri)).unwrap_or_else(|_| uri.to_owned())
}

fn percent_decoded_bytes(uri: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = (first == b'%')
            .then(|| after.get(..2))
            .flatten()
            .and_then(|two| std::str::from_utf8(two).ok())
            .and_then(|two| u8::from_str_radix(two, 16).ok());
        match code {
            Some(byte) => {
                bytes.push(byte);
                rest = after.get(2..).unwrap_or(&[]);
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_stand_for_bytes() {
        assert_eq!(percent_decoded("my%20mesh%C3%A9.bin"), "my meshé.bin");
        for odd in ["100%", "%2", "%zz", "%ff"] {
            assert_eq!(percent_decoded(odd), odd);
        }
    }
}
