//! Pieces of a mesh prim: one for each material, as a `GeomSubset` of the family `materialBind` assigns them.

use crate::corners::CornerVertices;
use crate::pieces::NamedPiece;
use crate::polygon::Triangulator;
use crate::usd::reader::mesh::MeshData;
use crate::usd::reader::notes::Notes;
use crate::usd::reader::stage::{Fault, Prim, UsdValue};
use crease_geometry::math::Mat4;
use crease_geometry::mesh::INVALID;
use crease_model::garment::{Placement, Severity, SourcePiece};

/// Family of the subsets that have materials.
const MATERIAL_FAMILY: &str = "materialBind";

/// Mesh prim with what the prims above it give it.
pub(super) struct PlacedMesh<'a> {
    pub(super) prim: &'a Prim,
    pub(super) children: &'a [Prim],
    pub(super) data: MeshData,
    /// Transform to the scene.
    pub(super) to_scene: Mat4,
    /// Name of the material of the whole mesh.
    pub(super) material: Option<String>,
    /// Names by which all pieces of the mesh can be chosen.
    pub(super) names: Vec<String>,
    /// Number of the mesh among those of the file.
    pub(super) number: usize,
    /// Number of its first point among those of all meshes.
    pub(super) first_position: u32,
}

/// Subset of the faces of a mesh.
#[derive(Debug, Clone)]
struct Subset {
    name: Option<String>,
    material: Option<String>,
}

/// Returns the name of the material that is bound to `prim` itself.
pub(super) fn bound_material(prim: &Prim) -> Result<Option<String>, Fault> {
    let targets = prim.targets("material:binding")?;
    Ok(targets
        .first()
        .and_then(|path| path.rsplit('/').next())
        .filter(|name| !name.is_empty())
        .map(str::to_owned))
}

impl PlacedMesh<'_> {
    /// Makes the pieces, numbered from `first_primitive`.
    pub(super) fn into_pieces(
        self,
        first_primitive: usize,
        triangulator: &mut Triangulator,
        notes: &mut Notes,
    ) -> Result<Vec<NamedPiece>, Fault> {
        let (subsets, subset_of_face) = self.subsets(notes)?;
        let mut vertices: Vec<CornerVertices> = subsets.iter().map(|_| CornerVertices::default()).collect();
        let mut order = Vec::new();
        for (face, subset) in self.data.faces.iter().zip(&subset_of_face) {
            let Some(corners) = face.clone().and_then(|face| self.data.corners.get(face)) else { continue };
            if vertices[*subset].triangles.is_empty() {
                order.push(*subset);
            }
            vertices[*subset].add_face(&self.data.positions, corners, triangulator);
        }
        let mut pieces = Vec::new();
        for subset in order {
            let primitive = first_primitive + pieces.len();
            pieces.push(self.piece(&subsets[subset], std::mem::take(&mut vertices[subset]), primitive));
        }
        Ok(pieces)
    }

    /// Returns the subsets, the last of them all faces without one, and per face the number of its subset.
    fn subsets(&self, notes: &mut Notes) -> Result<(Vec<Subset>, Vec<usize>), Fault> {
        let mut subsets = Vec::new();
        let mut subset_of_face = vec![usize::MAX; self.data.faces.len()];
        for child in self.children.iter().filter(|child| child.kind().is_ok_and(|kind| kind == "GeomSubset"))
        {
            let token = |name: &str| match child.value(name) {
                Ok(Some(sampled)) => match sampled.value {
                    UsdValue::Token(token) => Some(token),
                    _ => None,
                },
                _ => None,
            };
            if token("familyName").is_none_or(|family| family != MATERIAL_FAMILY)
                || token("elementType").is_some_and(|kind| kind != "face")
            {
                notes.count(Severity::Note, &child.path(), "subsets that assign no materials are not read");
                continue;
            }
            let faces = match child.value("indices").map(|value| value.map(|sampled| sampled.value)) {
                Ok(Some(UsdValue::Integers(faces))) => faces,
                Ok(None) => Vec::new(),
                _ => {
                    let message =
                        "subsets have indices that cannot be read: their faces have the material of the mesh";
                    notes.count(Severity::Warning, &child.path(), message);
                    Vec::new()
                }
            };
            for face in faces {
                let slot = usize::try_from(face).ok().and_then(|face| subset_of_face.get_mut(face));
                match slot {
                    // A face is in one subset of a family; the first counts.
                    Some(slot) if *slot == usize::MAX => *slot = subsets.len(),
                    Some(_) => {}
                    None => notes.count(
                        Severity::Repaired,
                        &child.path(),
                        "faces of subsets that the mesh has not are left out",
                    ),
                }
            }
            let material = bound_material(child)?.or_else(|| self.material.clone());
            subsets.push(Subset { name: Some(child.name()), material });
        }
        let rest = subsets.len();
        subsets.push(Subset { name: None, material: self.material.clone() });
        subset_of_face.iter_mut().filter(|slot| **slot == usize::MAX).for_each(|slot| *slot = rest);
        Ok((subsets, subset_of_face))
    }

    fn piece(&self, subset: &Subset, vertices: CornerVertices, primitive: usize) -> NamedPiece {
        let MeshData { positions, uvs, normals, masks, .. } = &self.data;
        let CornerVertices { corners, face_normals, mut triangles, .. } = vertices;
        let has_uvs = corners.iter().any(|corner| corner.uv != INVALID);
        let has_normals = corners.iter().any(|corner| corner.normal != INVALID);
        let mut names = Vec::new();
        for name in subset.name.iter().chain(&subset.material).chain(&self.names) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        let placement = Placement::Rigid(self.to_scene);
        SourcePiece::orient_by_placement(&placement, &mut triangles);
        let mask = |k: usize| {
            let of_point = (!masks[k].is_empty()).then_some(&masks[k])?;
            Some(corners.iter().map(|corner| of_point[corner.position as usize]).collect::<Vec<f64>>())
        };
        let normal = |k: usize| normals.get(corners[k].normal as usize).copied().unwrap_or(face_normals[k]);
        let piece = SourcePiece {
            name: self.prim.name(),
            material: subset.material.clone(),
            mesh: self.number,
            primitive,
            node: None,
            positions: corners.iter().map(|corner| positions[corner.position as usize]).collect(),
            position_ids: Some(corners.iter().map(|corner| self.first_position + corner.position).collect()),
            normals: has_normals.then(|| (0..corners.len()).map(normal).collect()),
            uvs: has_uvs.then(|| {
                corners
                    .iter()
                    .map(|corner| uvs.get(corner.uv as usize).copied().unwrap_or_default())
                    .collect()
            }),
            mask: mask(0),
            sewing_mask: mask(1),
            triangles,
            placement,
            joints: Vec::new(),
            worn: true,
        };
        NamedPiece { piece, names }
    }
}
