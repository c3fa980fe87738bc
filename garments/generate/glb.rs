//! Garments as binary glTF: one buffer, plain accessors, f32 and u32, nothing optional.

use crate::Mesh;
use crease::math::Vec3;
use serde_json::{Value, json};

/// Component types of glTF.
const U8: u32 = 5121;
const U32: u32 = 5125;
const F32: u32 = 5126;
/// Buffer view targets of glTF.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A joint of a skeleton that stands unturned.
pub struct Joint {
    /// Its name.
    pub name: &'static str,
    /// Where it stands [m].
    pub place: Vec3,
    /// The joint above it, one before it in the list.
    pub parent: Option<usize>,
}

/// Skin weights at a place [m]: at most four (joint, weight), the weights summing to one.
pub type Weights<'a> = &'a dyn Fn(&Vec3) -> Vec<(u8, f64)>;

/// A clip: key times [s], and for each joint that turns its turns at them as (x, y, z, w).
pub type Clip = (Vec<[f32; 1]>, Vec<(usize, Vec<[f32; 4]>)>);

/// A body with the garment it wears.
pub struct Dressed<'a> {
    /// Names of body and garment.
    pub names: [&'a str; 2],
    /// Body and garment.
    pub meshes: [&'a Mesh; 2],
    /// What moves both.
    pub joints: &'a [Joint],
    /// How.
    pub weights: Weights<'a>,
    /// Name of the clip.
    pub clip_name: &'a str,
    /// The clip.
    pub clip: Clip,
    /// Of the cloth.
    pub colour: [f64; 3],
}

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
    fn primitive(&mut self, mesh: &Mesh, material: usize, weights: Option<Weights>) -> Value {
        let narrow = |rows: &[Vec3]| -> Vec<[f32; 3]> {
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
        if let Some(weights) = weights {
            let count = mesh.positions.len();
            let (mut joints, mut shares) = (Vec::with_capacity(4 * count), Vec::with_capacity(count));
            for p in &mesh.positions {
                // A joint without weight must be joint 0: glTF forbids unused references.
                let (mut joint, mut share) = ([0u8; 4], [0f32; 4]);
                for (k, (j, w)) in weights(p).into_iter().enumerate() {
                    (joint[k], share[k]) = (if w > 0.0 { j } else { 0 }, w as f32);
                }
                joints.extend(joint);
                shares.push(share);
            }
            let accessor = json!({"componentType": U8, "count": count, "type": "VEC4"});
            attributes["JOINTS_0"] = json!(self.push(&joints, Some(VERTICES), accessor));
            attributes["WEIGHTS_0"] = json!(self.floats(&shares, "VEC4", Some(VERTICES), false));
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
    let primitive = buffer.primitive(cloth, 0, None);
    buffer.glb(json!({
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": [primitive]}],
        "materials": [material("cloth", colour, true)],
    }))
}

/// A garment on its body, both bound to the same joints, with one clip.
pub fn dressed(what: Dressed) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let Dressed { names, meshes, joints, weights, clip_name, clip, colour } = what;
    let [body, cloth] = [0, 1].map(|k| buffer.primitive(meshes[k], k, Some(weights)));
    let bind: Vec<[f32; 16]> = joints
        .iter()
        .map(|joint| {
            let mut m = [0.0; 16];
            (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
            let home = Vec3::zeros() - joint.place;
            (m[12], m[13], m[14]) = (home.x as f32, home.y as f32, home.z as f32);
            m
        })
        .collect();
    let bind = buffer.floats(&bind, "MAT4", None, false);
    // Nodes: body, garment, then the joints.
    const FIRST: usize = 2;
    let node = |(k, joint): (usize, &Joint)| {
        let above = joint.parent.map_or(Vec3::zeros(), |p| joints[p].place);
        let [x, y, z]: [f64; 3] = (joint.place - above).into();
        let mut node = json!({"name": joint.name, "translation": [x, y, z]});
        let children: Vec<usize> =
            (0..joints.len()).filter(|c| joints[*c].parent == Some(k)).map(|c| FIRST + c).collect();
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    let mut nodes: Vec<Value> =
        names.iter().enumerate().map(|(k, name)| json!({"name": name, "mesh": k, "skin": 0})).collect();
    nodes.extend(joints.iter().enumerate().map(node));
    let (times, turns) = clip;
    let times = buffer.floats(&times, "SCALAR", None, true);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for (joint, turns) in turns {
        channels
            .push(json!({"sampler": samplers.len(), "target": {"node": FIRST + joint, "path": "rotation"}}));
        let turns = buffer.floats(&turns, "VEC4", None, false);
        samplers.push(json!({"input": times, "output": turns, "interpolation": "LINEAR"}));
    }
    let all: Vec<usize> = (0..joints.len()).map(|k| FIRST + k).collect();
    buffer.glb(json!({
        "scenes": [{"nodes": [0, 1, FIRST]}],
        "nodes": nodes,
        "skins": [{"name": names[0], "joints": all, "skeleton": FIRST, "inverseBindMatrices": bind}],
        "animations": [{"name": clip_name, "channels": channels, "samplers": samplers}],
        "meshes": [{"name": names[0], "primitives": [body]}, {"name": names[1], "primitives": [cloth]}],
        "materials": [material("skin", [0.60, 0.42, 0.33], false), material("cloth", colour, true)],
    }))
}
