//! Appends to a glTF document without changing its content: new views and accessors go to the end of the lists and of the
//! bytes, so that every index and every byte of the input stays valid.
//!
//! A document with several buffers becomes one with a single buffer (a GLB has one binary chunk): the buffers are
//! concatenated, and each view gets its buffer's offset added. The bytes stay unchanged. Names and extras of the buffers
//! after the first are lost. Writes floats only; knows nothing about meshes.

use crate::gltf::container::{append_chunks, join_glb};
use crease_model::error::{Error, Result};
use crease_model::garment::{GlbChunk, GltfDocument};
use serde_json::{Map, Value, json};

/// Component type of 16-bit unsigned integers.
const UNSIGNED_SHORT: u32 = 5123;
/// Component type of 32-bit unsigned integers.
const UNSIGNED_INT: u32 = 5125;
/// Component type of 32-bit floats.
const FLOAT: u32 = 5126;
/// View target of vertex attributes.
const ARRAY_BUFFER: u32 = 34962;
/// View target of indices.
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Alignment of each buffer in the merged one \[bytes\]. The specification asks for 4; 8 suits extensions with doubles.
const BUFFER_ALIGNMENT: usize = 8;
/// Alignment of each appended view \[bytes\]: the size of a float.
const VIEW_ALIGNMENT: usize = 4;

/// Purpose of an appended accessor; the specification treats these views differently.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A vertex attribute or morph target.
    Vertex,
    /// The attribute POSITION, which needs `min` and `max`.
    Position,
    /// Output of an animation.
    Animation,
}

/// Views of the one index 0 and the one value (0, 0, 0) that all empty targets refer to.
#[derive(Clone, Copy)]
struct ZeroViews {
    index: usize,
    value: usize,
}

/// Place of the rows of an accessor in the binary chunk.
struct StridedRange {
    start: usize,
    stride: usize,
}

/// Document under construction.
pub(super) struct Appender {
    json: Map<String, Value>,
    binary: Vec<u8>,
    /// Chunks of the file besides JSON and bytes.
    chunks: Vec<GlbChunk>,
    /// Views of the empty targets.
    zero_views: Option<ZeroViews>,
}

impl Appender {
    /// Creates a document of `json` without buffers.
    pub(super) fn new(json: Map<String, Value>) -> Self {
        Self { json, binary: Vec::new(), chunks: Vec::new(), zero_views: None }
    }

    /// Copies `document` with its buffers merged into one; `file` names it in diagnostics.
    pub(super) fn from_document(file: &str, document: &GltfDocument) -> Result<Self> {
        let Value::Object(json) = &document.json else {
            return Err(Error::input(file, "", "the glTF document is not a JSON object", ""));
        };
        let mut appender = Self { chunks: document.chunks.clone(), ..Self::new(json.clone()) };
        let starts = appender.merge_buffers(file, &document.buffers)?;
        if starts.len() > 1 {
            appender.move_views(file, &starts)?;
        }
        Ok(appender)
    }

    /// Returns the document so far.
    pub(super) fn json(&self) -> &Map<String, Value> {
        &self.json
    }

    /// Returns the list `key` of the document; creates an empty one if there is none or if it is no list.
    pub(super) fn list(&mut self, key: &str) -> &mut Vec<Value> {
        let entry = self.json.entry(key).or_insert_with(|| json!([]));
        if !entry.is_array() {
            *entry = json!([]);
        }
        match entry {
            Value::Array(list) => list,
            _ => unreachable!("is a list since the lines above"),
        }
    }

    /// Removes the list `key` if it has no entries.
    pub(super) fn remove_if_empty(&mut self, key: &str) {
        if self.list(key).is_empty() {
            self.json.shift_remove(key);
        }
    }

    /// Appends `entry` to the list `key`; returns its index.
    pub(super) fn push(&mut self, key: &str, entry: Value) -> usize {
        let list = self.list(key);
        list.push(entry);
        list.len() - 1
    }

    /// States that the document uses the extension `name`.
    pub(super) fn use_extension(&mut self, name: &str) {
        let used = self.list("extensionsUsed");
        if !used.iter().any(|own| own == name) {
            used.push(json!(name));
        }
    }

