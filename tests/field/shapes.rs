//! Small glTF documents of tubes: garments, bodies and arms of two joints.

// Each test uses a part of them.
#![allow(dead_code)]

use crate::document::Document;
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, ImportDiagnostic, SourceAsset, SourcePiece};
use serde_json::{Value, json};

/// Corners around a tube.
pub const AROUND: u16 = 12;
/// Rings along a tube.
pub const RINGS: u16 = 9;

/// Rings of a tube along x of this radius and length [m].
pub fn tube(radius: f32, length: f32) -> Vec<[f32; 3]> {
    let at = |k: u16| std::f32::consts::TAU * f32::from(k) / f32::from(AROUND);
    let ring = |j: u16| {
        let x = (f32::from(j) / f32::from(RINGS - 1) - 0.5) * length;
        (0..AROUND).map(move |k| [x, radius * at(k).cos(), radius * at(k).sin()])
    };
    (0..RINGS).flat_map(ring).collect()
}

/// Corners of the triangles of a tube, outwards, or inwards.
pub fn tube_corners(outwards: bool) -> Vec<u16> {
    let squares = (0..RINGS - 1).flat_map(|j| (0..AROUND).map(move |k| (j, k)));
    let corner = |j: u16, k: u16| j * AROUND + k % AROUND;
    squares
        .flat_map(|(j, k)| {
            let [a, b, c, d] = [corner(j, k), corner(j, k + 1), corner(j + 1, k + 1), corner(j + 1, k)];
            if outwards { [a, b, c, a, c, d] } else { [a, c, b, a, d, c] }
        })
        .collect()
}

/// Adds a mesh of a tube; returns its number.
pub fn add_tube(document: &mut Document, positions: &[[f32; 3]], outwards: bool) -> usize {
    let position = document.positions(positions);
    let indices = document.indices(&tube_corners(outwards));
    let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
    document.push("meshes", json!({"primitives": [primitive]}))
}

/// Adds a node to the document and to its scene; returns its number.
pub fn add_node(document: &mut Document, node: Value) -> usize {
    let number = document.push("nodes", node);
    if let Some(nodes) = document.json["scenes"][0]["nodes"].as_array_mut() {
        nodes.retain(|other| other != number);
        nodes.push(json!(number));
    }
    number
}

/// A document whose scene shows nothing yet.
pub fn empty() -> Document {
    let mut document = Document::new();
    document.json["scenes"] = json!([{"nodes": []}]);
    document
}

/// Adds two joints, 0.2 m apart, called `names`, under a node; returns the skin. Vertices beyond x = 0 follow the second.
pub fn add_arm(document: &mut Document, names: [Option<&str>; 2], above: &str) -> usize {
    let named = |name: Option<&str>, mut node: Value| {
        if let Some(name) = name {
            node["name"] = json!(name);
        }
        node
    };
    let lower = document.push("nodes", named(names[1], json!({"translation": [0.2, 0, 0]})));
    let upper =
        document.push("nodes", named(names[0], json!({"translation": [-0.2, 0, 0], "children": [lower]})));
    add_node(document, json!({"name": above, "children": [upper]}));
    let mut inverse = [[0.0f32; 16]; 2];
    for (matrix, x) in inverse.iter_mut().zip([0.2, 0.0]) {
        (matrix[0], matrix[5], matrix[10], matrix[15], matrix[12]) = (1.0, 1.0, 1.0, 1.0, x);
    }
    let inverse = document.floats("MAT4", 16, inverse.as_flattened());
    document.push("skins", json!({"joints": [upper, lower], "inverseBindMatrices": inverse}))
}

/// Binds the tube `mesh` to a skin of [`add_arm`].
pub fn bind(document: &mut Document, mesh: usize, positions: &[[f32; 3]]) {
    let weights: Vec<f32> = positions
        .iter()
        .flat_map(|[x, _, _]| if *x > 0.0 { [0.0, 1.0, 0.0, 0.0] } else { [1.0, 0.0, 0.0, 0.0] })
        .collect();
    let joints: Vec<u8> = positions.iter().flat_map(|_| [0, 1, 0, 0]).collect();
    let weights = document.floats("VEC4", 4, &weights);
    let view = document.view(&joints, None);
    let joints = document.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5121, "count": positions.len(), "type": "VEC4"}),
    );
    let attributes = &mut document.json["meshes"][mesh]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
}

/// Adds a clip of one channel of vectors or quaternions.
pub fn add_clip(document: &mut Document, name: &str, node: usize, path: &str, times: &[f32], values: &[f32]) {
    let width = values.len() / times.len();
    let kind = if width == 3 { "VEC3" } else { "VEC4" };
    let (input, output) = (document.floats("SCALAR", 1, times), document.floats(kind, width, values));
    let clip = json!({
        "name": name,
        "samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
    });
    document.push("animations", clip);
}

/// The quaternion of a rotation by `degrees` about y.
pub fn about_y(degrees: f32) -> [f32; 4] {
    let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
    [0.0, sin, 0.0, cos]
}

pub fn read_with(
    name: &str,
    bytes: &[u8],
    options: &ReadOptions,
) -> crease::Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    read_asset(name, bytes, options, &mut |other| {
        Err(crease::Error::input(name, other, "is another file", ""))
    })
}

pub fn named(garment: &str) -> ReadOptions {
    ReadOptions { garment: Some(garment.to_owned()), ..ReadOptions::default() }
}

pub fn garment_of(asset: &SourceAsset) -> (Garment, Vec<ImportDiagnostic>) {
    Garment::from_asset(asset).expect("is a garment")
}

/// Fraction of the triangles of a tube along x that face away from its axis.
pub fn outward_fraction(points: &[Vec3], triangles: &[[crease_geometry::mesh::PointIndex; 3]]) -> f64 {
    let is_outward = |t: &&[crease_geometry::mesh::PointIndex; 3]| {
        let [a, b, c] = t.map(|p| points[p.at()]);
        let middle = (a + b + c) / 3.0;
        (b - a).cross(&(c - a)).dot(&Vec3::new(0.0, middle.y, middle.z)) > 0.0
    };
    triangles.iter().filter(is_outward).count() as f64 / triangles.len() as f64
}

pub fn pieces(asset: &SourceAsset) -> Vec<&SourcePiece> {
    asset.pieces.iter().collect()
}
