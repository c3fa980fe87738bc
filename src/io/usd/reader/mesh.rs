//! Points, faces, texture coordinates and normals of a mesh prim (`UsdGeomMesh`), with every index checked.

use crate::corners::Corner;
use crate::tuning::TUNING;
use crate::usd::reader::primvar::{Element, Interpolation, NAMESPACE, Primvar, texture_coordinates_of};
use crate::usd::reader::stage::{Fault, Prim, UsdValue};
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::INVALID;
use crease_model::garment::Severity;
use std::ops::Range;

/// Mesh of a prim.
#[derive(Debug, Default)]
pub(super) struct MeshData {
    /// Per point: position in the prim's own coordinates.
    pub(super) positions: Vec<Vec3>,
    /// Different texture coordinates, v growing downward.
    pub(super) uvs: Vec<Vec2>,
    /// Different normals, of unit length.
    pub(super) normals: Vec<Vec3>,
    /// Corners of all faces.
    pub(super) corners: Vec<Corner>,
    /// Per face of the file: its corners, counter-clockwise seen from outside; `None` for one that is left out.
    pub(super) faces: Vec<Option<Range<usize>>>,
    /// Per mask and point: the value of the first corner there; empty without one.
    pub(super) masks: [Vec<f64>; 2],
    /// Whether points or faces change over time.
    pub(super) is_animated: bool,
    /// What is worth knowing: severity and message.
    pub(super) notes: Vec<(Severity, String)>,
}

/// Fault of a mesh that cannot be read.
#[derive(Debug)]
pub(super) struct MeshFault {
    /// Attribute, with the index in it.
    pub(super) attribute: String,
    pub(super) message: String,
    pub(super) help: &'static str,
}

impl MeshFault {
    fn new(attribute: impl Into<String>, message: impl Into<String>, help: &'static str) -> Self {
        Self { attribute: attribute.into(), message: message.into(), help }
    }
}

/// Vertex attribute of a mask: the name of a primvar, and its component.
#[derive(Debug, Clone)]
pub(super) struct MaskName {
    pub(super) primvar: String,
    pub(super) component: usize,
}

impl MaskName {
    /// Parses `NAME`, `NAME.g` or `NAME.y`; `COLOR_0` is the colour of the prim.
    pub(super) fn parse(text: &str) -> Self {
        let component = |letter: &str| match letter {
            "r" | "x" => Some(0),
            "g" | "y" => Some(1),
            "b" | "z" => Some(2),
            "a" | "w" => Some(3),
            _ => None,
        };
        let split = text.rsplit_once('.').and_then(|(name, letter)| Some((name, component(letter)?)));
        let (name, component) = split.unwrap_or((text, 0));
        let name = if name == "COLOR_0" { "displayColor" } else { name };
        Self { primvar: format!("{NAMESPACE}{}", name.strip_prefix(NAMESPACE).unwrap_or(name)), component }
    }
}

const WRITE_AGAIN: &str = "write the mesh again";

