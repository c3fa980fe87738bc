//! Small glTF files for tests: meshes of a few parts, made in memory.

// Each test uses a part of them.
#![allow(dead_code)]

use crease::{Garment, GarmentFile, Vec3};
use crease_io::ReadOptions;
use crease_io::gltf::{
    DetailInput, DetailOutput, FlatNormals, MapDepth, MapOptions, add_detail_map, join_glb, write_worn_glb,
};
use crease_model::garment::{RestState, WornGarment};
use crease_model::remesh::{GarmentSurface, WornSurface};
use serde_json::{Value, json};

/// One primitive.
#[derive(Debug, Clone, Default)]
pub struct Part {
    pub positions: Vec<[f64; 3]>,
    pub uvs: Vec<[f64; 2]>,
    pub triangles: Vec<[u32; 3]>,
    pub material: Option<usize>,
}

impl Part {
    /// An upright sheet of `cells` x `cells` squares and `side` metres around `centre`, facing +z. Every second diagonal is
    /// turned.
    pub fn sheet(cells: u32, side: f64, centre: [f64; 3]) -> Self {
        let (mut part, row) = (Self::default(), cells + 1);
        for k in 0..row * row {
            let [u, v] = [k % row, k / row].map(|i| f64::from(i) / f64::from(cells));
            let [x, y, z] = centre;
            part.positions.push([x + side * (u - 0.5), y + side * (v - 0.5), z]);
            part.uvs.push([u, 1.0 - v]);
        }
        for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
            let a = j * row + i;
            let (b, c, d) = (a + 1, a + row + 1, a + row);
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            part.triangles.extend(halves);
        }
        part
    }

    /// A tube of radius `radius` and length `height` along y around `centre`, closed at both ends.
    pub fn can(around: u32, radius: f64, height: f64, centre: [f64; 3]) -> Self {
        let mut part = Self::default();
        let [x, y, z] = centre;
        for (level, k) in [-0.5, 0.5].into_iter().flat_map(|level| (0..around).map(move |k| (level, k))) {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            part.positions.push([x + radius * angle.sin(), y + level * height, z + radius * angle.cos()]);
        }
        part.positions.extend([[x, y - 0.5 * height, z], [x, y + 0.5 * height, z]]);
        let (low, high) = (2 * around, 2 * around + 1);
        for k in 0..around {
            let (a, b) = (k, (k + 1) % around);
            let (c, d) = (b + around, a + around);
            part.triangles.extend([[a, b, c], [a, c, d], [b, a, low], [d, c, high]]);
        }
        part.uvs = vec![[0.5, 0.5]; part.positions.len()];
        part
    }

    /// The part with its triangles reversed.
    pub fn reversed(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// The part with its texture coordinates mapped.
    pub fn textured(mut self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        self.uvs.iter_mut().for_each(|uv| *uv = map(*uv));
        self
    }

    /// The part with its positions mapped.
    pub fn moved(mut self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.positions.iter_mut().for_each(|x| *x = map(*x));
        self
    }

    /// The part with a material.
    pub fn of(self, material: usize) -> Self {
        Self { material: Some(material), ..self }
    }

    fn normals(&self) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.positions[v as usize]);
            let (u, v): (Vec<f64>, Vec<f64>) =
                ((0..3).map(|k| b[k] - a[k]).collect(), (0..3).map(|k| c[k] - a[k]).collect());
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            t.iter().for_each(|&p| (0..3).for_each(|k| sums[p as usize][k] += n[k]));
        }
        let unit = |n: [f64; 3]| {
            let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.0 { n.map(|x| x / length) } else { [0.0, 0.0, 1.0] }
        };
        sums.into_iter().map(unit).collect()
    }
}

/// A GLB file with a node and a mesh per entry of `nodes`; `edit` changes its JSON.
pub fn glb(nodes: &[(&str, Vec<Part>)], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut binary: Vec<u8> = Vec::new();
    let (mut views, mut accessors, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |bytes: Vec<u8>, mut accessor: Value| {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
        accessor["bufferView"] = json!(views.len() - 1);
        accessors.push(accessor);
        accessors.len() - 1
    };
    let floats =
        |rows: Vec<f64>| -> Vec<u8> { rows.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect() };
    for (name, parts) in nodes {
        let mut primitives = Vec::new();
        for part in parts {
            let count = part.positions.len();
            let range = |pick: fn(f64, f64) -> f64| -> Vec<f64> {
                (0..3)
                    .map(|k| {
                        part.positions.iter().map(|x| f64::from(x[k] as f32)).reduce(pick).unwrap_or(0.0)
                    })
                    .collect()
            };
            let vector = |kind: &str| json!({"componentType": 5126, "count": count, "type": kind});
            let mut positions = vector("VEC3");
            (positions["min"], positions["max"]) = (json!(range(f64::min)), json!(range(f64::max)));
            let indices = json!({"componentType": 5125, "count": 3 * part.triangles.len(), "type": "SCALAR"});
            let bytes = part.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
            let mut primitive = json!({
                "attributes": {
                    "POSITION": add(floats(part.positions.concat()), positions),
                    "NORMAL": add(floats(part.normals().concat()), vector("VEC3")),
                    "TEXCOORD_0": add(floats(part.uvs.concat()), vector("VEC2")),
                },
                "indices": add(bytes, indices),
            });
            if let Some(material) = part.material {
                primitive["material"] = json!(material);
            }
            primitives.push(primitive);
        }
        meshes.push(json!({"name": name, "primitives": primitives}));
    }
    let count = nodes.len();
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": (0..count).collect::<Vec<_>>()}],
        "nodes": nodes.iter().enumerate().map(|(k, (name, _))| json!({"name": name, "mesh": k})).collect::<Vec<_>>(),
        "meshes": meshes, "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": binary.len()}],
    });
    edit(&mut document);
    join_glb(&document, &binary)
}

/// The JSON of a GLB file.
pub fn json_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("is there")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("is JSON")
}

/// The detail maps, `side` texels wide, of the garment in `bytes`, refined to 10 mm, where its wrinkles have the `height` [m] at each place;
/// and the JSON of the worn file.
pub fn detail_map(bytes: &[u8], height: impl Fn(&Vec3) -> f64, side: usize) -> (DetailOutput, Value) {
    let own = GarmentFile::parse("a.glb", bytes, &ReadOptions::default()).expect("is a garment");
    let refined = own.garment.refine(0.01, &[]);
    let worn = |garment: &Garment| WornGarment {
        displacement: garment.points.iter().map(|p| Vec3::new(0.0, 0.0, height(p))).collect(),
        memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
    };
    let coarse = worn(&own.garment);
    let glb = write_worn_glb(&own.asset, &own.garment, &coarse, &Value::Null).expect("writes");
    let mesh = GarmentSurface::without_texture(&refined.garment);
    let input = DetailInput {
        coarse: &own.garment,
        displacement: &coarse.displacement,
        surface: &WornSurface::new(&mesh, &worn(&refined.garment), 2e-3),
        flat_normals: FlatNormals::default(),
    };
    let output =
        add_detail_map(&glb, &own.asset, &input, MapOptions::new(side, MapDepth::Eight)).expect("is made");
    let json = json_of(&output.glb);
    (output, json)
}
