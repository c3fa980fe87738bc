//! Creates a glTF document from the pieces of an OBJ file, as OBJ cannot hold a second shape of the same mesh.
//!
//! One node, one mesh, one primitive for each piece with at least one triangle; vertices keep number and order within
//! their piece. Positions are in metres, y up; those of a garment far from the origin are relative to the node. Normals are those of the file, or smooth ones where it has none:
//! area-weighted over triangles with a common position, so that texture seams do not show. Materials have the names of the
//! OBJ's and a plain two-sided cloth colour, as cloth is seen from both sides; the .mtl file is not read.

use crate::gltf::add_morph_target::append_worn_target;
use crate::gltf::append::{Appender, Purpose};
use crate::gltf::names::{REST_ANGLE_CHANGE_ATTRIBUTE, STIFFNESS_ATTRIBUTE, WORN_TARGET};
use crate::gltf::smooth_shading::tilt_flat_normals;
use crate::gltf::worn_target::WornTarget;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle;
use crease_model::error::{Error, Result};
use crease_model::garment::{SourceAsset, SourcePiece};
use rustc_hash::FxHashMap;
use serde_json::{Map, Value, json};

/// Base colour of a material of which only the name is known: light grey.
const BASE_COLOUR: [f64; 4] = [0.8, 0.8, 0.8, 1.0];
/// Roughness of such a material.
const ROUGHNESS: f64 = 0.9;

/// Distance from the origin beyond which a garment gets an origin of its own [m]: single precision has steps of 8 micrometres
/// there.
const MIN_FAR_DISTANCE_M: f64 = 100.0;

/// Piece in scene coordinates.
pub(super) struct ScenePiece {
    /// Per vertex: position [m], y up.
    pub(super) positions: Vec<Vec3>,
    /// Per vertex: unit normal.
    pub(super) normals: Vec<Vec3>,
}

/// Transforms every piece of `asset` to the scene, with normals.
pub(super) fn scene_pieces(asset: &SourceAsset) -> Vec<ScenePiece> {
    let positions: Vec<Vec<Vec3>> = asset.pieces.iter().map(scene_positions).collect();
    let smooth = smooth_normals(asset, &positions);
    let with_normals = |(piece, (positions, smooth)): (&SourcePiece, (Vec<Vec3>, Vec<Vec3>))| {
        let own = scene_normals(piece);
        let normals =
            smooth.into_iter().enumerate().map(|(v, smooth)| own.get(v).copied().flatten().unwrap_or(smooth));
        let mut normals: Vec<Vec3> = normals.collect();
        tilt_flat_normals(&positions, &piece.triangles, &mut normals, 0);
        ScenePiece { normals, positions }
    };
    asset.pieces.iter().zip(positions.into_iter().zip(smooth)).map(with_normals).collect()
}