/// Reads the mesh of `prim`, whose properties are called `properties`.
pub(super) fn read_mesh(
    prim: &Prim,
    properties: &[String],
    masks: &[Option<MaskName>; 2],
) -> Result<MeshData, MeshFault> {
    let mut mesh = MeshData::default();
    let value = |name: &str| {
        prim.value(name)
            .map_err(|fault| MeshFault::new(name, format!("cannot be read: {fault}"), WRITE_AGAIN))
    };
    let integers = |name: &str| match value(name)? {
        Some(sampled) => match sampled.value {
            UsdValue::Integers(all) => Ok((all, sampled.is_animated)),
            _ => Err(MeshFault::new(name, "are no integers", WRITE_AGAIN)),
        },
        None => Ok((Vec::new(), false)),
    };
    if let Some(sampled) = value("points")? {
        mesh.is_animated = sampled.is_animated;
        mesh.positions = match sampled.value {
            UsdValue::Rows(3, all) => all.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect(),
            _ => return Err(MeshFault::new("points", "are no list of points", WRITE_AGAIN)),
        };
    }
    let ((counts, counts_move), (indices, indices_move)) =
        (integers("faceVertexCounts")?, integers("faceVertexIndices")?);
    mesh.is_animated |= counts_move || indices_move;
    mesh.add_faces(&counts, &indices)?;
    mesh.check_positions()?;
    let counts = Element { face: mesh.faces.len(), point: mesh.positions.len(), corner: mesh.corners.len() };
    mesh.add_texture_coordinates(prim, properties, counts);
    mesh.add_normals(prim, properties, counts);
    for (k, mask) in masks.iter().enumerate() {
        if let Some(mask) = mask.as_ref().filter(|mask| properties.contains(&mask.primvar)) {
            mesh.add_mask(k, prim, mask, counts);
        }
    }
    let holes = integers("holeIndices")?.0;
    if !holes.is_empty() {
        mesh.note(Severity::Note, "faces are holes and left out (holeIndices)");
    }
    for face in holes {
        if let Some(face) = usize::try_from(face).ok().and_then(|face| mesh.faces.get_mut(face)) {
            *face = None;
        }
    }
    if let Some(UsdValue::Token(orientation)) = value("orientation")?.map(|sampled| sampled.value)
        && orientation == "leftHanded"
    {
        let MeshData { faces, corners, .. } = &mut mesh;
        faces.iter().flatten().for_each(|face| corners[face.clone()].reverse());
    }
    Ok(mesh)
}

impl MeshData {
    fn note(&mut self, severity: Severity, message: impl Into<String>) {
        self.notes.push((severity, message.into()));
    }

    fn add_faces(&mut self, counts: &[i64], indices: &[i64]) -> Result<(), MeshFault> {
        let fault =
            |k: usize, message: String, help| MeshFault::new(format!("faceVertexCounts[{k}]"), message, help);
        let mut start = 0usize;
        for (k, &count) in counts.iter().enumerate() {
            let count = usize::try_from(count)
                .map_err(|_| fault(k, format!("a face of {count} corners"), WRITE_AGAIN))?;
            if count > TUNING.max_face_corners {
                return Err(fault(k, format!("a face of {count} corners"), "cut it into smaller faces"));
            }
            let end = start.saturating_add(count);
            if count < 3 {
                self.note(Severity::Repaired, "faces of fewer than 3 corners dropped");
            }
            self.faces.push((count >= 3).then_some(start..end));
            start = end;
        }
        if start != indices.len() {
            let message =
                format!("has {} corners, and the faces of faceVertexCounts have {start}", indices.len());
            return Err(MeshFault::new("faceVertexIndices", message, WRITE_AGAIN));
        }
        let point_count = self.positions.len();
        for (k, &index) in indices.iter().enumerate() {
            let position = u32::try_from(index).ok().filter(|index| (*index as usize) < point_count);
            let position = position.ok_or_else(|| {
                let message = format!("{index} is out of range: the mesh has {point_count} points");
                MeshFault::new(format!("faceVertexIndices[{k}]"), message, WRITE_AGAIN)
            })?;
            self.corners.push(Corner { position, uv: INVALID, normal: INVALID });
        }
        Ok(())
    }

    /// Refuses points of faces that are not numbers or too large.
    fn check_positions(&self) -> Result<(), MeshFault> {
        let is_sound = |p: &Vec3| p.iter().all(|x| x.abs() <= TUNING.max_obj_coordinate);
        let bad = self.corners.iter().find(|corner| !is_sound(&self.positions[corner.position as usize]));
        bad.map_or(Ok(()), |corner| {
            let at = corner.position as usize;
            let p = &self.positions[at];
            let message = format!("({}, {}, {}) is not a position", p.x, p.y, p.z);
            Err(MeshFault::new(format!("points[{at}]"), message, "correct or remove this point"))
        })
    }

