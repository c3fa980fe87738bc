//! Reads a document, builds a garment of it, wears it, and writes it again with all checks.

use crate::checks::{assert_counts, assert_displaced, assert_kept, assert_same_bytes};
use crease_geometry::math::Rng;
use crease_geometry::mesh::PointIndex;
use crease_io::gltf::{split_glb, write_worn_glb};
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, RestState, SourceAsset, WornGarment};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;

pub fn read(name: &str, bytes: &[u8], garment: Option<&str>) -> SourceAsset {
    let options = ReadOptions {
        garment: garment.map(str::to_owned),
        unit_m: Some(1.0),
        any_size: true,
        ..Default::default()
    };
    let mut nothing = |uri: &str| panic!("asks for {uri}");
    read_asset(name, bytes, &options, &mut nothing).unwrap().0
}

/// Builds a garment of the worn pieces: vertices at the same position are one point.
pub fn garment(asset: &SourceAsset) -> Garment {
    let mut known: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let (mut points, mut source_point, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for piece in asset.worn_pieces() {
        let first = source_point.len();
        for v in 0..piece.positions.len() {
            let p = piece.scene_position(v).unwrap();
            let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
            let point = *known.entry(key).or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            });
            source_point.push(PointIndex(point));
        }
        let welded = piece.triangles.iter().map(|t| t.map(|v| source_point[first + v as usize].0));
        triangles.extend(welded.filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
    }
    Garment { source_point, ..Garment::of_triangles(points, &triangles) }
}

/// Returns a displacement of some centimetres and a memory; the same on every machine.
pub fn some_wear(garment: &Garment) -> WornGarment {
    let mut rng = Rng::from_state(1);
    let mut next = || rng.uniform() - 0.5;
    let hinges = garment.topology.hinges.len();
    WornGarment {
        displacement: garment.points.iter().map(|_| Vector3::new(next(), next(), next()) * 0.1).collect(),
        memory: RestState {
            source_angle: (0..hinges).map(|_| next()).collect(),
            rest_angle: (0..hinges).map(|_| next() * 2.0).collect(),
            stiffness_ratio: (0..hinges).map(|_| 1.5 + next()).collect(),
            rest_stretch_warp: vec![1.0; garment.triangles.len()],
            rest_stretch_weft: vec![1.0; garment.triangles.len()],
        },
    }
}

pub fn extras() -> Value {
    json!({"crease": {"sidecar": "OUT.crease.json"}})
}

/// Wears `bytes`, checks the conditions for every file, keeps the output for the validator, and returns it.
pub fn wear(name: &str, bytes: &[u8], chosen: Option<&str>) -> Vec<u8> {
    wear_asset(name, &read(name, bytes, chosen))
}

pub fn wear_asset(name: &str, asset: &SourceAsset) -> Vec<u8> {
    wear_garment(name, asset, &garment(asset))
}

pub fn wear_garment(name: &str, asset: &SourceAsset, garment: &Garment) -> Vec<u8> {
    let worn = some_wear(garment);
    let glb = write_worn_glb(asset, garment, &worn, &extras()).unwrap();
    leave(name, &glb);
    let (json, _) = split_glb(&glb).unwrap();
    if let Some(before) = &asset.document {
        let (_, binary) = split_glb(&glb).unwrap();
        assert_kept(&before.json, &json, "");
        assert_same_bytes(&before.json, &before.buffers, &json, &binary.unwrap());
    }
    assert_counts(&json);
    assert_displaced(asset, garment, &worn, &glb);
    glb
}

/// Keeps an output for the validator.
pub fn leave(name: &str, glb: &[u8]) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("export");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join(format!("{name}.glb")), glb).unwrap();
}