    /// Appends vectors; returns the accessor's index.
    pub(super) fn vectors<const N: usize>(&mut self, rows: &[[f32; N]], purpose: Purpose) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(N.wrapping_sub(1)).copied().unwrap_or("SCALAR");
        let target = (purpose != Purpose::Animation).then_some(ARRAY_BUFFER);
        let view = self.view(bytes_of(rows.iter().flatten().map(|x| x.to_le_bytes())), target);
        let mut accessor =
            json!({"bufferView": view, "componentType": FLOAT, "count": rows.len(), "type": kind});
        if purpose == Purpose::Position {
            let (low, high) = bounds(rows);
            accessor["min"] = json!(low.to_vec());
            accessor["max"] = json!(high.to_vec());
        }
        self.push("accessors", accessor)
    }

    /// Writes vectors over those of `accessor` if `in_place` and it holds plain floats of that shape, else appends them; returns
    /// the accessor's index.
    pub(super) fn replace_vectors<const N: usize>(
        &mut self,
        accessor: usize,
        rows: &[[f32; N]],
        purpose: Purpose,
        in_place: bool,
    ) -> usize {
        match in_place.then(|| self.plain_floats(accessor, 4 * N, rows.len())).flatten() {
            Some(StridedRange { start, stride }) => {
                for (k, row) in rows.iter().enumerate() {
                    let at = start + k * stride;
                    let bytes = bytes_of(row.iter().map(|x| x.to_le_bytes()));
                    self.binary[at..at + bytes.len()].copy_from_slice(&bytes);
                }
                if purpose == Purpose::Position {
                    let (low, high) = bounds(rows);
                    let entry = &mut self.list("accessors")[accessor];
                    entry["min"] = json!(low.to_vec());
                    entry["max"] = json!(high.to_vec());
                }
                accessor
            }
            None => self.vectors(rows, purpose),
        }
    }

    /// Returns where the `count` rows of `size` bytes of `accessor` are, if they are plain floats in an uncompressed view.
    fn plain_floats(&self, accessor: usize, size: usize, count: usize) -> Option<StridedRange> {
        let number = |value: &Value, name: &str| value[name].as_u64().and_then(|n| usize::try_from(n).ok());
        let all = self.json.get("accessors")?.as_array()?;
        let entry = all.get(accessor)?;
        // Two accessors may name the same bytes.
        let place = |entry: &Value| (entry["bufferView"].as_u64(), number(entry, "byteOffset").unwrap_or(0));
        if all.iter().enumerate().any(|(k, other)| k != accessor && place(other) == place(entry)) {
            return None;
        }
        if number(entry, "componentType") != Some(FLOAT as usize) || entry.get("sparse").is_some() {
            return None;
        }
        let view = self.json.get("bufferViews")?.get(number(entry, "bufferView")?)?;
        if view.get("extensions").is_some() || count == 0 {
            return None;
        }
        let stride = number(view, "byteStride").unwrap_or(size);
        let start = number(view, "byteOffset").unwrap_or(0) + number(entry, "byteOffset").unwrap_or(0);
        let end = start.checked_add((count - 1).checked_mul(stride)?)?.checked_add(size)?;
        (stride >= size && end <= self.binary.len()).then_some(StridedRange { start, stride })
    }

    /// Appends numbers; returns the accessor's index.
    pub(super) fn scalars(&mut self, values: &[f32], purpose: Purpose) -> usize {
        self.vectors(values.as_chunks::<1>().0, purpose)
    }

    /// Appends joints of vertices; returns the accessor's index.
    pub(super) fn joints(&mut self, rows: &[[u16; 4]]) -> usize {
        let bytes = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_SHORT, "count": rows.len(), "type": "VEC4"}),
        )
    }

    /// Appends bytes that are no numbers, such as a picture; returns the view's index.
    pub(super) fn bytes(&mut self, bytes: Vec<u8>) -> usize {
        self.view(bytes, None)
    }

    /// Appends triangle corners; returns the accessor's index.
    pub(super) fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes = bytes_of(triangles.iter().flatten().map(|x| x.to_le_bytes()));
        let view = self.view(bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = triangles.len() * 3;
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"}),
        )
    }

    /// Appends `count` zero displacements that take no space. A plain accessor without a view would mean the same, but
    /// several readers reject it; a sparse one with a single zero is read by all. Returns the accessor's index.
    pub(super) fn zero_positions(&mut self, count: usize) -> usize {
        let views = match self.zero_views {
            Some(views) => views,
            None => ZeroViews { index: self.view(vec![0; 4], None), value: self.view(vec![0; 12], None) },
        };
        self.zero_views = Some(views);
        let sparse = json!({
            "count": 1,
            "indices": {"bufferView": views.index, "componentType": UNSIGNED_INT},
            "values": {"bufferView": views.value},
        });
        self.push(
            "accessors",
            json!({
                "componentType": FLOAT, "count": count, "type": "VEC3",
                "min": [0.0, 0.0, 0.0], "max": [0.0, 0.0, 0.0], "sparse": sparse,
            }),
        )
    }

    /// Returns the finished document as a GLB file.
    pub(super) fn into_glb(mut self) -> Vec<u8> {
        if !self.binary.is_empty() {
            let length = json!(self.binary.len());
            let buffers = self.list("buffers");
            match buffers.first_mut() {
                Some(buffer) => buffer["byteLength"] = length,
                None => buffers.push(json!({"byteLength": length})),
            }
        }
        append_chunks(join_glb(&Value::Object(self.json), &self.binary), &self.chunks)
    }

    fn view(&mut self, bytes: Vec<u8>, target: Option<u32>) -> usize {
        pad(&mut self.binary, VIEW_ALIGNMENT);
        let mut view = json!({"buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.binary.extend(bytes);
        self.push("bufferViews", view)
    }

    /// Merges all buffers into the binary chunk; returns the start of each in it.
    fn merge_buffers(&mut self, file: &str, buffers: &[Vec<u8>]) -> Result<Vec<usize>> {
        if !self.json.contains_key("buffers") {
            return Ok(Vec::new());
        }
        let stated: Vec<Option<u64>> =
            self.list("buffers").iter().map(|b| b["byteLength"].as_u64()).collect();
        let used = self.used_lengths(buffers);
        let mut starts = Vec::with_capacity(buffers.len());
        for (i, length) in stated.iter().enumerate() {
            // A binary chunk is padded, so it may be longer than its buffer; the bytes beyond are unused, unless a view refers
            // to them: then the stated length is wrong, which reading tolerates.
            let bytes = length
                .and_then(|length| usize::try_from(length).ok())
                .map(|length| used.get(i).map_or(length, |used| length.max(*used)))
                .and_then(|length| buffers.get(i).and_then(|bytes| bytes.get(..length)));
            let Some(bytes) = bytes else {
                let found = buffers.get(i).map_or(0, Vec::len);
                return Err(Error::input(
                    file,
                    format!("buffers[{i}]"),
                    format!("has {found} bytes, fewer than its byteLength states"),
                    "export the file again",
                ));
            };
            pad(&mut self.binary, BUFFER_ALIGNMENT);
            starts.push(self.binary.len());
            self.binary.extend_from_slice(bytes);
        }
        let list = self.list("buffers");
        list.truncate(1);
        for buffer in list.iter_mut().filter_map(Value::as_object_mut) {
            // `remove` would change the order of keys.
            buffer.shift_remove("uri");
        }
        Ok(starts)
    }

    /// Returns per buffer the end of the last view that lies within its bytes.
    fn used_lengths(&self, buffers: &[Vec<u8>]) -> Vec<usize> {
        let mut used = vec![0; buffers.len()];
        for view in self.json.get("bufferViews").and_then(Value::as_array).into_iter().flatten() {
            let number = |name: &str| view[name].as_u64().and_then(|n| usize::try_from(n).ok());
            let end = number("byteOffset").unwrap_or(0).checked_add(number("byteLength").unwrap_or(0));
            let buffer = number("buffer").unwrap_or(usize::MAX);
            if let (Some(slot), Some(bytes), Some(end)) = (used.get_mut(buffer), buffers.get(buffer), end)
                && end <= bytes.len()
            {
                *slot = end.max(*slot);
            }
        }
        used
    }

    /// Moves every view, and every extension of a view that names a buffer, to the merged buffer.
    fn move_views(&mut self, file: &str, starts: &[usize]) -> Result<()> {
        for (i, view) in self.list("bufferViews").iter_mut().enumerate() {
            let Some(view) = view.as_object_mut() else { continue };
            let mut is_valid = move_view(view, starts);
            let extensions = view.get_mut("extensions").and_then(Value::as_object_mut);
            for extension in extensions.into_iter().flat_map(|all| all.values_mut()) {
                if let Some(extension) = extension.as_object_mut().filter(|e| e.contains_key("buffer")) {
                    is_valid &= move_view(extension, starts);
                }
            }
            if !is_valid {
                let location = format!("bufferViews[{i}]");
                return Err(Error::input(
                    file,
                    location,
                    "names a buffer that is not there",
                    "export the file again",
                ));
            }
        }
        Ok(())
    }
}

/// Moves one view to the merged buffer; returns false if its buffer does not exist.
fn move_view(view: &mut Map<String, Value>, starts: &[usize]) -> bool {
    let buffer = view.get("buffer").and_then(Value::as_u64).and_then(|b| usize::try_from(b).ok());
    let Some(&start) = buffer.and_then(|b| starts.get(b)) else { return false };
    view.insert("buffer".into(), json!(0));
    if start > 0 {
        let offset = view.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
        view.insert("byteOffset".into(), json!(offset.saturating_add(start as u64)));
    }
    true
}

fn pad(bytes: &mut Vec<u8>, alignment: usize) {
    bytes.resize(bytes.len().next_multiple_of(alignment), 0);
}

fn bytes_of(words: impl Iterator<Item = [u8; 4]>) -> Vec<u8> {
    words.flatten().collect()
}

/// Returns minimum and maximum of each component; zeros when there are no rows.
fn bounds<const N: usize>(rows: &[[f32; N]]) -> ([f32; N], [f32; N]) {
    let Some(&first) = rows.first() else { return ([0.0; N], [0.0; N]) };
    rows.iter().fold((first, first), |(low, high), row| {
        (std::array::from_fn(|k| low[k].min(row[k])), std::array::from_fn(|k| high[k].max(row[k])))
    })
}
