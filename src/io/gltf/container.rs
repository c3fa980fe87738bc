//! GLB container: a 12-byte header, a JSON chunk, and at most one binary chunk.
//!
//! First stage of reading a .glb and last of writing one (glTF 2.0 specification, chapter 4). The `gltf` crate writes.
//! Chunks of other types are kept. Reading is implemented here, because the crate subtracts the header's size from an unchecked length (a panic on a
//! damaged file) and rejects unknown chunks, which the specification tells readers to skip. Only parses the JSON.

use crease_model::error::{Error, Result};
use crease_model::garment::GlbChunk;
use serde_json::Value;
use std::borrow::Cow;

/// First bytes of a GLB file.
const MAGIC: &[u8] = b"glTF";
/// Type of the JSON chunk.
const JSON_CHUNK: &[u8] = b"JSON";
/// Type of the binary chunk.
const BINARY_CHUNK: &[u8] = b"BIN\0";
/// Bytes of magic, version and length.
const HEADER_BYTES: usize = 12;
/// Bytes of a chunk's length and type.
const CHUNK_HEADER_BYTES: usize = 8;

/// Returns whether `bytes` begin like a GLB file.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Returns the JSON and the binary chunk of a GLB file. Errors name the file "GLB": the caller knows its real name.
pub fn split_glb(bytes: &[u8]) -> Result<(Value, Option<Vec<u8>>)> {
    if !is_glb(bytes) {
        return Err(broken("byte 0", "it does not begin with \"glTF\""));
    }
    match word(bytes, 4) {
        Some(2) => {}
        Some(version) => {
            return Err(Error::input(
                "GLB",
                "byte 4",
                format!("it is glTF version {version}; only version 2 can be read"),
                "export it as glTF 2.0",
            ));
        }
        None => return Err(broken("byte 4", "it ends within the header")),
    }
    let Some(length) = word(bytes, 8) else { return Err(broken("byte 8", "it ends within the header")) };
    // Bytes after the stated length are not part of the file.
    let Some(bytes) = bytes.get(..length as usize) else {
        return Err(broken(
            "byte 8",
            format!("the header states {length} bytes, the file has {}", bytes.len()),
        ));
    };
    let Some(first) = chunk(bytes, HEADER_BYTES)? else {
        return Err(broken("byte 12", "it has no JSON chunk"));
    };
    if first.kind != JSON_CHUNK {
        return Err(broken("byte 12", "its first chunk is not JSON"));
    }
    let json = parse_json(first.data)?;
    // The binary chunk is the second or there is none; other chunks belong to extensions.
    let binary = match chunk(bytes, first.end)? {
        Some(second) if second.kind == BINARY_CHUNK => Some(second.data.to_vec()),
        _ => None,
    };
    Ok((json, binary))
}

/// Returns the chunks of a GLB file besides those of JSON and of buffers; those before the first damaged one.
pub(super) fn other_chunks(bytes: &[u8]) -> Vec<GlbChunk> {
    let length = word(bytes, 8).unwrap_or(0) as usize;
    let bytes = bytes.get(..length).unwrap_or(bytes);
    let (mut chunks, mut start, mut has_binary) = (Vec::new(), HEADER_BYTES, false);
    while let Ok(Some(found)) = chunk(bytes, start) {
        // Only the second chunk is that of buffers.
        let is_binary = found.kind == BINARY_CHUNK && !has_binary && chunks.is_empty();
        has_binary |= is_binary;
        if start > HEADER_BYTES && !is_binary {
            let kind = found.kind.try_into().unwrap_or_default();
            chunks.push(GlbChunk { kind, data: found.data.to_vec() });
        }
        start = found.end;
    }
    chunks
}

/// Appends `chunks` to the GLB file `glb`.
pub(super) fn append_chunks(mut glb: Vec<u8>, chunks: &[GlbChunk]) -> Vec<u8> {
    for GlbChunk { kind, data } in chunks {
        let padded = data.len().next_multiple_of(4);
        glb.extend_from_slice(&(padded as u32).to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(data);
        glb.resize(glb.len() + padded - data.len(), 0);
    }
    let length = (glb.len() as u32).to_le_bytes();
    if let Some(stated) = glb.get_mut(8..12) {
        stated.copy_from_slice(&length);
    }
    glb
}

/// Writes a GLB file of `json` and, if not empty, a binary chunk, both padded to four bytes.
pub fn join_glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let glb = ::gltf::binary::Glb {
        header: ::gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
        json: Cow::Owned(json.to_string().into_bytes()),
        bin: (!binary.is_empty()).then_some(Cow::Borrowed(binary)),
    };
    // Writing to memory cannot fail; any reader would reject an empty file.
    glb.to_vec().unwrap_or_default()
}

