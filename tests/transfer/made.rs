//! Garments of the repository and memories made by rolling them.

use crate::measure::{FOLDS, Fold};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, RestState, SourceAsset};
use crease_model::remesh::GarmentSurface;
use std::path::Path;

/// A garment of the repository and the file it was made from.
pub fn load(name: &str) -> (SourceAsset, Garment) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments").join(name);
    let bytes = std::fs::read(&path).expect("a garment of the repository");
    let mut nothing = |_: &str| Ok(Vec::new());
    let (asset, _) = read_asset(name, &bytes, &ReadOptions::default(), &mut nothing).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    (asset, garment)
}

/// Points of `surface` rolled along `fold` after flattening [m]: the surface turns by the fold's angle over its width.
pub fn rolled(surface: &GarmentSurface, fold: &Fold) -> Vec<Vec3> {
    let (half, total) = (fold.width, fold.angle);
    let bent = |s: f64| {
        // Turning angle rises evenly from 0 to the total over [-half, half].
        let inside = s.clamp(-half, half) + half;
        let rate = total / (2.0 * half);
        let phi = rate * inside;
        let arc = Vec3::new(phi.sin(), 0.0, 1.0 - phi.cos()) / rate;
        let before = Vec3::new(s.min(-half), 0.0, 0.0);
        let after = Vec3::new(phi.cos(), 0.0, phi.sin()) * (s - half).max(0.0);
        before + arc + after
    };
    let position = |p: &Vec3| {
        let b = bent(p[fold.axis] - fold.at);
        let other = p[2 - fold.axis];
        // Height is y; the sense of the roll is the same on both layers.
        if fold.axis == 0 { Vec3::new(b.x, b.z, other) } else { Vec3::new(other, b.z, b.x) }
    };
    surface.points.iter().map(position).collect()
}

/// Memory of `surface` as if every fold of [`FOLDS`] had been rolled into it.
pub fn made_memory(surface: &GarmentSurface) -> RestState {
    let angles = |x: &[Vec3]| -> Vec<f64> {
        surface.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| x[p.at()]))).collect()
    };
    let mut memory = RestState::new(angles(&surface.points), surface.triangles.len());
    let flat: Vec<Vec3> = surface.points.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
    let flat_angle = angles(&flat);
    for fold in &FOLDS {
        for (h, angle) in angles(&rolled(surface, fold)).into_iter().enumerate() {
            // At the seams the flat layers lie face to face: that half turn is no fold.
            let change = angle - flat_angle[h];
            memory.rest_angle[h] += if change.abs() < 2.0 { change } else { 0.0 };
        }
    }
    memory
}

/// A sleeve of the repository, its elbow bent by `angle` [rad] in the file.
pub fn sleeve(angle: f64) -> (SourceAsset, Garment) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/sleeve.glb");
    let bytes = std::fs::read(path).expect("a garment of the repository");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).expect("is JSON");
    let elbow = json["nodes"].as_array().and_then(|nodes| nodes.iter().position(|n| n["name"] == "elbow"));
    json["nodes"][elbow.expect("has an elbow")]["rotation"] =
        serde_json::json!([0.0, (0.5 * angle).sin(), 0.0, (0.5 * angle).cos()]);
    let mut text = serde_json::to_vec(&json).expect("is JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = bytes[..12].to_vec();
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(&bytes[16..20]);
    file.extend(text);
    file.extend(&bytes[20 + length..]);
    let all = file.len() as u32;
    file[8..12].copy_from_slice(&all.to_le_bytes());
    let options = ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() };
    let (asset, _) = read_asset("sleeve.glb", &file, &options, &mut |_| Ok(Vec::new())).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    (asset, garment)
}