/// Writes the document of all pieces as a GLB file; `targets` has one entry per piece, `None` where it is not worn.
pub(super) fn obj_document(
    asset: &SourceAsset,
    scene: &[ScenePiece],
    targets: &[Option<WornTarget>],
    extras: &Map<String, Value>,
) -> Result<Vec<u8>> {
    let name = stem(&asset.file);
    let has_targets = targets.iter().any(Option::is_some);
    let mut extras = extras.clone();
    let mut mesh = json!({"name": name, "primitives": []});
    if has_targets {
        extras.insert("targetNames".into(), json!([WORN_TARGET]));
        mesh["weights"] = json!([1.0]);
    }
    mesh["extras"] = Value::Object(extras);
    let mut node = json!({"name": name, "mesh": 0});
    let origin = document_origin(asset);
    if origin != Vec3::zeros() {
        node["translation"] = json!([origin.x, origin.y, origin.z]);
    }
    let document = json!({
        "asset": {"version": "2.0", "generator": concat!("crease ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [mesh],
        "materials": [], "accessors": [], "bufferViews": [], "buffers": [],
    });
    let Value::Object(document) = document else { return Ok(Vec::new()) };
    let mut appender = Appender::new(document);
    let mut materials = FxHashMap::default();
    let mut primitives = Vec::new();
    for ((piece, scene), target) in asset.pieces.iter().zip(scene).zip(targets) {
        if piece.triangles.is_empty() {
            continue;
        }
        let material = *materials
            .entry(piece.material.as_deref())
            .or_insert_with(|| appender.push("materials", material(piece.material.as_deref())));
        let mut primitive =
            primitive(&mut appender, piece, scene, &origin, target.as_ref()).map_err(|message| {
                Error::input(&asset.file, &piece.name, message, "check the unit of the file")
            })?;
        primitive["material"] = json!(material);
        if !has_targets && let Some(primitive) = primitive.as_object_mut() {
            primitive.shift_remove("targets");
        }
        primitives.push(primitive);
    }
    if primitives.is_empty() {
        return Err(Error::input(&asset.file, "", "has no triangles", "give a mesh with faces"));
    }
    if let Some(mesh) = appender.list("meshes").first_mut() {
        mesh["primitives"] = Value::Array(primitives);
    }
    Ok(appender.into_glb())
}

/// Returns the origin of the mesh in the scene [m]: the middle of a garment far from the origin of its file, whose positions
/// single precision would round. Whole metres, which any precision holds.
fn document_origin(asset: &SourceAsset) -> Vec3 {
    let Some((low, high)) = asset.worn_bounds() else { return Vec3::zeros() };
    let middle = (low + high) / 2.0;
    if middle.norm() > MIN_FAR_DISTANCE_M { middle.map(f64::round) } else { Vec3::zeros() }
}

/// Appends the numbers of one primitive and returns its entry; fails if they do not fit 32-bit floats.
fn primitive(
    appender: &mut Appender,
    piece: &SourcePiece,
    scene: &ScenePiece,
    origin: &Vec3,
    worn: Option<&WornTarget>,
) -> std::result::Result<Value, &'static str> {
    let narrow =
        |rows: &[Vec3]| rows.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect::<Vec<_>>();
    let positions: Vec<Vec3> = scene.positions.iter().map(|p| p - origin).collect();
    let positions = narrow(&positions);
    if positions.iter().flatten().any(|x| !x.is_finite()) {
        return Err("has positions too large for glTF");
    }
    let mut attributes = json!({
        "POSITION": appender.vectors(&positions, Purpose::Position),
        "NORMAL": appender.vectors(&narrow(&scene.normals), Purpose::Vertex),
    });
    if let Some(uvs) = &piece.uvs {
        let uvs: Vec<[f32; 2]> = uvs.iter().map(|uv| [uv.x as f32, uv.y as f32]).collect();
        if uvs.iter().flatten().all(|x| x.is_finite()) {
            attributes["TEXCOORD_0"] = json!(appender.vectors(&uvs, Purpose::Vertex));
        }
    }
    let target = match worn {
        Some(worn) => {
            attributes[REST_ANGLE_CHANGE_ATTRIBUTE] =
                json!(appender.scalars(&worn.rest_change_deg, Purpose::Vertex));
            attributes[STIFFNESS_ATTRIBUTE] = json!(appender.scalars(&worn.stiffness, Purpose::Vertex));
            append_worn_target(appender, worn)
        }
        None => json!({"POSITION": appender.zero_positions(positions.len())}),
    };
    let indices = appender.triangles(&piece.triangles);
    Ok(json!({
        "attributes": attributes, "indices": indices, "targets": [target], "extras": {"name": piece.name},
    }))
}

fn material(name: Option<&str>) -> Value {
    let mut material = json!({
        "pbrMetallicRoughness": {"baseColorFactor": BASE_COLOUR, "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS},
        "doubleSided": true,
    });
    if let Some(name) = name {
        material["name"] = json!(name);
    }
    material
}

/// Returns the file name without folders and extension.
fn stem(file: &str) -> &str {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

fn scene_positions(piece: &SourcePiece) -> Vec<Vec3> {
    (0..piece.positions.len()).map(|v| piece.scene_position(v).unwrap_or_default()).collect()
}

/// Returns the file's normals in the scene; `None` where one is missing or has no length.
fn scene_normals(piece: &SourcePiece) -> Vec<Option<Vec3>> {
    let transformed = |(v, n): (usize, &Vec3)| {
        let linear = piece.placement.matrix(v).fixed_view::<3, 3>(0, 0).into_owned();
        (linear.try_inverse()?.transpose() * n).try_normalize(f64::MIN_POSITIVE)
    };
    piece.normals.iter().flatten().enumerate().map(transformed).collect()
}

/// Returns area-weighted normals over all triangles with a common position, in whatever piece. Where they cancel (the
/// same sheet in both orientations), those of the vertex alone; without a triangle, the y axis.
fn smooth_normals(asset: &SourceAsset, positions: &[Vec<Vec3>]) -> Vec<Vec<Vec3>> {
    let mut shared: FxHashMap<[u64; 3], Vec3> = FxHashMap::default();
    let mut alone: Vec<Vec<Vec3>> = positions.iter().map(|p| vec![Vec3::zeros(); p.len()]).collect();
    for ((piece, positions), alone) in asset.pieces.iter().zip(positions).zip(&mut alone) {
        for t in &piece.triangles {
            let corners = t.map(|v| positions[v as usize]);
            let normal = triangle::area_vector(&corners);
            for (v, p) in t.iter().zip(corners) {
                *shared.entry(bits(p)).or_insert_with(Vec3::zeros) += normal;
                alone[*v as usize] += normal;
            }
        }
    }
    let choose = |(p, alone): (&Vec3, Vec3)| {
        // Normals that cancel leave rounding errors, which are no direction.
        let min_length = alone.norm() * 1e-9;
        let shared = shared.get(&bits(*p)).and_then(|n| n.try_normalize(min_length));
        shared.or_else(|| alone.try_normalize(f64::MIN_POSITIVE)).unwrap_or_else(Vec3::y)
    };
    positions.iter().zip(alone).map(|(p, alone)| p.iter().zip(alone).map(choose).collect()).collect()
}

/// Returns a position as a key; both zeros are equal.
fn bits(p: Vec3) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}
