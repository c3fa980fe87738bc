//! Writes a shape of the garment as OBJ, with the vertices of its file: number, order, texture coordinates, groups.
//!
//! Format of `--export obj` and `--export rest-mesh`, in metres, y up, so that a program that has the source file open can
//! take this one for a second shape of the same mesh (a rest shape, a shape key, a blend shape). Of an OBJ file every `v` line,
//! every `vt` line and every face comes back in its order, parts that are not worn as they were; of a glTF file there is one
//! `v` per vertex of the worn pieces, and their triangles. Numbers read back exactly. Normals are left out: readers compute
//! them.

use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{INVALID, PointIndex};
use crease_model::error::{Error, Result};
use crease_model::garment::{Garment, ObjLines, SourceAsset};
use std::fmt::Write;

/// Writes `asset` as OBJ text, every vertex of its worn pieces moved by the displacement [m] of its point of `garment` (one
/// per point).
pub fn write_shape_obj(asset: &SourceAsset, garment: &Garment, displacement: &[Vec3]) -> Vec<u8> {
    let moved = moved_vertices(asset, garment, displacement);
    match &asset.obj {
        Some(lines) => write_lines(asset, lines, &moved),
        None => write_pieces(asset, &moved),
    }
}

/// Writes the lines of an OBJ file with its worn vertices at `moved`.
fn write_lines(asset: &SourceAsset, lines: &ObjLines, moved: &[Vec3]) -> Vec<u8> {
    let to_scene = asset.up.to_scene(asset.unit_m);
    let mut shape: Vec<Vec3> = lines.positions.iter().map(|p| (to_scene * p.push(1.0)).xyz()).collect();
    // The last of several vertices on a line counts first, as the first counts when the file is read.
    for (&line, x) in worn_lines(asset, lines).zip(moved).collect::<Vec<_>>().into_iter().rev() {
        if let Some(slot) = shape.get_mut(line as usize) {
            *slot = *x;
        }
    }
    let mut text = String::new();
    write_vertices(&mut text, &shape);
    write_uvs(&mut text, &lines.uvs);
    let mut piece = None;
    for face in &lines.faces {
        if let Some(own) = face.piece.filter(|_| face.piece != piece).and_then(|own| asset.pieces.get(own)) {
            write_group(&mut text, &own.name);
        }
        piece = face.piece;
        text.push('f');
        for [v, vt] in &face.corners {
            let v = u64::from(*v) + 1;
            let _ = match *vt {
                INVALID => write!(text, " {v}"),
                vt => write!(text, " {v}/{}", u64::from(vt) + 1),
            };
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// Writes the worn pieces, with their vertices at `moved`.
fn write_pieces(asset: &SourceAsset, moved: &[Vec3]) -> Vec<u8> {
    let mut text = String::new();
    write_vertices(&mut text, moved);
    let textured = asset.worn_pieces().all(|piece| piece.uvs.is_some());
    for uvs in asset.worn_pieces().filter(|_| textured).filter_map(|piece| piece.uvs.as_ref()) {
        write_uvs(&mut text, uvs);
    }
    let mut first = 1u64;
    for piece in asset.worn_pieces() {
        write_group(&mut text, &piece.name);
        for t in &piece.triangles {
            let [a, b, c] = t.map(|v| first + u64::from(v));
            // Writing to a string cannot fail.
            let _ = match textured {
                true => writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}"),
                false => writeln!(text, "f {a} {b} {c}"),
            };
        }
        first += piece.positions.len() as u64;
    }
    text.into_bytes()
}

fn write_vertices(text: &mut String, positions: &[Vec3]) {
    for x in positions {
        let _ = writeln!(text, "v {:?} {:?} {:?}", x.x, x.y, x.z);
    }
}

fn write_uvs(text: &mut String, uvs: &[Vec2]) {
    for uv in uvs {
        // glTF counts v downwards, OBJ upwards.
        let _ = writeln!(text, "vt {:?} {:?}", uv.x, 1.0 - uv.y);
    }
}

fn write_group(text: &mut String, name: &str) {
    // A name with a line break in it would start a line of its own.
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let _ = writeln!(text, "g {name}");
}

/// Rows of an OBJ file that shows a garment over time: the `v` lines of its own OBJ, or one per vertex of its worn pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameRows {
    /// Per row: the point that it shows.
    pub rows: Vec<FrameRow>,
    /// Per vertex of the worn pieces, in file order: its row.
    pub row_of_vertex: Vec<u32>,
}

/// Row of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrameRow {
    /// Shows a point of the garment.
    Point(PointIndex),
    /// Stays at a position [m, y up]: it is not part of the garment.
    Fixed(Vec3),
}

impl FrameRows {
    /// The rows of `garment`, which was built from `asset`.
    pub fn of_file(asset: &SourceAsset, garment: &Garment) -> Self {
        let points = garment.source_point.iter().map(|p| FrameRow::Point(*p));
        let Some(lines) = &asset.obj else {
            let rows: Vec<FrameRow> = points.collect();
            let row_of_vertex = (0..rows.len() as u32).collect();
            return Self { rows, row_of_vertex };
        };
        let to_scene = asset.up.to_scene(asset.unit_m);
        let fixed = |p: &Vec3| FrameRow::Fixed((to_scene * p.push(1.0)).xyz());
        let mut rows: Vec<FrameRow> = lines.positions.iter().map(fixed).collect();
        let row_of_vertex: Vec<u32> = worn_lines(asset, lines).copied().collect();
        for (&line, point) in row_of_vertex.iter().zip(points) {
            if let Some(row @ FrameRow::Fixed(_)) = rows.get_mut(line as usize) {
                *row = point;
            }
        }
        Self { rows, row_of_vertex }
    }
}

/// Returns the `v` lines of the vertices of the worn pieces, in file order.
fn worn_lines<'a>(asset: &'a SourceAsset, lines: &'a ObjLines) -> impl Iterator<Item = &'a u32> {
    let pieces = asset.pieces.iter().zip(&lines.piece_positions);
    pieces.filter(|(piece, _)| piece.worn).flat_map(|(_, own)| own)
}

/// Returns the positions of the vertices of the worn pieces [m, y up], moved with their points.
fn moved_vertices(asset: &SourceAsset, garment: &Garment, displacement: &[Vec3]) -> Vec<Vec3> {
    let own = asset.worn_pieces().flat_map(|piece| {
        (0..piece.positions.len()).map(|v| piece.scene_position(v).unwrap_or_else(Vec3::zeros))
    });
    let shift = garment.source_point.iter().map(|p| displacement.get(p.at()).copied().unwrap_or_default());
    own.zip(shift).map(|(x, d)| x + d).collect()
}

/// Reads the positions of the vertices of the worn pieces of `asset` from a file of [`write_shape_obj`] or from a frame with
/// [`FrameRows`], in file order [m]; `file` names it in diagnostics.
pub fn read_shape_obj(file: &str, bytes: &[u8], asset: &SourceAsset) -> Result<Vec<Vec3>> {
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
    match &asset.obj {
        Some(lines) => {
            Ok(worn_lines(asset, lines).filter_map(|line| points.get(*line as usize)).copied().collect())
        }
        None => Ok(points),
    }
}