/// Parses JSON text; a byte-order mark is skipped.
pub(super) fn parse_json(text: &[u8]) -> Result<Value> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    serde_json::from_slice(text).map_err(|error| {
        Error::input(
            "GLB",
            format!("JSON line {}, column {}", error.line(), error.column()),
            format!("the JSON cannot be read: {error}"),
            "export the file again",
        )
    })
}

/// Chunk of a GLB file.
struct Chunk<'a> {
    kind: &'a [u8],
    data: &'a [u8],
    /// Offset of the next chunk.
    end: usize,
}

/// Returns the chunk at `start`; `None` at the end of the file.
fn chunk(bytes: &[u8], start: usize) -> Result<Option<Chunk<'_>>> {
    let location = format!("byte {start}");
    if start.saturating_add(CHUNK_HEADER_BYTES) > bytes.len() {
        return if start >= bytes.len() {
            Ok(None)
        } else {
            Err(broken(location, "it ends within a chunk's header"))
        };
    }
    let length = word(bytes, start).unwrap_or(0) as usize;
    let data_start = start + CHUNK_HEADER_BYTES;
    let data = data_start.checked_add(length).and_then(|end| bytes.get(data_start..end));
    match (bytes.get(start + 4..data_start), data) {
        (Some(kind), Some(data)) => Ok(Some(Chunk { kind, data, end: data_start + length })),
        _ => Err(broken(
            location,
            format!("a chunk states {length} bytes, {} are left", bytes.len() - data_start),
        )),
    }
}

fn word(bytes: &[u8], start: usize) -> Option<u32> {
    let four = bytes.get(start..start.checked_add(4)?)?;
    four.try_into().ok().map(u32::from_le_bytes)
}

fn broken(location: impl Into<String>, message: impl Into<String>) -> Error {
    Error::input(
        "GLB",
        location,
        format!("not a complete GLB file: {}", message.into()),
        "copy or export the file again; it may be cut off",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn joined_then_split_is_the_same() {
        let document = json!({"asset": {"version": "2.0"}, "extras": {"b": 1, "a": [0.1, 2e-7]}});
        for binary in [&b""[..], b"1", b"1234", b"12345"] {
            let glb = join_glb(&document, binary);
            assert_eq!(glb.len() % 4, 0);
            assert_eq!(glb.len(), u32::from_le_bytes(glb[8..12].try_into().unwrap()) as usize);
            let (read, data) = split_glb(&glb).unwrap();
            assert_eq!(read.to_string(), document.to_string(), "values and order of keys");
            match data {
                None => assert!(binary.is_empty()),
                Some(data) => {
                    assert!(data.starts_with(binary));
                    assert!(data.len() < binary.len() + 4, "padded by at most three bytes");
                }
            }
        }
    }

    /// The specification: "Client implementations MUST ignore chunks with unknown types".
    #[test]
    fn an_unknown_chunk_is_skipped() {
        let mut glb = join_glb(&json!({}), b"1234");
        glb.extend_from_slice(&4u32.to_le_bytes());
        glb.extend_from_slice(b"WHATever");
        let length = glb.len() as u32;
        glb[8..12].copy_from_slice(&length.to_le_bytes());
        assert_eq!(split_glb(&glb).unwrap().1.as_deref(), Some(&b"1234"[..]));
        let chunks = other_chunks(&glb);
        assert_eq!(chunks, [GlbChunk { kind: *b"WHAT", data: b"ever".to_vec() }]);
        assert_eq!(append_chunks(join_glb(&json!({}), b"1234"), &chunks), glb, "and comes out again");
    }

    #[test]
    fn every_truncation_is_a_fault() {
        let glb = join_glb(&json!({"asset": {"version": "2.0"}}), b"12345678");
        for end in 0..glb.len() {
            let message = split_glb(&glb[..end]).unwrap_err().to_string();
            assert!(message.contains("GLB"), "{message}");
        }
    }

    /// Met in `gltf` 1.4.1: a stated length below the header's own size underflows.
    #[test]
    fn a_length_below_the_header_is_a_fault() {
        let mut glb = join_glb(&json!({}), b"");
        glb[8..12].copy_from_slice(&3u32.to_le_bytes());
        assert!(split_glb(&glb).is_err());
        glb[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(split_glb(&glb).is_err());
    }
}
