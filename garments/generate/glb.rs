//! Binary glTF files of garments: one buffer, plain accessors of f32 and u32, no optional features.

use crate::Mesh;
use crease_geometry::math::Vec3;
use serde_json::{Value, json};

/// Component types of glTF.
const U8: u32 = 5121;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Buffer view targets of glTF.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A joint of a skeleton whose rest pose has no rotations.
pub struct Joint {
    /// Name of its node.
    pub name: &'static str,
    /// Position in the rest pose [m].
    pub position: Vec3,
    /// Index of the parent, an earlier one in the list; `None` for the root.
    pub parent: Option<usize>,
}

/// Skin weights at a position [m]: at most four pairs of joint and weight; the weights sum to one.
pub type SkinWeights<'a> = &'a dyn Fn(&Vec3) -> Vec<(u8, f64)>;

/// Rotations of one joint.
pub struct JointRotations {
    /// Index of the joint.
    pub joint: usize,
    /// Quaternions (x, y, z, w), one per key time.
    pub rotations: Vec<[f32; 4]>,
}

/// An animation clip.
pub struct Clip {
    /// Name of the clip.
    pub name: &'static str,
    /// Key times [s].
    pub times: Vec<[f32; 1]>,
    /// Rotations of every moving joint.
    pub rotations: Vec<JointRotations>,
}

/// An animated body and its garment.
pub struct DressedBody<'a> {
    /// Name of the body's node and mesh.
    pub body_name: &'a str,
    /// Mesh of the body.
    pub body: &'a Mesh,
    /// Name of the garment's node and mesh.
    pub garment_name: &'a str,
    /// Mesh of the garment.
    pub garment: &'a Mesh,
    /// Skeleton of both.
    pub joints: &'a [Joint],
    /// Skin weights of both.
    pub weights: SkinWeights<'a>,
    /// Animation of the skeleton.
    pub clip: Clip,
    /// Base colour of the cloth, linear RGB.
    pub colour: [f64; 3],
}

/// Buffer under construction, with its views and accessors.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Appends `data` with its view and `accessor`; returns the index of the accessor.
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

    /// Appends rows of floats; `bounds` adds minimum and maximum, which glTF requires for positions and key times.
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

    /// Appends one primitive with the triangles and attributes of `mesh`.
    fn primitive(&mut self, mesh: &Mesh, material: usize, weights: Option<SkinWeights>) -> Value {
        let to_f32 = |rows: &[Vec3]| -> Vec<[f32; 3]> {
            rows.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect()
        };
        let mut attributes = json!({
            "POSITION": self.floats(&to_f32(&mesh.positions), "VEC3", Some(VERTICES), true),
            "NORMAL": self.floats(&to_f32(&mesh.normals), "VEC3", Some(VERTICES), false),
        });
        if !mesh.uvs.is_empty() {
            let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|p| [p.x as f32, p.y as f32]).collect();
            attributes["TEXCOORD_0"] = json!(self.floats(&uvs, "VEC2", Some(VERTICES), false));
        }
        if let Some(weights) = weights {
            let count = mesh.positions.len();
            let (mut joints, mut all_weights) = (Vec::with_capacity(4 * count), Vec::with_capacity(count));
            for p in &mesh.positions {
                // A joint without weight must be joint 0: glTF forbids unused references.
                let (mut joint, mut weight) = ([0u8; 4], [0f32; 4]);
                for (k, (j, w)) in weights(p).into_iter().enumerate() {
                    (joint[k], weight[k]) = (if w > 0.0 { j } else { 0 }, w as f32);
                }
                joints.extend(joint);
                all_weights.push(weight);
            }
            let accessor = json!({"componentType": U8, "count": count, "type": "VEC4"});
            attributes["JOINTS_0"] = json!(self.push(&joints, Some(VERTICES), accessor));
            attributes["WEIGHTS_0"] = json!(self.floats(&all_weights, "VEC4", Some(VERTICES), false));
        }
        let indices: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = json!({"componentType": U32, "count": 3 * mesh.triangles.len(), "type": "SCALAR"});
        let indices = self.push(&indices, Some(INDICES), accessor);
        json!({"attributes": attributes, "indices": indices, "material": material})
    }

    /// Assembles the file: header, JSON chunk, binary chunk.
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

/// File of a flat garment: one node, no body.
pub fn flat_garment(name: &str, cloth: &Mesh, colour: [f64; 3]) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let primitive = buffer.primitive(cloth, 0, None);
    buffer.glb(json!({
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": [primitive]}],
        "materials": [material("cloth", colour, true)],
    }))
}

/// A garment on its body, both bound to the same joints, with one clip.
pub fn dressed_body(dressed: &DressedBody) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let DressedBody { body_name, body, garment_name, garment, joints, weights, clip, colour } = dressed;
    let body = buffer.primitive(body, 0, Some(*weights));
    let cloth = buffer.primitive(garment, 1, Some(*weights));
    let bind: Vec<[f32; 16]> = joints
        .iter()
        .map(|joint| {
            let mut m = [0.0; 16];
            (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
            let to_joint = Vec3::zeros() - joint.position;
            (m[12], m[13], m[14]) = (to_joint.x as f32, to_joint.y as f32, to_joint.z as f32);
            m
        })
        .collect();
    let bind = buffer.floats(&bind, "MAT4", None, false);
    // Nodes: body, garment, then the joints.
    const FIRST_JOINT: usize = 2;
    let node = |(k, joint): (usize, &Joint)| {
        let parent = joint.parent.map_or(Vec3::zeros(), |p| joints[p].position);
        let [x, y, z]: [f64; 3] = (joint.position - parent).into();
        let mut node = json!({"name": joint.name, "translation": [x, y, z]});
        let children: Vec<usize> =
            (0..joints.len()).filter(|c| joints[*c].parent == Some(k)).map(|c| FIRST_JOINT + c).collect();
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    let mut nodes: Vec<Value> = [body_name, garment_name]
        .iter()
        .enumerate()
        .map(|(k, name)| json!({"name": name, "mesh": k, "skin": 0}))
        .collect();
    nodes.extend(joints.iter().enumerate().map(node));
    let times = buffer.floats(&clip.times, "SCALAR", None, true);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for JointRotations { joint, rotations } in &clip.rotations {
        channels.push(
            json!({"sampler": samplers.len(), "target": {"node": FIRST_JOINT + joint, "path": "rotation"}}),
        );
        let rotations = buffer.floats(rotations, "VEC4", None, false);
        samplers.push(json!({"input": times, "output": rotations, "interpolation": "LINEAR"}));
    }
    let all: Vec<usize> = (0..joints.len()).map(|k| FIRST_JOINT + k).collect();
    buffer.glb(json!({
        "scenes": [{"nodes": [0, 1, FIRST_JOINT]}],
        "nodes": nodes,
        "skins": [{"name": body_name, "joints": all, "skeleton": FIRST_JOINT, "inverseBindMatrices": bind}],
        "animations": [{"name": clip.name, "channels": channels, "samplers": samplers}],
        "meshes": [{"name": body_name, "primitives": [body]}, {"name": garment_name, "primitives": [cloth]}],
        "materials": [material("skin", [0.60, 0.42, 0.33], false), material("cloth", *colour, true)],
    }))
}
