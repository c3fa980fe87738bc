//! Embeds images that a document names by a path, so that the output is one file that shows its textures anywhere. The
//! bytes are stored unchanged, in buffers of their own; `append` merges all buffers into one.
//!
//! Only files that are pictures by their first bytes are embedded: a document that names something else by mistake or by
//! malice keeps the name. Opens no files; decodes no picture.

use crate::gltf::buffers::{decode_base64, resolve_uri};
use crease_model::error::{Error, Message, Result};
use crease_model::garment::GltfDocument;
use serde_json::{Value, json};

/// Embeds every image that `resolve` finds under its (decoded) path. Returns the reasons for images that are not embedded.
pub fn embed_images(
    document: &mut GltfDocument,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Vec<Message> {
    let named: Vec<(usize, String)> = document.json["images"]
        .as_array()
        .into_iter()
        .flatten()
        .enumerate()
        .filter_map(|(i, image)| Some((i, image["uri"].as_str()?.to_owned())))
        .filter(|(_, uri)| !uri.starts_with("data:"))
        .collect();
    let mut not_embedded = Vec::new();
    for (i, uri) in named {
        let outcome = resolve_uri(&uri, resolve).map_err(reason).and_then(|bytes| {
            let kind = picture_kind(&bytes).ok_or("is not a PNG, JPEG, WebP or KTX2 picture")?;
            embed(document, i, bytes, kind).ok_or_else(|| "the document's lists are damaged".into())
        });
        if let Err(reason) = outcome {
            not_embedded.push(Message::from(format!("images[{i}] still names \"{uri}\": ")) + reason);
        }
    }
    not_embedded
}

/// Returns the text of an error.
fn reason(error: Error) -> Message {
    match error {
        Error::Input(all) => Message::join(all.iter().map(|one| one.to_message()), "; "),
        other => other.to_string().into(),
    }
}

/// Returns the bytes of an image that is in the document: in a buffer view, or in a data address.
pub fn image_bytes(document: &GltfDocument, image: usize) -> Option<Vec<u8>> {
    let image = document.json["images"].get(image)?;
    let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok());
    if let Some(view) = number(&image["bufferView"]) {
        let view = document.json["bufferViews"].get(view)?;
        let start = number(&view["byteOffset"]).unwrap_or(0);
        let end = start.checked_add(number(&view["byteLength"])?)?;
        return document.buffers.get(number(&view["buffer"])?)?.get(start..end).map(<[u8]>::to_vec);
    }
    let (_, text) = image["uri"].as_str()?.strip_prefix("data:")?.split_once(";base64,")?;
    decode_base64(text)
}

/// Returns the media type of a picture by its first bytes.
fn picture_kind(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', 0xBB, ..] => Some("image/ktx2"),
        _ => None,
    }
}

/// Adds `bytes` to the document as image `i`; `None`, and nothing changed, if a list of the document is damaged.
fn embed(document: &mut GltfDocument, i: usize, bytes: Vec<u8>, kind: &str) -> Option<()> {
    let root = document.json.as_object_mut()?;
    for list in ["buffers", "bufferViews"] {
        if !root.entry(list).or_insert_with(|| json!([])).is_array() {
            return None;
        }
    }
    let buffer = push(root.get_mut("buffers")?, json!({"byteLength": bytes.len()}))?;
    if buffer != document.buffers.len() {
        root.get_mut("buffers")?.as_array_mut()?.pop();
        return None;
    }
    let view = json!({"buffer": buffer, "byteOffset": 0, "byteLength": bytes.len()});
    let view = push(root.get_mut("bufferViews")?, view)?;
    document.buffers.push(bytes);
    let image = root.get_mut("images")?.get_mut(i)?.as_object_mut()?;
    // `remove` would change the order of keys.
    image.shift_remove("uri");
    image.insert("mimeType".to_owned(), json!(kind));
    image.insert("bufferView".to_owned(), json!(view));
    Some(())
}

fn push(list: &mut Value, entry: Value) -> Option<usize> {
    let list = list.as_array_mut()?;
    list.push(entry);
    Some(list.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_model::error::Error;

    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n and so on";

    fn document() -> GltfDocument {
        let json = json!({
            "buffers": [{"byteLength": 4}], "bufferViews": [{"buffer": 0, "byteLength": 4}],
            "images": [
                {"uri": "my%20weave.png", "name": "weave", "extras": {"kept": 1}},
                {"uri": "data:image/png;base64,AAAA"}, {"uri": "notes.txt"}, {"uri": "gone.png"}, {"bufferView": 0},
            ],
        });
        GltfDocument { json, buffers: vec![vec![0; 4]], chunks: Vec::new() }
    }

    #[test]
    fn pictures_come_in_and_all_else_stays() {
        let mut document = document();
        let before = document.clone();
        let left = embed_images(&mut document, &mut |name| match name {
            "my weave.png" => Ok(PNG.to_vec()),
            "notes.txt" => Ok(b"secret".to_vec()),
            _ => Err(Error::input(name, "", "there is no such file", "")),
        });
        assert_eq!(left.len(), 2, "{left:?}");
        assert!(
            left[0].contains("notes.txt") && left[1].contains("gone.png: there is no such file"),
            "{left:?}"
        );
        let image = &document.json["images"][0];
        let expected =
            json!({"name": "weave", "extras": {"kept": 1}, "mimeType": "image/png", "bufferView": 1});
        assert_eq!(image, &expected);
        let view = &document.json["bufferViews"][1];
        assert_eq!((view["buffer"].as_u64(), view["byteLength"].as_u64()), (Some(1), Some(PNG.len() as u64)));
        assert_eq!(document.buffers[1], PNG);
        for i in 1..5 {
            assert_eq!(document.json["images"][i], before.json["images"][i]);
        }
    }

    #[test]
    fn damaged_lists_are_left_alone() {
        for damage in [json!({"images": [{"uri": "a.png"}], "buffers": 3}), json!([]), json!({"images": 1})] {
            let mut document = GltfDocument { json: damage.clone(), buffers: vec![], chunks: vec![] };
            embed_images(&mut document, &mut |_| Ok(PNG.to_vec()));
            assert_eq!(document.json, damage);
            assert!(document.buffers.is_empty());
        }
    }
}
