//! Makes the worn shape of a GLB file its base shape, for programs that do not read default morph weights.
//!
//! In every mesh with a morph target `worn`, positions, normals and tangents get the numbers that a viewer computes at
//! weight 1: base plus target, directions normalised. The target becomes `unworn` at weight 0, which leads back to the
//! source shape, or is removed. Animated weights w of the target become 1 - w, so that a clip shows what it showed. Skins,
//! clips, materials and every other target stay; a normal map of the worn shape then belongs to the base shape.
//! A primitive without normals gets smooth ones: without, viewers shade every triangle flat.
//!
//! Numbers go where the old ones were, if nothing else uses them, so that the file does not grow.

use crate::error_list::ErrorList;
use crate::gltf::accessor::Accessors;
use crate::gltf::animated_weights::{WeightEdit, edit_animations};
use crate::gltf::append::{Appender, Purpose};
use crate::gltf::buffers::{load_buffers, used_buffers};
use crate::gltf::container::{other_chunks, split_glb};
use crate::gltf::flat_shading::SmoothShape;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::names::{APPLIED_KEY, EXTRAS_KEY, UNWORN_TARGET, WORN_TARGET};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::GltfDocument;
use rustc_hash::FxHashMap;
use serde_json::{Map, Value, json};

/// What becomes of the source shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SourceShape {
    /// It is kept as morph target `unworn` at weight 0.
    #[default]
    Target,
    /// It is dropped.
    Dropped,
}

/// Writes the worn shape of the file `glb` as its base shape. `file` names it in diagnostics.
pub fn apply_worn(file: &str, glb: &[u8], source: SourceShape) -> Result<Vec<u8>> {
    let document = read_document(file, glb)?;
    let mut appender = Appender::from_document(file, &document)?;
    let meshes: Vec<(usize, usize)> = document.json["meshes"]
        .as_array()
        .into_iter()
        .flatten()
        .enumerate()
        .filter_map(|(m, mesh)| Some((m, worn_index(mesh)?)))
        .collect();
    if meshes.is_empty() {
        let message = "has no morph target `worn`";
        let help = Message::from("give the OUT.glb of a bake without ") + Setting::Apply;
        return Err(Error::input(file, "meshes", message, help));
    }
    let uses = accessor_uses(&document.json);
    for (m, target) in meshes {
        let Some(Value::Object(mut mesh)) = appender.list("meshes").get(m).cloned() else { continue };
        let target_count = target_count(&mesh);
        for primitive in mesh.get_mut("primitives").and_then(Value::as_array_mut).into_iter().flatten() {
            let edit = PrimitiveEdit { document: &document, uses: &uses, mesh: m, target, source };
            edit.apply(&mut appender, primitive)?;
        }
        edit_names(&mut mesh, target, source);
        let nodes = nodes_of(&document.json, m);
        edit_weights(mesh.get_mut("weights"), target, source);
        for &node in &nodes {
            edit_weights(
                appender.list("nodes").get_mut(node).and_then(|n| n.get_mut("weights")),
                target,
                source,
            );
        }
        if target_count == 1 && source == SourceShape::Dropped {
            mesh.shift_remove("weights");
            for &node in &nodes {
                let node = appender.list("nodes").get_mut(node).and_then(Value::as_object_mut);
                node.into_iter().for_each(|node| drop(node.shift_remove("weights")));
            }
        }
        appender.list("meshes")[m] = Value::Object(mesh);
        let edit = match source {
            SourceShape::Target => WeightEdit::Invert { target },
            SourceShape::Dropped => WeightEdit::Remove { target },
        };
        edit_animations(&mut appender, &document, &nodes, Some(m), target_count, edit)?;
    }
    Ok(appender.into_glb())
}

fn read_document(file: &str, glb: &[u8]) -> Result<GltfDocument> {
    let (json, binary) = split_glb(glb)?;
    let mut errors = ErrorList::new(file);
    let buffers = load_buffers(
        &Cursor::root(&json),
        binary,
        &used_buffers(&json),
        &mut |name, _| Err(Error::input(file, name, "is another file", "write the mesh as .glb")),
        &mut errors,
    );
    errors.finish()?;
    Ok(GltfDocument { json, buffers, chunks: other_chunks(glb) })
}

/// Returns the index of the worn target of a mesh.
fn worn_index(mesh: &Value) -> Option<usize> {
    let index = mesh["extras"]["targetNames"].as_array()?.iter().rposition(|name| name == WORN_TARGET)?;
    mesh["primitives"].as_array()?.iter().all(|p| p["targets"].get(index).is_some()).then_some(index)
}

fn target_count(mesh: &Map<String, Value>) -> usize {
    let primitives = mesh.get("primitives").and_then(Value::as_array).into_iter().flatten();
    primitives.filter_map(|p| p["targets"].as_array()).map(Vec::len).max().unwrap_or(0)
}

fn nodes_of(json: &Value, mesh: usize) -> Vec<usize> {
    let nodes = json["nodes"].as_array().into_iter().flatten().enumerate();
    nodes.filter(|(_, node)| node["mesh"].as_u64() == Some(mesh as u64)).map(|(i, _)| i).collect()
}

