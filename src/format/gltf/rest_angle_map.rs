//! The garment with its rest angles as a vertex map (`--also rest-angle-map`), for programs that paint them.
//!
//! A GLB of the worn pieces in their own pose, vertices in number and order of the file, with
//! - `COLOR_0`: grey, 0 for -180 degrees, 0.5 for flat, 1 for +180 degrees,
//! - `_REST_ANGLE_DEG`: the same in degrees.
//!
//! Unreal's Chaos cloth takes such a map as "Rest Angle" with low -180 and high 180, rest angles being explicit; of the two
//! ends of an edge it uses the angle of lesser magnitude. So every vertex has the rest angle of largest magnitude among
//! its hinges: edges along a crease get the crease, edges that lead away from it what lies there.

use super::append::{Appender, Purpose};
use super::obj_to_gltf::scene_pieces;
use crate::format::SourceAsset;
use crate::garment::{Garment, RestShape};
use crate::{Error, Result};
use serde_json::{Value, json};

/// Name of the attribute in degrees.
pub const REST_ANGLE_DEG_ATTRIBUTE: &str = "_REST_ANGLE_DEG";

/// Per point of `garment`: the rest angle of largest magnitude among the hinges whose edge ends there (degrees, within
/// +-180); 0 where there is none.
pub fn rest_angle_per_point(garment: &Garment, memory: &RestShape) -> Vec<f64> {
    let mut angle = vec![0.0f64; garment.points.len()];
    for (hinge, &rest) in garment.topology.hinges.iter().zip(&memory.rest_angle) {
        for p in &hinge.points[..2] {
            if rest.abs() > angle[p.at()].abs() {
                angle[p.at()] = rest;
            }
        }
    }
    angle.into_iter().map(|a| a.to_degrees().clamp(-180.0, 180.0)).collect()
}

/// The grey that stands for `degrees`.
fn grey(degrees: f64) -> f32 {
    ((degrees + 180.0) / 360.0) as f32
}

/// The worn pieces of `asset` as a GLB with the rest angles of `memory` as vertex colours and in degrees.
pub fn write_rest_angle_map(asset: &SourceAsset, garment: &Garment, memory: &RestShape) -> Result<Vec<u8>> {
    let document = json!({
        "asset": {"version": "2.0", "generator": concat!("crease ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "rest angles", "mesh": 0}],
        "meshes": [{"name": "rest angles", "primitives": []}],
        "accessors": [], "bufferViews": [], "buffers": [],
    });
    let Value::Object(document) = document else { return Ok(Vec::new()) };
    let mut appender = Appender::new(document);
    let per_point = rest_angle_per_point(garment, memory);
    let mut primitives = Vec::new();
    let mut rest = &garment.source_point[..];
    for (piece, scene) in asset.pieces.iter().zip(scene_pieces(asset)).filter(|(piece, _)| piece.worn) {
        let Some((points, after)) = rest.split_at_checked(piece.positions.len()) else {
            return Err(Error::fault(&asset.file, &piece.name, "is not the garment's", "read the file again"));
        };
        rest = after;
        if piece.triangles.is_empty() {
            continue;
        }
        let rows = |all: &[crate::math::Vec3]| -> Vec<[f32; 3]> {
            all.iter().map(|x| [x.x as f32, x.y as f32, x.z as f32]).collect()
        };
        let degrees: Vec<f64> = points.iter().map(|p| per_point[p.at()]).collect();
        let colours: Vec<[f32; 4]> = degrees.iter().map(|&d| [grey(d), grey(d), grey(d), 1.0]).collect();
        let degrees: Vec<f32> = degrees.iter().map(|&d| d as f32).collect();
        let mut attributes = json!({
            "POSITION": appender.vectors(&rows(&scene.positions), Purpose::Position),
            "NORMAL": appender.vectors(&rows(&scene.normals), Purpose::Vertex),
            "COLOR_0": appender.vectors(&colours, Purpose::Vertex),
            REST_ANGLE_DEG_ATTRIBUTE: appender.scalars(&degrees, Purpose::Vertex),
        });
        if let Some(uvs) = &piece.uvs {
            let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x as f32, uv.y as f32]).collect();
            if uvs.iter().flatten().all(|x| x.is_finite()) {
                attributes["TEXCOORD_0"] = json!(appender.vectors(&uvs, Purpose::Vertex));
            }
        }
        let indices = appender.triangles(&piece.triangles);
        primitives.push(json!({"attributes": attributes, "indices": indices, "extras": {"name": piece.name}}));
    }
    if let Some(mesh) = appender.list("meshes").first_mut() {
        mesh["primitives"] = Value::Array(primitives);
    }
    Ok(appender.into_glb())
}
