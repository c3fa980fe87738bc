//! Writes the main output of a bake: the source file with the worn shape as a morph target, as one GLB file.
//!
//! Last stage of the pipeline. glTF input is written unchanged with the worn target added (`add_morph_target`); OBJ input
//! becomes a new document (`obj_to_gltf`). The numbers are computed in `worn_target`, the same for both.
//! Vertices keep their number and order, so that rigs, textures and other tools' data still fit. Images that a .gltf
//! names by a path stay external unless [`crate::gltf::embed_images`] has embedded them.

use crate::gltf::accessor::Accessors;
use crate::gltf::add_morph_target::{WornPrimitive, add_worn_targets};
use crate::gltf::append::Appender;
use crate::gltf::flat_shading::FlatNormals;
use crate::gltf::json_cursor::Cursor;
use crate::gltf::morph::{add_targets, default_weights};
use crate::gltf::obj_to_gltf::{ScenePiece, obj_document, scene_pieces};
use crate::gltf::smooth_shading::tilt_flat_normals;
use crate::gltf::sound_normals::mend_normals;
use crate::gltf::worn_target::{LinearParts, PieceBase, WornShape, WornTarget};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_model::error::{Diagnostic, Error, Result};
use crease_model::garment::{
    Garment, GltfDocument, Placement, SourceAsset, SourceFormat, SourcePiece, WornGarment,
};
use serde_json::{Map, Value};

/// Writes `asset` as a GLB file in which every worn piece has the shape of `worn` as morph target `worn` with weight 1, and
/// its memory as vertex attributes. `garment` was built from `asset`. `extras` (an object, or null for none) is merged
/// into the extras of every worn mesh: `{"crease": {"sidecar": "OUT.crease.json"}}`.
pub fn write_worn_glb(
    asset: &SourceAsset,
    garment: &Garment,
    worn: &WornGarment,
    extras: &Value,
) -> Result<Vec<u8>> {
    write_worn_glb_with(asset, garment, worn, extras, FlatNormals::default())
}

/// Writes what [`write_worn_glb`] writes; `flat_normals` tells what becomes of flat-shaded vertices.
pub fn write_worn_glb_with(
    asset: &SourceAsset,
    garment: &Garment,
    worn: &WornGarment,
    extras: &Value,
    flat_normals: FlatNormals,
) -> Result<Vec<u8>> {
    check_parts(asset, garment, worn)?;
    let none = Map::new();
    let extras = match extras {
        Value::Object(extras) => extras,
        Value::Null => &none,
        _ => return Err(Error::input(&asset.file, "extras", "are not a JSON object", "")),
    };
    let shape = WornShape::new(garment, worn, flat_normals);
    match (asset.format, &asset.document) {
        (SourceFormat::Gltf, Some(document)) => worn_gltf(asset, document, garment, &shape, extras),
        (SourceFormat::Gltf, None) => Err(Error::input(&asset.file, "", "its glTF document is missing", "")),
        (SourceFormat::Obj | SourceFormat::Usd | SourceFormat::Arrays, _) => {
            worn_obj(asset, garment, &shape, extras)
        }
    }
}

/// Shape of a worn piece in the scene, before the wear and what the wear adds; lists are per vertex.
#[derive(Debug, Clone)]
pub(crate) struct SceneShape {
    /// Position [m].
    pub(crate) positions: Vec<Vec3>,
    /// Unit normal.
    pub(crate) normals: Vec<Vec3>,
    /// Displacement [m].
    pub(crate) shifts: Vec<Vec3>,
    /// Change of the normal.
    pub(crate) normal_shifts: Vec<Vec3>,
}

/// Computes the shapes of the worn pieces of `asset`.
pub(crate) fn scene_shapes(
    asset: &SourceAsset,
    garment: &Garment,
    worn: &WornGarment,
) -> Result<Vec<SceneShape>> {
    check_parts(asset, garment, worn)?;
    let shape = WornShape::new(garment, worn, FlatNormals::default());
    let wide = |rows: Vec<[f32; 3]>| rows.into_iter().map(|row| Vec3::from(row.map(f64::from))).collect();
    let mut shapes = Vec::new();
    let pieces = asset.pieces.iter().zip(scene_pieces(asset)).zip(points_of_pieces(asset, garment));
    for ((piece, ScenePiece { positions, normals }), points) in pieces {
        let Some(points) = points else { continue };
        let base = PieceBase {
            points,
            linear: LinearParts::identity(),
            normals: Some(normals.clone()),
            mended_normals: None,
            tangents: None,
            triangles: &piece.triangles,
        };
        let target = worn_target(asset, piece, &shape, &base)?;
        let normal_shifts = target.normal.map_or_else(Vec::new, wide);
        shapes.push(SceneShape { positions, normals, shifts: wide(target.position), normal_shifts });
    }
    Ok(shapes)
}