/// Returns how often each accessor is named anywhere in the document under a key or list entry of primitives.
fn accessor_uses(json: &Value) -> FxHashMap<u64, u32> {
    let mut uses = FxHashMap::default();
    let mut count = |value: &Value| {
        if let Some(index) = value.as_u64() {
            *uses.entry(index).or_insert(0) += 1;
        }
    };
    for primitive in
        json["meshes"].as_array().into_iter().flatten().flat_map(|m| m["primitives"].as_array()).flatten()
    {
        let targets = primitive["targets"].as_array().into_iter().flatten();
        for list in std::iter::once(&primitive["attributes"]).chain(targets) {
            list.as_object().into_iter().flat_map(Map::values).for_each(&mut count);
        }
        count(&primitive["indices"]);
    }
    uses
}

/// Renames the worn target, or removes it, and marks the mesh as applied.
fn edit_names(mesh: &mut Map<String, Value>, target: usize, source: SourceShape) {
    let Some(extras) = mesh.get_mut("extras").and_then(Value::as_object_mut) else { return };
    if let Some(names) = extras.get_mut("targetNames").and_then(Value::as_array_mut) {
        match source {
            SourceShape::Target => names[target] = json!(UNWORN_TARGET),
            SourceShape::Dropped => drop(names.remove(target)),
        }
    }
    if extras.get("targetNames").and_then(Value::as_array).is_some_and(Vec::is_empty) {
        extras.shift_remove("targetNames");
    }
    let own = extras.entry(EXTRAS_KEY).or_insert_with(|| json!({}));
    if let Some(own) = own.as_object_mut() {
        own.insert(APPLIED_KEY.into(), json!(true));
    }
}

fn edit_weights(weights: Option<&mut Value>, target: usize, source: SourceShape) {
    let Some(weights) = weights.and_then(Value::as_array_mut) else { return };
    match (weights.get_mut(target), source) {
        (Some(weight), SourceShape::Target) => {
            *weight = json!(1.0 - weight.as_f64().unwrap_or(1.0));
        }
        (Some(_), SourceShape::Dropped) => drop(weights.remove(target)),
        (None, _) => {}
    }
}

/// Edit of one primitive.
struct PrimitiveEdit<'a> {
    document: &'a GltfDocument,
    uses: &'a FxHashMap<u64, u32>,
    mesh: usize,
    target: usize,
    source: SourceShape,
}

impl PrimitiveEdit<'_> {
    fn apply(&self, appender: &mut Appender, primitive: &mut Value) -> Result<()> {
        let old = primitive["targets"][self.target].clone();
        let mut unworn = Map::new();
        if !is_zero(&self.document.json, &old) {
            let added = self.smooth_normals(primitive, &old)?;
            for name in ["POSITION", "NORMAL", "TANGENT"] {
                self.move_attribute(appender, primitive, &old, name, &mut unworn)?;
            }
            if let Some((normals, shifts)) = added {
                primitive["attributes"]["NORMAL"] = json!(appender.vectors(&normals, Purpose::Vertex));
                unworn.insert("NORMAL".into(), json!(appender.vectors(&shifts, Purpose::Vertex)));
            }
        } else if let Value::Object(zero) = old {
            unworn = zero;
        }
        let Some(targets) = primitive["targets"].as_array_mut() else { return Ok(()) };
        match self.source {
            SourceShape::Target => targets[self.target] = Value::Object(unworn),
            SourceShape::Dropped => drop(targets.remove(self.target)),
        }
        if targets.is_empty()
            && let Some(primitive) = primitive.as_object_mut()
        {
            primitive.shift_remove("targets");
        }
        Ok(())
    }

    fn location(&self) -> String {
        format!("meshes[{}]", self.mesh)
    }

    /// Writes base plus target as the attribute `name`, and base minus that to `unworn`.
    fn move_attribute(
        &self,
        appender: &mut Appender,
        primitive: &mut Value,
        target: &Value,
        name: &str,
        unworn: &mut Map<String, Value>,
    ) -> Result<()> {
        let (Some(base), Some(shift)) = (primitive["attributes"][name].as_u64(), target[name].as_u64())
        else {
            return Ok(());
        };
        let accessors = Accessors::new(self.document);
        let width = if name == "TANGENT" { 4 } else { 3 };
        let own = accessors.table_of(base as usize, width, None, &self.location())?;
        let moved = accessors.table_of(shift as usize, 3, Some(own.row_count()), &self.location())?;
        let purpose = if name == "POSITION" { Purpose::Position } else { Purpose::Vertex };
        let (mut rows, mut shifts) = (Vec::new(), Vec::new());
        for (row, d) in own.rows().zip(moved.rows()) {
            let source = Vec3::from_column_slice(&row[..3]);
            let sum = source + Vec3::from_column_slice(d);
            let new = if name == "POSITION" { sum } else { sum.try_normalize(1e-12).unwrap_or(source) };
            let narrow = [new.x as f32, new.y as f32, new.z as f32, row.get(3).map_or(0.0, |&w| w as f32)];
            rows.push(narrow);
            shifts
                .push(std::array::from_fn::<f32, 3, _>(|k| (source[k] - f64::from(narrow[k])) as f32 + 0.0));
        }
        let rows_of_three: Vec<[f32; 3]> = rows.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        let is_own = |accessor: u64| self.uses.get(&accessor) == Some(&1);
        let new = match width {
            4 => appender.replace_vectors(base as usize, &rows, purpose, is_own(base)),
            _ => appender.replace_vectors(base as usize, &rows_of_three, purpose, is_own(base)),
        };
        primitive["attributes"][name] = json!(new);
        if self.source == SourceShape::Target {
            let new = appender.replace_vectors(shift as usize, &shifts, purpose, is_own(shift));
            unworn.insert(name.to_owned(), json!(new));
        }
        Ok(())
    }

    /// Returns smooth worn normals for a primitive without normals, and what leads from them to those of the source shape.
    #[allow(clippy::type_complexity, reason = "two lists of rows")]
    fn smooth_normals(
        &self,
        primitive: &Value,
        target: &Value,
    ) -> Result<Option<(Vec<[f32; 3]>, Vec<[f32; 3]>)>> {
        let mode = primitive["mode"].as_u64().unwrap_or(4);
        let (Some(base), Some(shift)) =
            (primitive["attributes"]["POSITION"].as_u64(), target["POSITION"].as_u64())
        else {
            return Ok(None);
        };
        if primitive["attributes"].get("NORMAL").is_some() || mode != 4 {
            return Ok(None);
        }
        let accessors = Accessors::new(self.document);
        let own = accessors.table_of(base as usize, 3, None, &self.location())?;
        let moved = accessors.table_of(shift as usize, 3, Some(own.row_count()), &self.location())?;
        let corners = match primitive["indices"].as_u64() {
            Some(index) => accessors.indices(index as usize, &self.location())?,
            None => (0..own.row_count() as u32).collect(),
        };
        let normals = smooth_normals(&own.values, &moved.values, &corners);
        let narrow = |v: Vec3| [v.x as f32, v.y as f32, v.z as f32];
        let rows = normals.iter().map(|[_, after]| narrow(*after)).collect();
        let shifts = normals.iter().map(|[before, after]| narrow(before - after)).collect();
        Ok(Some((rows, shifts)))
    }
}

