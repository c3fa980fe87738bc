//! Garments as binary glTF: one buffer, plain accessors, f32 and u32, nothing optional.

use crate::{Mesh, arm};
use serde_json::{Value, json};

/// Component types of glTF.
const U8: u32 = 5121;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Buffer view targets of glTF.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A buffer under construction, with its views and accessors.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn push(&mut self, data: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.bytes.extend_from_slice(data);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Rows of floats; `bounds` adds least and greatest, which glTF demands of positions and key times.
    fn floats<const N: usize>(
        &mut self,
        rows: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
        bounds: bool,
    ) -> usize {
        let data: Vec<u8> = rows.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
        let mut accessor = json!({"componentType": F32, "count": rows.len(), "type": kind});
        if bounds {
            let fold = |pick: fn(f32, f32) -> f32, start: f32| -> Vec<f64> {
                (0..N).map(|k| f64::from(rows.iter().map(|r| r[k]).fold(start, pick))).collect()
            };
            accessor["min"] = json!(fold(f32::min, f32::INFINITY));
            accessor["max"] = json!(fold(f32::max, f32::NEG_INFINITY));
        }
        self.push(&data, target, accessor)
    }

    /// One primitive of `mesh`, triangles and attributes.
    fn primitive(&mut self, mesh: &Mesh, material: usize, skinned: bool) -> Value {
        let narrow = |rows: &[crease::math::Vec3]| -> Vec<[f32; 3]> {
            rows.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect()
        };
        let mut attributes = json!({
            "POSITION": self.floats(&narrow(&mesh.positions), "VEC3", Some(VERTICES), true),
            "NORMAL": self.floats(&narrow(&mesh.normals), "VEC3", Some(VERTICES), false),
        });
        if !mesh.uvs.is_empty() {
            let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|p| [p.x as f32, p.y as f32]).collect();
            attributes["TEXCOORD_0"] = json!(self.floats(&uvs, "VEC2", Some(VERTICES), false));
        }
        if skinned {
            let count = mesh.positions.len();
            // A joint without weight must be joint 0: glTF forbids unused references.
            let weights: Vec<[f32; 4]> = mesh
                .positions
                .iter()
                .map(|p| {
                    let [a, b, c] = arm::weights(p.x).map(|w| w as f32);
                    [a, b, c, 0.0]
                })
                .collect();
            let joints: Vec<u8> = weights
                .iter()
                .flat_map(|w| (0..4u8).map(|k| if w[usize::from(k)] > 0.0 { k } else { 0 }))
                .collect();
            let accessor = json!({"componentType": U8, "count": count, "type": "VEC4"});
            attributes["JOINTS_0"] = json!(self.push(&joints, Some(VERTICES), accessor));
            attributes["WEIGHTS_0"] = json!(self.floats(&weights, "VEC4", Some(VERTICES), false));
        }
        let indices: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = json!({"componentType": U32, "count": 3 * mesh.triangles.len(), "type": "SCALAR"});
        let indices = self.push(&indices, Some(INDICES), accessor);
        json!({"attributes": attributes, "indices": indices, "material": material})
    }

    /// Closes the file: header, JSON chunk, binary chunk.
    fn glb(self, mut document: Value) -> Vec<u8> {
        document["asset"] = json!({"version": "2.0", "generator": "crease generate_garments"});
        document["scene"] = json!(0);
        document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        document["bufferViews"] = json!(self.views);
        document["accessors"] = json!(self.accessors);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut file = Vec::new();
        file.extend_from_slice(b"glTF");
        for word in [2, (12 + 8 + text.len() + 8 + self.bytes.len()) as u32, text.len() as u32] {
            file.extend_from_slice(&word.to_le_bytes());
        }
        file.extend_from_slice(b"JSON");
        file.extend_from_slice(&text);
        file.extend_from_slice(&(self.bytes.len() as u32).to_le_bytes());
        file.extend_from_slice(b"BIN\0");
        file.extend_from_slice(&self.bytes);
        file
    }
}

fn material(name: &str, [r, g, b]: [f64; 3], double_sided: bool) -> Value {
    json!({
        "name": name,
        "doubleSided": double_sided,
        "pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9},
    })
}

/// A garment that lies on the ground, one node, no body.
pub fn flat_garment(name: &str, cloth: &Mesh, colour: [f64; 3]) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let primitive = buffer.primitive(cloth, 0, false);
    buffer.glb(json!({
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": [primitive]}],
        "materials": [material("cloth", colour, true)],
    }))
}

/// Keys of the clip "elbow": 0 to 120 degrees and back within 2 s, starting and ending at rest.
fn elbow_keys() -> (Vec<[f32; 1]>, Vec<[f32; 4]>) {
    const KEYS: usize = 32;
    (0..=KEYS)
        .map(|k| {
            let turn = k as f64 / KEYS as f64;
            let angle = 120f64.to_radians() * 0.5 * (1.0 - (std::f64::consts::TAU * turn).cos());
            let (sin, cos) = (angle / 2.0).sin_cos();
            ([(2.0 * turn) as f32], [0.0, 0.0, sin as f32, cos as f32])
        })
        .unzip()
}

/// The sleeve on its arm, both bound to the same three joints, with the clip "elbow".
pub fn dressed_arm(body: &Mesh, cloth: &Mesh) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let body = buffer.primitive(body, 0, true);
    let cloth = buffer.primitive(cloth, 1, true);
    let bind: Vec<[f32; 16]> = arm::JOINTS
        .iter()
        .map(|&x| {
            let mut m = [0.0; 16];
            (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
            (m[12], m[13]) = (-x as f32, -arm::HEIGHT as f32);
            m
        })
        .collect();
    let bind = buffer.floats(&bind, "MAT4", None, false);
    let (times, turns) = elbow_keys();
    let times = buffer.floats(&times, "SCALAR", None, true);
    let turns = buffer.floats(&turns, "VEC4", None, false);
    let [shoulder, elbow, wrist] = arm::JOINTS;
    buffer.glb(json!({
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"name": "arm", "mesh": 0, "skin": 0},
            {"name": "sleeve", "mesh": 1, "skin": 0},
            {"name": "shoulder", "translation": [shoulder, arm::HEIGHT, 0.0], "children": [3]},
            {"name": "elbow", "translation": [elbow - shoulder, 0.0, 0.0], "children": [4]},
            {"name": "wrist", "translation": [wrist - elbow, 0.0, 0.0]},
        ],
        "skins": [{"name": "arm", "joints": [2, 3, 4], "skeleton": 2, "inverseBindMatrices": bind}],
        "animations": [{
            "name": "elbow",
            "channels": [{"sampler": 0, "target": {"node": 3, "path": "rotation"}}],
            "samplers": [{"input": times, "output": turns, "interpolation": "LINEAR"}],
        }],
        "meshes": [{"name": "arm", "primitives": [body]}, {"name": "sleeve", "primitives": [cloth]}],
        "materials": [material("skin", [0.60, 0.42, 0.33], false), material("cloth", [0.62, 0.35, 0.25], true)],
    }))
}