/// Writes `asset` as a GLB file as it is; an OBJ becomes a new document. Pictures in other files stay there.
pub fn plain_glb(asset: &SourceAsset) -> Result<Vec<u8>> {
    match &asset.document {
        Some(document) => Ok(Appender::from_document(&asset.file, document)?.into_glb()),
        None => {
            let targets: Vec<_> = asset.pieces.iter().map(|_| None).collect();
            obj_document(asset, &scene_pieces(asset), &targets, &Map::new())
        }
    }
}

fn worn_gltf(
    asset: &SourceAsset,
    document: &GltfDocument,
    garment: &Garment,
    shape: &WornShape,
    extras: &Map<String, Value>,
) -> Result<Vec<u8>> {
    let mut bases = Vec::new();
    for (piece, points) in asset.pieces.iter().zip(points_of_pieces(asset, garment)) {
        if let Some(points) = points {
            bases.push((piece, piece_base(asset, document, piece, points)?));
        }
    }
    let mut primitives = Vec::with_capacity(bases.len());
    for (piece, base) in &bases {
        let target = worn_target(asset, piece, shape, base)?;
        primitives.push(WornPrimitive {
            node: piece.node,
            mesh: piece.mesh,
            primitive: piece.primitive,
            target,
        });
    }
    let mut appender = Appender::from_document(&asset.file, document)?;
    let claimed: Vec<usize> = asset.pieces.iter().filter_map(|piece| piece.node).collect();
    add_worn_targets(&asset.file, &mut appender, document, &primitives, &claimed, extras)?;
    Ok(appender.into_glb())
}

fn worn_obj(
    asset: &SourceAsset,
    garment: &Garment,
    shape: &WornShape,
    extras: &Map<String, Value>,
) -> Result<Vec<u8>> {
    let scene = scene_pieces(asset);
    let mut targets = Vec::with_capacity(asset.pieces.len());
    for ((piece, scene), points) in asset.pieces.iter().zip(&scene).zip(points_of_pieces(asset, garment)) {
        targets.push(match points {
            // The new document is in scene coordinates throughout.
            Some(points) => {
                let normals = Some(scene.normals.clone());
                let linear = LinearParts::identity();
                let base = PieceBase {
                    points,
                    linear,
                    normals,
                    mended_normals: None,
                    tangents: None,
                    triangles: &piece.triangles,
                };
                Some(worn_target(asset, piece, shape, &base)?)
            }
            None => None,
        });
    }
    obj_document(asset, &scene, &targets, extras)
}

/// Reads the base shape of a worn primitive.
fn piece_base<'a>(
    asset: &SourceAsset,
    document: &GltfDocument,
    piece: &'a SourcePiece,
    points: &'a [PointIndex],
) -> Result<PieceBase<'a>> {
    let placements = match &piece.placement {
        Placement::Rigid(one) => std::slice::from_ref(one),
        Placement::Skinned(all) => &all[..],
    };
    let linear = LinearParts::new(placements).map_err(|v| {
        let message = match &piece.placement {
            Placement::Rigid(_) => "its node's transform flattens it".to_owned(),
            Placement::Skinned(_) => format!("the skin flattens it at vertex {v}"),
        };
        Error::input(&asset.file, &piece.name, message, "give every node and joint a scale other than 0")
    })?;
    let root = Cursor::root(&document.json);
    let primitive = root.entry("meshes", piece.mesh).entry("primitives", piece.primitive);
    let weights = default_weights(&root, piece.mesh, piece.node);
    let mut mended_normals = None;
    let mut stored = |name: &str, width: usize| -> Result<Option<Vec<Vec3>>> {
        let Some(accessor) = primitive.member("attributes").index(name).ok().flatten() else {
            return Ok(None);
        };
        let accessors = Accessors::new(document);
        let table = accessors.table_of(accessor, width, Some(points.len()), name)?;
        let mut rows = table.rows().map(direction).collect::<Vec<_>>();
        let is_new = name == "NORMAL" && {
            let is_mended = mend_normals(piece, &linear, &mut rows);
            tilt_flat_normals(&piece.positions, &piece.file_triangles(), &mut rows, 0) || is_mended
        };
        if is_new {
            mended_normals = Some(rows.iter().map(|n| [n.x, n.y, n.z].map(|x| x as f32)).collect());
        }
        add_targets(&accessors, &primitive, &weights, name, &mut rows)?;
        Ok(Some(rows))
    };
    // The fourth number of a tangent, its handedness, is not morphed.
    let (normals, tangents) = (stored("NORMAL", 3)?, stored("TANGENT", 4)?);
    Ok(PieceBase { points, linear, normals, mended_normals, tangents, triangles: &piece.triangles })
}