/// Returns per vertex the smooth normals before and after; those of vertices at one position are equal.
fn smooth_normals(base: &[f64], shift: &[f64], corners: &[u32]) -> Vec<[Vec3; 2]> {
    let vertices: Vec<Vec3> = base.chunks_exact(3).map(Vec3::from_column_slice).collect();
    let mut points = Vec::new();
    let mut after = Vec::new();
    let mut known = FxHashMap::default();
    let mut point_of = Vec::with_capacity(vertices.len());
    for (x, d) in vertices.iter().zip(shift.chunks_exact(3)) {
        let key = [x.x, x.y, x.z].map(|c| (c + 0.0).to_bits());
        point_of.push(*known.entry(key).or_insert_with(|| {
            points.push(*x);
            after.push(x + Vec3::from_column_slice(d));
            PointIndex(points.len() as u32 - 1)
        }));
    }
    let own: Vec<[usize; 3]> = corners
        .as_chunks::<3>()
        .0
        .iter()
        .map(|t| t.map(|v| v as usize))
        .filter(|t| t.iter().all(|&v| v < vertices.len()))
        .collect();
    let triangles: Vec<[PointIndex; 3]> = own.iter().map(|t| t.map(|v| point_of[v])).collect();
    let [source, worn] = [&points, &after].map(|x| SmoothShape::new(&points, x, &triangles));
    let mut alone = vec![Vec3::zeros(); vertices.len()];
    for t in &own {
        let area = crease_geometry::mesh::triangle::area_vector(&t.map(|v| vertices[v]));
        t.iter().for_each(|&v| alone[v] += area);
    }
    let pair = |(v, alone): (usize, &Vec3)| {
        let before = alone.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::y);
        [&source, &worn].map(|shape| shape.normal(point_of[v], before).unwrap_or(before))
    };
    alone.iter().enumerate().map(pair).collect()
}

/// Whether a target moves nothing: its positions refer to the shared zeros of an unworn primitive.
fn is_zero(json: &Value, target: &Value) -> bool {
    let accessor = target["POSITION"].as_u64().map(|i| &json["accessors"][i as usize]);
    accessor.is_none_or(|a| a.get("bufferView").is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_at_one_position_share_smooth_normals() {
        // Two triangles of a flat square with vertices of their own, folded along the diagonal.
        let base = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 0., 0., 1., 1., 0., 0., 1., 0.];
        let mut shift = [0.0; 18];
        shift[17] = 1.0;
        let normals = smooth_normals(&base, &shift, &[0, 1, 2, 3, 4, 5]);
        assert_eq!(normals[0], normals[3]);
        assert!((normals[0][0] - Vec3::z()).norm() < 1e-12);
        assert!(normals[0][1].z < 0.95 && (normals[1][1] - Vec3::z()).norm() < 1e-12);
    }
}
