//! Worn pieces as a viewer shows them: frames of their vertices before and after wear, with the tangents that a file lacks.

use crate::gltf::accessor::Accessors;
use crate::gltf::append::{Appender, Purpose};
use crate::gltf::detail::input::DetailInput;
use crate::gltf::detail::references::{index_of, variant_mappings};
use crate::gltf::detail::tangents::{Tangent, compute_tangents};
use crate::gltf::detail::texels::DetailOf;
use crate::gltf::read_worn::{column, worn_target, worn_target_index};
use crate::gltf::worn_target::LinearParts;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Error, Result};
use crease_model::garment::{GltfDocument, Placement, SourceAsset, SourcePiece};
use serde_json::{Value, json};

/// Tangent frame of a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Unit normal.
    pub(super) normal: Vec3,
    pub(super) tangent: Tangent,
}

/// Tangents before and after wear, one per vertex.
pub(super) struct AddedTangents {
    pub(super) unworn: Vec<Tangent>,
    pub(super) worn: Vec<Tangent>,
}

/// Worn piece as a viewer shows it.
pub(super) struct ShownSurface<'a> {
    pub(super) piece: &'a SourcePiece,
    /// Materials that draw it, each once: its own first, then those of `KHR_materials_variants`.
    pub(super) materials: Vec<Option<usize>>,
    pub(super) uvs: &'a [Vec2],
    /// Per vertex: its point.
    pub(super) points: &'a [PointIndex],
    /// Per vertex, scene: unit normal before wear.
    pub(super) unworn: Vec<Vec3>,
    /// Per vertex, scene: frame on the mesh that has the map, with the worn target applied or without.
    pub(super) worn: Vec<Frame>,
    /// Tangents that the file lacks, own coordinates.
    pub(super) added: Option<AddedTangents>,
    /// Index of the worn target among those of the primitive.
    target: usize,
}

/// Returns the worn pieces that can have a map; notes go to `notes`.
pub(super) fn surfaces<'a>(
    worn: &'a SourceAsset,
    document: &GltfDocument,
    detail: &'a DetailInput,
    of: DetailOf,
    notes: &mut Vec<String>,
) -> Result<Vec<ShownSurface<'a>>> {
    let mut surfaces = Vec::new();
    let mut rest = &detail.coarse.source_point[..];
    for piece in worn.worn_pieces() {
        let (points, after) = rest.split_at(piece.positions.len());
        rest = after;
        let (Some(uvs), Some(normals)) = (&piece.uvs, &piece.normals) else {
            let (lacks, cure) = match piece.uvs {
                None => ("texture coordinates", "unwrap the garment"),
                Some(_) => ("normals", "export it with its normals"),
            };
            notes.push(format!("{} has no {lacks} and gets no map: {cure}", piece.name));
            continue;
        };
        surfaces.push(ShownSurface::new(&worn.file, document, of, piece, points, (uvs, normals))?);
    }
    Ok(surfaces)
}