/// Returns the first three numbers of `row`; zero if they are not finite.
fn direction(row: &[f64]) -> Vec3 {
    match row {
        [x, y, z, ..] if x.is_finite() && y.is_finite() && z.is_finite() => Vec3::new(*x, *y, *z),
        _ => Vec3::zeros(),
    }
}

fn worn_target(
    asset: &SourceAsset,
    piece: &SourcePiece,
    shape: &WornShape,
    base: &PieceBase,
) -> Result<WornTarget> {
    shape.target(base).map_err(|v| {
        let message = format!("the worn shape of vertex {v} is too large for glTF");
        Error::input(&asset.file, &piece.name, message, "check the unit of the file")
    })
}

/// Returns per piece the points of its vertices, `None` where it is not worn. Lengths have been checked.
fn points_of_pieces<'a>(asset: &SourceAsset, garment: &'a Garment) -> Vec<Option<&'a [PointIndex]>> {
    let mut rest = &garment.source_point[..];
    let mut next = |piece: &SourcePiece| {
        let (points, after) = rest.split_at_checked(piece.positions.len()).filter(|_| piece.worn)?;
        rest = after;
        Some(points)
    };
    asset.pieces.iter().map(&mut next).collect()
}

/// Rejects parts that do not belong together, with all errors, so that all indices are valid afterwards.
fn check_parts(asset: &SourceAsset, garment: &Garment, worn: &WornGarment) -> Result<()> {
    let mut errors = Vec::new();
    let mut same = |list: &str, found: usize, wanted: usize, of: &str| {
        if found != wanted {
            let message = format!("{list} has {found} entries for {wanted} {of}");
            errors.push(Diagnostic::new(
                &asset.file,
                "worn garment",
                message,
                "use the garment made from this file",
            ));
        }
    };
    let (points, hinges) = (garment.points.len(), garment.topology.hinges.len());
    let vertices = asset.pieces.iter().filter(|p| p.worn).map(|p| p.positions.len()).sum();
    same("source_point", garment.source_point.len(), vertices, "vertices of worn pieces");
    let beyond = garment.source_point.iter().filter(|p| p.at() >= points).count();
    same("source_point beyond the last point", beyond, 0, "allowed");
    same("displacement", worn.displacement.len(), points, "points");
    let finite = worn.displacement.iter().filter(|d| d.iter().all(|x| x.is_finite())).count();
    same("finite displacement", finite, worn.displacement.len(), "points");
    same("source_angle", worn.memory.source_angle.len(), hinges, "hinges");
    same("rest_angle", worn.memory.rest_angle.len(), hinges, "hinges");
    same("stiffness_ratio", worn.memory.stiffness_ratio.len(), hinges, "hinges");
    let memory = [&worn.memory.source_angle, &worn.memory.rest_angle, &worn.memory.stiffness_ratio];
    let not_finite = memory.iter().flat_map(|list| list.iter()).filter(|x| !x.is_finite()).count();
    same("memory that is not a number", not_finite, 0, "allowed");
    for piece in &asset.pieces {
        let count = piece.positions.len();
        if let Some(normals) = &piece.normals {
            same(&format!("normals of {}", piece.name), normals.len(), count, "vertices");
        }
        let beyond = piece.triangles.iter().flatten().filter(|&&v| v as usize >= count).count();
        same(&format!("corners of {} beyond its vertices", piece.name), beyond, 0, "allowed");
        if let Placement::Skinned(all) = &piece.placement {
            same(&format!("placement of {}", piece.name), all.len(), count, "vertices");
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(Error::Input(errors)) }
}
