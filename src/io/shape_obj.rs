//! Writes a shape of the garment as OBJ, with the vertices of its file: number, order, texture coordinates, groups.
//!
//! Format of `--export obj` and `--export rest-mesh`. One `v` per vertex of the worn pieces in file order, in metres, y up,
//! so that a program that has the source file open can take this one for a second shape of the same mesh (a rest shape,
//! a shape key, a blend shape). Triangles are those of the file, polygons cut as they were when read. Numbers read back
//! exactly. Normals are left out: readers compute them.

use crate::garment::{Garment, SourceAsset};
use crate::math::Vec3;
use crate::{Error, Result};
use std::fmt::Write;

/// Writes the worn pieces of `asset` as OBJ text, every vertex moved by the displacement [m] of its point of `garment`
/// (one per point).
pub fn write_shape_obj(asset: &SourceAsset, garment: &Garment, displacement: &[Vec3]) -> Vec<u8> {
    let mut text = String::new();
    let moved = moved_vertices(asset, garment, displacement);
    for x in &moved {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "v {:?} {:?} {:?}", x.x, x.y, x.z);
    }
    let textured = asset.worn_pieces().all(|piece| piece.uvs.is_some());
    for uv in asset.worn_pieces().filter(|_| textured).flat_map(|piece| piece.uvs.iter().flatten()) {
        // glTF counts v downwards, OBJ upwards.
        let _ = writeln!(text, "vt {:?} {:?}", uv.x, 1.0 - uv.y);
    }
    let mut first = 1u64;
    for piece in asset.worn_pieces() {
        // A name with a line break in it would start a line of its own.
        let name: String = piece.name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let _ = writeln!(text, "g {name}");
        for t in &piece.triangles {
            let [a, b, c] = t.map(|v| first + u64::from(v));
            let _ = match textured {
                true => writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}"),
                false => writeln!(text, "f {a} {b} {c}"),
            };
        }
        first += piece.positions.len() as u64;
    }
    text.into_bytes()
}

/// Returns the positions of the vertices of the worn pieces [m, y up], moved with their points.
fn moved_vertices(asset: &SourceAsset, garment: &Garment, displacement: &[Vec3]) -> Vec<Vec3> {
    let own = asset.worn_pieces().flat_map(|piece| {
        (0..piece.positions.len()).map(|v| piece.scene_position(v).unwrap_or_else(Vec3::zeros))
    });
    let shift = garment.source_point.iter().map(|p| displacement.get(p.at()).copied().unwrap_or_default());
    own.zip(shift).map(|(x, d)| x + d).collect()
}

/// Reads the positions of the vertices of a file of [`write_shape_obj`], in file order [m]; `file` names it in
/// diagnostics.
pub fn read_shape_obj(file: &str, bytes: &[u8]) -> Result<Vec<Vec3>> {
    let text = String::from_utf8_lossy(bytes);
    let mut points = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let Some(numbers) = line.strip_prefix("v ") else { continue };
        let x: Vec<f64> = numbers.split_whitespace().map_while(|w| w.parse().ok()).collect();
        match x[..] {
            [x, y, z] => points.push(Vec3::new(x, y, z)),
            _ => return Err(Error::input(file, format!("line {}", number + 1), "is no position", "")),
        }
    }
    Ok(points)
}
