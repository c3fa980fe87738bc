//! Values on the points, faces or corners of a mesh (`UsdGeomPrimvar`): texture coordinates, normals, masks.

use crate::usd::reader::stage::{Fault, Prim, UsdValue};
use rustc_hash::FxHashMap;

/// Namespace of primvars.
pub(super) const NAMESPACE: &str = "primvars:";
/// Name of the texture coordinates that USD recommends.
const TEXTURE_COORDINATES: &str = "primvars:st";
/// Beginning of the types of texture coordinates: of floats, doubles and halves.
const TEXTURE_TYPE: &str = "texCoord2";

/// Elements of a mesh that values belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// One value for all.
    Constant,
    /// One per face.
    Uniform,
    /// One per point.
    Vertex,
    /// One per corner of a face.
    FaceVarying,
}

/// Corner of a mesh by its numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub(super) face: usize,
    pub(super) point: usize,
    pub(super) corner: usize,
}

/// Values of a mesh.
#[derive(Debug, Clone)]
pub(super) struct Primvar {
    interpolation: Interpolation,
    /// Components of a value.
    pub(super) width: usize,
    /// Different values one after the other.
    pub(super) values: Vec<f64>,
    /// Per element: number of its value.
    numbers: Vec<u32>,
}

impl Primvar {
    /// Reads the values of the attribute `name` of a mesh with these counts of faces, points and corners. `otherwise` is the
    /// interpolation where none is given.
    ///
    /// # Errors
    /// Values that do not fit the mesh.
    pub(super) fn read(
        prim: &Prim,
        name: &str,
        counts: Element,
        otherwise: Interpolation,
    ) -> Result<Option<Self>, Fault> {
        let Some(sampled) = prim.value(name)? else { return Ok(None) };
        let (width, values) = match sampled.value {
            UsdValue::Rows(width, values) => (width, values),
            UsdValue::Numbers(values) => (1, values),
            UsdValue::Integers(values) => (1, values.into_iter().map(|x| x as f64).collect()),
            UsdValue::Number(value) => (1, vec![value]),
            UsdValue::Components(values) => (values.len().max(1), values),
            _ => return Err("is no list of numbers".to_owned()),
        };
        let interpolation = match prim.attribute_token(name, "interpolation")?.as_deref() {
            Some("constant") => Interpolation::Constant,
            Some("uniform") => Interpolation::Uniform,
            Some("vertex" | "varying") => Interpolation::Vertex,
            Some("faceVarying") => Interpolation::FaceVarying,
            Some(other) => return Err(format!("has the interpolation \"{other}\", which is not known")),
            None => otherwise,
        };
        let (kept, number_of_row) = distinct_rows(&values, width);
        let row_count = number_of_row.len();
        let numbers = match prim.value(&format!("{name}:indices"))?.map(|sampled| sampled.value) {
            Some(UsdValue::Integers(rows)) => rows
                .iter()
                .map(|row| usize::try_from(*row).ok().and_then(|row| number_of_row.get(row)).copied())
                .collect::<Option<Vec<u32>>>()
                .ok_or_else(|| format!("has an index beyond its {row_count} values"))?,
            _ => number_of_row,
        };
        let needed = match interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => counts.face,
            Interpolation::Vertex => counts.point,
            Interpolation::FaceVarying => counts.corner,
        };
        if numbers.len() < needed {
            return Err(format!("has {} values where {needed} are needed", numbers.len()));
        }
        Ok(Some(Self { interpolation, width, values: kept, numbers }))
    }

    /// Returns the number of the value of a corner.
    pub(super) fn number(&self, element: Element) -> Option<u32> {
        let at = match self.interpolation {
            Interpolation::Constant => 0,
            Interpolation::Uniform => element.face,
            Interpolation::Vertex => element.point,
            Interpolation::FaceVarying => element.corner,
        };
        self.numbers.get(at).copied()
    }

    /// Returns the different values.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks(self.width)
    }
}

/// Returns the name of the texture coordinates of a mesh: `st`, else the first primvar of their type.
pub(super) fn texture_coordinates_of(prim: &Prim, properties: &[String]) -> Result<Option<String>, Fault> {
    if properties.iter().any(|name| name == TEXTURE_COORDINATES) {
        return Ok(Some(TEXTURE_COORDINATES.to_owned()));
    }
    for name in properties.iter().filter(|name| name.starts_with(NAMESPACE) && !name.ends_with(":indices")) {
        if prim.attribute_type(name)?.starts_with(TEXTURE_TYPE) {
            return Ok(Some(name.clone()));
        }
    }
    Ok(None)
}

/// Returns the different rows of `values`, and per row the number of its equal among them.
fn distinct_rows(values: &[f64], width: usize) -> (Vec<f64>, Vec<u32>) {
    let mut known: FxHashMap<[u64; 4], u32> = FxHashMap::default();
    let (mut kept, mut numbers) = (Vec::new(), Vec::with_capacity(values.len() / width));
    for row in values.chunks_exact(width) {
        let mut key = [0; 4];
        // Rows wider than the key are all kept.
        if width <= key.len() {
            key.iter_mut().zip(row).for_each(|(slot, x)| *slot = (x + 0.0).to_bits());
        } else {
            key[0] = numbers.len() as u64;
        }
        let next = (kept.len() / width) as u32;
        let number = *known.entry(key).or_insert(next);
        if number == next {
            kept.extend(row);
        }
        numbers.push(number);
    }
    (kept, numbers)
}