    /// Calls `set` with every corner, its number, its face and its value.
    fn for_each_value(&mut self, values: &Primvar, mut set: impl FnMut(&mut Corner, u32)) {
        let MeshData { faces, corners, .. } = self;
        for (face, range) in faces.iter().enumerate() {
            for corner in range.clone().unwrap_or_default() {
                let slot = &mut corners[corner];
                if let Some(number) = values.number(Element { face, point: slot.position as usize, corner }) {
                    set(slot, number);
                }
            }
        }
    }

    /// Returns the values of `name`; a note and none if they cannot be read.
    fn values(
        &mut self,
        prim: &Prim,
        name: &str,
        counts: Element,
        otherwise: Interpolation,
    ) -> Option<Primvar> {
        Primvar::read(prim, name, counts, otherwise).unwrap_or_else(|fault| {
            self.note(Severity::Warning, format!("{name} is left out: it {fault}"));
            None
        })
    }

    fn add_texture_coordinates(&mut self, prim: &Prim, properties: &[String], counts: Element) {
        let name = texture_coordinates_of(prim, properties);
        let Some(name) = name.unwrap_or_else(|fault: Fault| {
            self.note(Severity::Warning, format!("texture coordinates are left out: {fault}"));
            None
        }) else {
            return;
        };
        let Some(values) = self.values(prim, &name, counts, Interpolation::Constant) else { return };
        if values.width < 2 {
            self.note(Severity::Warning, format!("{name} is left out: it has one component"));
            return;
        }
        let is_sound = |row: &[f64]| row[0].is_finite() && row[1].is_finite();
        if !values.rows().all(is_sound) {
            self.note(Severity::Repaired, "texture coordinates that are not numbers replaced");
        }
        // USD counts v upward, glTF (and we) downward.
        let uv = |row: &[f64]| if is_sound(row) { Vec2::new(row[0], 1.0 - row[1]) } else { Vec2::zeros() };
        self.uvs = values.rows().map(uv).collect();
        self.for_each_value(&values, |corner, number| corner.uv = number);
    }

    fn add_normals(&mut self, prim: &Prim, properties: &[String], counts: Element) {
        let names = [("primvars:normals", Interpolation::Constant), ("normals", Interpolation::Vertex)];
        let Some((name, otherwise)) =
            names.into_iter().find(|(name, _)| properties.iter().any(|own| own == name))
        else {
            return;
        };
        let Some(values) = self.values(prim, name, counts, otherwise).filter(|values| values.width == 3)
        else {
            return;
        };
        let normal = |row: &[f64]| Vec3::new(row[0], row[1], row[2]).try_normalize(f64::MIN_POSITIVE);
        let normals: Vec<Option<Vec3>> =
            values.rows().map(|row| normal(row).filter(|n| n.iter().all(|x| x.is_finite()))).collect();
        self.for_each_value(&values, |corner, number| {
            let is_sound = normals.get(number as usize).is_some_and(Option::is_some);
            corner.normal = if is_sound { number } else { INVALID };
        });
        self.normals = normals.into_iter().map(|normal| normal.unwrap_or_else(Vec3::y)).collect();
    }

    fn add_mask(&mut self, k: usize, prim: &Prim, mask: &MaskName, counts: Element) {
        let Some(values) = self.values(prim, &mask.primvar, counts, Interpolation::Constant) else { return };
        if mask.component >= values.width {
            self.note(
                Severity::Warning,
                format!("{} is left out: it has {} components", mask.primvar, values.width),
            );
            return;
        }
        let mut of_point = vec![f64::NAN; self.positions.len()];
        self.for_each_value(&values, |corner, number| {
            let slot = &mut of_point[corner.position as usize];
            if slot.is_nan() {
                *slot = values.values[number as usize * values.width + mask.component];
            }
        });
        self.masks[k] = of_point.into_iter().map(|x| if x.is_nan() { 1.0 } else { x }).collect();
    }
}
