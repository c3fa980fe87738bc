//! Builder of small glTF documents: JSON and one buffer.

// Each test uses a part of them.
#![allow(dead_code)]

use crease_io::gltf::join_glb;
use serde_json::{Value, json};

pub const FLOAT: u32 = 5126;
pub const SHORT: u32 = 5122;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_BYTE: u32 = 5121;

/// Document under construction: JSON and one buffer.
pub struct Document {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Document {
    pub fn new() -> Self {
        Self {
            json: json!({
                "asset": {"version": "2.0", "generator": "somebody else", "extras": {"left": "alone"}},
                "extensionsUsed": ["ACME_unknown"],
                "extensions": {"ACME_unknown": {"buffer": 7, "nested": [1.5, null, "x"]}},
                "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [], "meshes": [],
                "accessors": [], "bufferViews": [], "buffers": [],
            }),
            bytes: Vec::new(),
        }
    }

    pub fn push(&mut self, list: &str, entry: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(entry);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    pub fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let view = self.view(&floats(values), None);
        let count = values.len() / width;
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": FLOAT, "count": count, "type": kind}),
        )
    }

    pub fn positions(&mut self, rows: &[[f32; 3]]) -> usize {
        let accessor = self.floats("VEC3", 3, rows.as_flattened());
        let (low, high) = bounds(rows);
        self.json["accessors"][accessor]["min"] = json!(low);
        self.json["accessors"][accessor]["max"] = json!(high);
        accessor
    }

    pub fn indices(&mut self, corners: &[u16]) -> usize {
        let bytes: Vec<u8> = corners.iter().flat_map(|c| c.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        let count = corners.len();
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": UNSIGNED_SHORT, "count": count, "type": "SCALAR"}),
        )
    }

    /// Returns the primitive of a quad with the attributes given and its own indices.
    pub fn quad(&mut self, attributes: Value) -> Value {
        let indices = self.indices(&[0, 1, 2, 2, 1, 3]);
        json!({"attributes": attributes, "indices": indices})
    }

    pub fn glb(mut self) -> Vec<u8> {
        self.json["buffers"] = json!([{"byteLength": self.bytes.len(), "extras": {"buffer": "extras"}}]);
        join_glb(&self.json, &self.bytes)
    }
}

pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

pub fn bounds(rows: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let fold = |f: fn(f32, f32) -> f32| {
        rows.iter().skip(1).fold(rows[0], |a, b| std::array::from_fn(|k| f(a[k], b[k])))
    };
    (fold(f32::min), fold(f32::max))
}

/// Corners of a half-metre square, lower edge first.
pub const QUAD: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.5, 0.5, 0.1]];
pub const QUAD_NORMALS: [f32; 12] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
