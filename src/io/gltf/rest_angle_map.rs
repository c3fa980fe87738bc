//! Writes the garment with its rest angles as a vertex map (`--export rest-angle-map`), for programs that paint them.
//!
//! A GLB of the worn pieces in their source pose, vertices in number and order of the file, with
//! - `COLOR_0`: grey, 0 for -180 degrees, 0.5 for flat, 1 for +180 degrees,
//! - `_REST_ANGLE_DEG`: the same in degrees.
//!
//! Unreal's Chaos cloth takes such a map as "Rest Angle" with low -180 and high 180, with explicit rest angles; of the two
//! ends of an edge it uses the angle of lesser magnitude. The map is fitted to that rule: starting with the largest angle
//! around each vertex, each vertex in turn takes the angle among those of its hinges, their mean, or zero, that minimises
//! the squared error (weighted by edge length), until none changes. A vertex has no direction, so that an edge across a
//! crease cannot always stay flat: the loss is measured when the file is read back.

use crate::gltf::append::{Appender, Purpose};
use crate::gltf::names::REST_ANGLE_DEG_ATTRIBUTE;
use crate::gltf::obj_to_gltf::scene_pieces;
use crate::tuning::TUNING;
use crease_model::error::{Error, Result};
use crease_model::garment::{Garment, RestState, SourceAsset};
use serde_json::{Value, json};

/// Returns per point of `garment` the angle \[degrees, within +-180\] with which edges that take the angle of lesser
/// magnitude of their ends fit the rest angles of `memory` best.
fn rest_angle_per_point(garment: &Garment, memory: &RestState) -> Vec<f64> {
    let hinges = &garment.topology.hinges;
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); garment.points.len()];
    for (h, hinge) in hinges.iter().enumerate() {
        hinge.points[..2].iter().for_each(|p| around[p.at()].push(h));
    }
    let wanted: Vec<f64> = memory.rest_angle.iter().map(|a| a.to_degrees().clamp(-180.0, 180.0)).collect();
    let length = |h: usize| {
        let [a, b] = [hinges[h].points[0], hinges[h].points[1]].map(|p| garment.points[p.at()]);
        (b - a).norm()
    };
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let mut angle: Vec<f64> =
        around.iter().map(|own| own.iter().map(|&h| wanted[h]).fold(0.0, larger)).collect();
    for _ in 0..TUNING.max_rest_angle_passes {
        let mut changed = false;
        for p in 0..around.len() {
            let error = |own: f64| -> f64 {
                let one = |&h: &usize| {
                    let [a, b] = [hinges[h].points[0].at(), hinges[h].points[1].at()];
                    let other = angle[if a == p { b } else { a }];
                    let taken = if own.abs() < other.abs() { own } else { other };
                    length(h) * (taken - wanted[h]).powi(2)
                };
                around[p].iter().map(one).sum()
            };
            let lengths: f64 = around[p].iter().map(|&h| length(h)).sum();
            let mean: f64 = around[p].iter().map(|&h| length(h) * wanted[h]).sum();
            let mean = if lengths > 0.0 { mean / lengths } else { 0.0 };
            let candidates = around[p].iter().map(|&h| wanted[h]).chain([0.0, mean]);
            let (mut min_error, mut best) = (error(angle[p]), angle[p]);
            for candidate in candidates {
                let found = error(candidate);
                if found < min_error {
                    (min_error, best) = (found, candidate);
                }
            }
            changed |= best != angle[p];
            angle[p] = best;
        }
        if !changed {
            break;
        }
    }
    angle
}

/// Returns the grey value of an angle.
fn grey(degrees: f64) -> f32 {
    ((degrees + 180.0) / 360.0) as f32
}

/// Writes the worn pieces of `asset` as a GLB with the rest angles of `memory` as vertex colours and in degrees.
pub fn write_rest_angle_map(asset: &SourceAsset, garment: &Garment, memory: &RestState) -> Result<Vec<u8>> {
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
            return Err(Error::input(
                &asset.file,
                &piece.name,
                "does not belong to the garment",
                "read the file again",
            ));
        };
        rest = after;
        if piece.triangles.is_empty() {
            continue;
        }
        let rows = |all: &[crease_geometry::math::Vec3]| -> Vec<[f32; 3]> {
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
        primitives
            .push(json!({"attributes": attributes, "indices": indices, "extras": {"name": piece.name}}));
    }
    if let Some(mesh) = appender.list("meshes").first_mut() {
        mesh["primitives"] = Value::Array(primitives);
    }
    Ok(appender.into_glb())
}
