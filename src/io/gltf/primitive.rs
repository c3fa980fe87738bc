//! Reads the data of one primitive: positions, normals, texture coordinates, mask, and its triangles, however they are
//! listed. The caller places it in the scene.

use crate::gltf::accessor::Accessors;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::morph::add_targets;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::error::Result;

/// Content of a primitive.
pub(super) enum PrimitiveData {
    /// Triangles.
    Mesh(MeshData),
    /// Points or lines, which garments do not have; with their name.
    Skipped(&'static str),
}

/// Triangles and vertices of a primitive.
pub(super) struct MeshData {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Option<Vec<Vec3>>,
    pub(super) uvs: Option<Vec<Vec2>>,
    /// Masks of memory and of sewing.
    pub(super) masks: [Option<Vec<f64>>; 2],
    pub(super) triangles: Vec<[u32; 3]>,
    /// Number of corners after the last whole triangle of a list.
    pub(super) leftover_corners: usize,
    /// Number of normals and texture coordinates that were not numbers.
    pub(super) replaced_count: usize,
}

/// Attribute and component of a mask.
#[derive(Clone)]
pub(super) struct MaskChannel {
    pub(super) attribute: String,
    pub(super) component: usize,
}

impl MaskChannel {
    /// Parses a name such as "COLOR_0.g", the second component of COLOR_0.
    pub(super) fn parse(wanted: &str) -> Self {
        let split = wanted.rsplit_once('.').and_then(|(attribute, component)| {
            let component = match component {
                "r" | "x" => 0,
                "g" | "y" => 1,
                "b" | "z" => 2,
                "a" | "w" => 3,
                _ => return None,
            };
            Some(Self { attribute: attribute.to_owned(), component })
        });
        split.unwrap_or_else(|| Self { attribute: wanted.to_owned(), component: 0 })
    }
}

/// Reads `primitive`, with its morph targets by their default `weights`.
pub(super) fn read_primitive(
    accessors: &Accessors,
    primitive: &Cursor,
    masks: &[Option<MaskChannel>; 2],
    weights: &[f64],
) -> Result<PrimitiveData> {
    let mode = primitive.index("mode")?.unwrap_or(4);
    match mode {
        0 => return Ok(PrimitiveData::Skipped("points")),
        1..=3 => return Ok(PrimitiveData::Skipped("lines")),
        4..=6 => {}
        other => return Err(primitive.error(format!("mode {other} is unknown"))),
    }
    let attributes = primitive.member("attributes");
    let Some(position) = attributes.index("POSITION")? else {
        return Ok(PrimitiveData::Skipped("a primitive without positions"));
    };
    let user = primitive.path();
    let table = accessors.table_of(position, 3, None, user)?;
    let mut positions: Vec<Vec3> = table.rows().map(Vec3::from_column_slice).collect();
    add_targets(accessors, primitive, weights, "POSITION", &mut positions)?;
    if let Some(vertex) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(primitive.error(format!("the position of vertex {vertex} is not a finite number")));
    }
    let count = positions.len();
    let mut replaced_count = 0;
    let normals = match attributes.index("NORMAL")? {
        Some(index) => {
            let table = accessors.table_of(index, 3, Some(count), user)?;
            let mut normals: Vec<Vec3> = table.rows().map(Vec3::from_column_slice).collect();
            add_targets(accessors, primitive, weights, "NORMAL", &mut normals)?;
            Some(normals.into_iter().map(|normal| unit_normal(normal, &mut replaced_count)).collect())
        }
        None => None,
    };
    let uvs = match attributes.index("TEXCOORD_0")? {
        Some(index) => {
            let table = accessors.table_of(index, 2, Some(count), user)?;
            Some(table.rows().map(|row| finite_uv(row, &mut replaced_count)).collect())
        }
        None => None,
    };
    let read = |mask: &Option<MaskChannel>| read_mask(accessors, &attributes, mask.as_ref(), count);
    let masks = [read(&masks[0])?, read(&masks[1])?];
    let corners = match primitive.index("indices")? {
        Some(index) => accessors.indices(index, user)?,
        None => (0..count as u32).collect(),
    };
    if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= count) {
        return Err(primitive.error(format!("a triangle uses vertex {corner}, there are {count}")));
    }
    let (triangles, leftover_corners) = assemble(mode, &corners);
    Ok(PrimitiveData::Mesh(MeshData {
        positions,
        normals,
        uvs,
        masks,
        triangles,
        leftover_corners,
        replaced_count,
    }))
}

fn unit_normal(normal: Vec3, replaced_count: &mut usize) -> Vec3 {
    let unit = normal.iter().all(|x| x.is_finite()).then(|| normal.try_normalize(0.0)).flatten();
    unit.unwrap_or_else(|| {
        *replaced_count += 1;
        Vec3::y()
    })
}

fn finite_uv(row: &[f64], replaced_count: &mut usize) -> Vec2 {
    let uv = Vec2::from_column_slice(row);
    if uv.iter().all(|x| x.is_finite()) {
        return uv;
    }
    *replaced_count += 1;
    Vec2::zeros()
}

fn read_mask(
    accessors: &Accessors,
    attributes: &Cursor,
    mask: Option<&MaskChannel>,
    count: usize,
) -> Result<Option<Vec<f64>>> {
    let Some(mask) = mask else { return Ok(None) };
    let Some(index) = attributes.index(&mask.attribute)? else { return Ok(None) };
    let table = accessors.table(index, attributes.path())?;
    if table.row_count() != count || mask.component >= table.width {
        return Err(attributes.error(format!(
            "{} has {} rows of {}; the mask needs {count} rows and component {}",
            mask.attribute,
            table.row_count(),
            table.width,
            mask.component
        )));
    }
    let value = |row: &[f64]| row.get(mask.component).copied().unwrap_or(1.0);
    Ok(Some(table.rows().map(value).collect()))
}

/// Converts a triangle list (4), strip (5) or fan (6) to consistently oriented triangles; also returns the number of
/// leftover corners.
fn assemble(mode: usize, corners: &[u32]) -> (Vec<[u32; 3]>, usize) {
    if mode == 4 {
        let (triples, rest) = corners.as_chunks::<3>();
        return (triples.to_vec(), rest.len());
    }
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(corners.len());
    for (k, pair) in corners.windows(3).enumerate() {
        let &[a, b, c] = pair else { continue };
        triangles.push(match (mode, corners.first()) {
            (6, Some(&hub)) => [b, c, hub],
            // Every other triangle of a strip is listed in reverse.
            _ if k % 2 == 1 => [b, a, c],
            _ => [a, b, c],
        });
    }
    // Strips jump by repeated corners; those are no triangles.
    triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    (triangles, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the specification's figure of strips and fans.
    #[test]
    fn strips_and_fans_are_oriented_like_their_first_triangle() {
        assert_eq!(assemble(5, &[0, 1, 2, 3, 4]).0, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(assemble(6, &[0, 1, 2, 3]).0, [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(assemble(5, &[0, 1, 2, 2, 4, 4, 5, 6]).0, [[0, 1, 2], [5, 4, 6]]);
        assert_eq!(assemble(4, &[0, 1, 2, 3]), (vec![[0, 1, 2]], 1));
    }
}
