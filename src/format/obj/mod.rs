//! Wavefront OBJ, read by a tolerant line reader of ours. The `obj-rs` crate panics on some keywords, refuses colours,
//! blanks in names and mixed corners, and reads single precision, so it serves as the oracle in tests.
//!
//! Statements -> pieces: a piece is what stands under one object, group and material; a vertex is a `v/vt/vn` triplet,
//! in order of first use. Material libraries are not read: names are all that is kept of materials.

mod lines;
mod parse;
mod polygon;

use super::fault_list::FaultList;
use super::read::{NamedPiece, ReadPieces};
use super::{Placement, SourcePiece};
use crate::garment::{Finding, Severity};
use crate::math::{Mat4, Vec2, Vec3};
use crate::{Error, Result};
use parse::{Corner, Label, NONE, Statements};
use polygon::{PolygonCutter, newell_normal};
use rustc_hash::FxHashMap;

/// Name of a piece under neither object nor group.
const UNNAMED: &str = "default";

/// The pieces of an OBJ file.
pub(super) fn read_obj(file: &str, bytes: &[u8], to_scene: &Mat4, mask: Option<&str>) -> Result<ReadPieces> {
    let mut faults = FaultList::new(file);
    let mut statements = parse::parse(bytes, &mut faults);
    faults.finish()?;
    let mask = mask.map(|wanted| mask_component(file, wanted, &statements)).transpose()?;
    let mut findings = std::mem::take(&mut statements.findings);
    let mut builders: Vec<PieceBuilder> = statements.labels.iter().map(|_| PieceBuilder::default()).collect();
    let mut cutter = PolygonCutter::new();
    for face in &statements.faces {
        let corners = statements.corners.get(face.corners.clone()).unwrap_or(&[]);
        if let Some(builder) = builders.get_mut(face.label) {
            builder.add_face(&statements, corners, &mut cutter);
        }
    }
    if cutter.fan_count > 0 {
        findings.push(Finding {
            severity: Severity::Note,
            place: String::new(),
            what: format!("{} faces cross themselves or have no area: cut as they come", cutter.fan_count),
        });
    }
    let pieces = builders
        .into_iter()
        .zip(&statements.labels)
        .enumerate()
        .map(|(number, (builder, label))| builder.finish(number, label, to_scene, mask, &statements))
        .collect();
    Ok(ReadPieces { pieces, document: None, findings })
}

/// Which colour component scales the memory.
fn mask_component(file: &str, wanted: &str, statements: &Statements) -> Result<usize> {
    let component = match wanted {
        "COLOR_0" | "COLOR_0.r" | "COLOR_0.x" => Some(0),
        "COLOR_0.g" | "COLOR_0.y" => Some(1),
        "COLOR_0.b" | "COLOR_0.z" => Some(2),
        _ => None,
    };
    match component {
        Some(component) if statements.has_colours => Ok(component),
        Some(_) => {
            Err(Error::fault(file, "", "no vertex colours in it to take the mask from", "leave out --mask"))
        }
        None => Err(Error::fault(
            file,
            "",
            format!("no vertex attribute called \"{wanted}\""),
            "an OBJ file has COLOR_0, with .r .g .b",
        )),
    }
}

/// A piece in the making.
#[derive(Default)]
struct PieceBuilder {
    numbers: FxHashMap<Corner, u32>,
    corners: Vec<Corner>,
    /// Per vertex: normal of the first face that uses it, for corners without one.
    face_normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl PieceBuilder {
    fn add_face(&mut self, statements: &Statements, corners: &[Corner], cutter: &mut PolygonCutter) {
        let at = |corner: &Corner| statements.positions.get(corner.position as usize).copied();
        let positions: Vec<Vec3> = corners.iter().filter_map(at).collect();
        let normal = newell_normal(&positions).try_normalize(0.0).unwrap_or_else(Vec3::y);
        let vertices: Vec<u32> = corners.iter().map(|corner| self.vertex(*corner, normal)).collect();
        for triangle in cutter.cut(&positions) {
            self.triangles.push(triangle.map(|k| vertices[k as usize]));
        }
    }

    fn vertex(&mut self, corner: Corner, face_normal: Vec3) -> u32 {
        let next = self.corners.len() as u32;
        let number = *self.numbers.entry(corner).or_insert(next);
        if number == next {
            self.corners.push(corner);
            self.face_normals.push(face_normal);
        }
        number
    }

    fn finish(
        self,
        number: usize,
        label: &Label,
        to_scene: &Mat4,
        mask: Option<usize>,
        statements: &Statements,
    ) -> NamedPiece {
        let (has_uvs, has_normals) =
            (self.corners.iter().any(|c| c.uv != NONE), self.corners.iter().any(|c| c.normal != NONE));
        let position =
            |c: &Corner| statements.positions.get(c.position as usize).copied().unwrap_or_default();
        let uv = |c: &Corner| statements.uvs.get(c.uv as usize).copied().unwrap_or_else(Vec2::zeros);
        let normal = |(c, face_normal): (&Corner, &Vec3)| {
            let own = statements.normals.get(c.normal as usize);
            own.copied().filter(|n| n.norm_squared() > 0.0).unwrap_or(*face_normal)
        };
        let colour = |c: &Corner, k: usize| {
            statements.colours.get(c.position as usize).map_or(1.0, |rgb| rgb[k].clamp(0.0, 1.0))
        };
        let mut names: Vec<String> = Vec::new();
        let group_words = label.group.iter().flat_map(|group| group.split(' ').map(str::to_owned));
        let given = label.group.iter().chain(&label.object).chain(&label.material).cloned();
        for name in given.chain(group_words) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let name = label.group.as_ref().or(label.object.as_ref());
        if name.is_none() {
            names.push(UNNAMED.to_owned());
        }
        let piece = SourcePiece {
            name: name.map_or(UNNAMED, String::as_str).to_owned(),
            material: label.material.clone(),
            mesh: 0,
            primitive: number,
            node: None,
            positions: self.corners.iter().map(position).collect(),
            normals: has_normals.then(|| self.corners.iter().zip(&self.face_normals).map(normal).collect()),
            uvs: has_uvs.then(|| self.corners.iter().map(uv).collect()),
            mask: mask.map(|k| self.corners.iter().map(|c| colour(c, k)).collect()),
            triangles: self.triangles,
            placement: Placement::Rigid(*to_scene),
            worn: true,
        };
        NamedPiece { piece, names }
    }
}