impl<'a> ShownSurface<'a> {
    fn new(
        file: &str,
        document: &GltfDocument,
        of: DetailOf,
        piece: &'a SourcePiece,
        points: &'a [PointIndex],
        (uvs, normals): (&'a [Vec2], &[Vec3]),
    ) -> Result<Self> {
        let count = piece.positions.len();
        let primitive = &document.json["meshes"][piece.mesh]["primitives"][piece.primitive];
        let target = worn_target(document, piece).filter(|_| of == DetailOf::Rest).unwrap_or(&Value::Null);
        let displacement = |name: &str| -> Result<Vec<Vec3>> {
            let numbers = column(document, &target[name], 3, count, name)?;
            let rows = numbers.unwrap_or_else(|| vec![0.0; 3 * count]);
            Ok(rows.chunks_exact(3).map(Vec3::from_row_slice).collect())
        };
        let moved = |rows: &[Vec3], shifts: &[Vec3]| -> Vec<Vec3> {
            rows.iter().zip(shifts).map(|(x, d)| x + d).collect()
        };
        let positions = moved(&piece.positions, &displacement("POSITION")?);
        let worn_normals: Vec<Vec3> = moved(normals, &displacement("NORMAL")?)
            .into_iter()
            .zip(normals)
            .map(|(n, own)| unit_or(n, *own))
            .collect();
        let stored = primitive["attributes"]["TANGENT"].as_u64().and_then(|i| usize::try_from(i).ok());
        let (own, added) = match stored {
            Some(accessor) => {
                let table = Accessors::new(document).table_of(accessor, 4, Some(count), "TANGENT")?;
                let stored = table.rows().zip(displacement("TANGENT")?).map(|(row, d)| Tangent {
                    direction: unit_or(Vec3::new(row[0], row[1], row[2]) + d, Vec3::x()),
                    handedness: if row[3] < 0.0 { -1.0 } else { 1.0 },
                });
                (stored.collect::<Vec<_>>(), None)
            }
            None => {
                let triangles = piece.file_triangles();
                let unworn = compute_tangents(&piece.positions, normals, uvs, &triangles);
                let mut worn = compute_tangents(&positions, &worn_normals, uvs, &triangles);
                // A morph target does not change the handedness.
                worn.iter_mut().zip(&unworn).for_each(|(a, b)| a.handedness = b.handedness);
                (worn.clone(), Some(AddedTangents { unworn, worn }))
            }
        };
        let placements = match &piece.placement {
            Placement::Rigid(one) => std::slice::from_ref(one),
            Placement::Skinned(all) => &all[..],
        };
        let linear = LinearParts::new(placements).map_err(|v| {
            Error::input(file, &piece.name, format!("vertex {v} is flattened"), "give it a scale")
        })?;
        let in_scene = |v: usize, n: &Vec3| unit_or(linear.at(v).inverse.transpose() * n, Vec3::z());
        let frame = |v: usize| {
            let direction = unit_or(linear.at(v).forward * own[v].direction, Vec3::x());
            let tangent = Tangent { direction, ..own[v] };
            Frame { normal: in_scene(v, &worn_normals[v]), tangent }
        };
        Ok(Self {
            piece,
            materials: materials_of(primitive),
            uvs,
            points,
            unworn: normals.iter().enumerate().map(|(v, n)| in_scene(v, n)).collect(),
            worn: (0..count).map(frame).collect(),
            added,
            target: worn_target_index(document, piece).unwrap_or(0),
        })
    }

    /// Adds tangents to the document where it has none.
    pub(super) fn add_tangents(&self, appender: &mut Appender) {
        let Some(AddedTangents { unworn, worn }) = &self.added else { return };
        let narrow = |v: &Vec3| [v.x as f32, v.y as f32, v.z as f32];
        let rows: Vec<[f32; 4]> = unworn
            .iter()
            .map(|t| {
                let [x, y, z] = narrow(&t.direction);
                [x, y, z, t.handedness as f32]
            })
            .collect();
        let shifts: Vec<[f32; 3]> =
            unworn.iter().zip(worn).map(|(b, a)| narrow(&(a.direction - b.direction))).collect();
        let (base, shift) =
            (appender.vectors(&rows, Purpose::Vertex), appender.vectors(&shifts, Purpose::Vertex));
        let Some(mesh) = appender.list("meshes").get_mut(self.piece.mesh) else { return };
        let primitive = &mut mesh["primitives"][self.piece.primitive];
        primitive["attributes"]["TANGENT"] = json!(base);
        primitive["targets"][self.target]["TANGENT"] = json!(shift);
    }
}

/// Returns the materials that draw a primitive, each once: its own, then those of its variants.
fn materials_of(primitive: &Value) -> Vec<Option<usize>> {
    let mut all = vec![index_of(&primitive["material"])];
    for mapping in variant_mappings(primitive) {
        let mapped = index_of(&mapping["material"]);
        if mapped.is_some() && !all.contains(&mapped) {
            all.push(mapped);
        }
    }
    all
}

pub(super) fn unit_or(v: Vec3, otherwise: Vec3) -> Vec3 {
    v.try_normalize(1e-12).unwrap_or(otherwise)
}
