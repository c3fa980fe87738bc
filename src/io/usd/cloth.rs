//! Meshes that renderers show, their materials, and the frames of a bake.

use crate::gltf::{SceneShape, scene_shapes};
use crate::usd::prim::{Prim, extent, identifier, list, texture_coordinates, vectors};
use crate::usd::scene::{MATERIALS, PHYSICS_MATERIAL, ROOT, UsdFrames};
use crate::usd::skeleton::UsdSkeleton;
use crate::usd::texture::{SurfaceTextures, UsdTexture, material_of, usd_textures};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourceAsset, SourcePiece, WornGarment};
use serde_json::Value;

/// Base colour of a piece without material: light grey, as in the glTF of an OBJ.
const BASE_COLOUR: [f64; 4] = [0.8, 0.8, 0.8, 1.0];
/// Roughness of cloth.
const ROUGHNESS: f64 = 0.9;

/// Meshes of all worn pieces.
pub(super) struct Cloth {
    pub(super) meshes: Vec<Prim>,
    pub(super) extent: String,
}

/// Makes the meshes of the worn pieces of `asset`.
pub(super) fn cloth_meshes(
    asset: &SourceAsset,
    garment: &Garment,
    worn: &WornGarment,
    skeleton: &UsdSkeleton,
) -> Result<Cloth> {
    let shapes = scene_shapes(asset, garment, worn)?;
    let (mut meshes, mut all) = (Vec::new(), Vec::new());
    let mut first = 0;
    for (k, (piece, shape)) in asset.worn_pieces().zip(&shapes).enumerate() {
        let start = first;
        first += piece.positions.len();
        if piece.triangles.is_empty() {
            continue;
        }
        let after: Vec<Vec3> = shape.positions.iter().zip(&shape.shifts).map(|(x, d)| x + d).collect();
        meshes.push(cloth_mesh(&piece_name(piece, k), piece, shape, &after, skeleton, start));
        all.push(after);
    }
    let shown = all.iter().map(Vec::as_slice).chain(shapes.iter().map(|shape| &shape.positions[..]));
    Ok(Cloth { extent: extent(shown), meshes })
}

/// Unique name of the mesh of worn piece `k`.
fn piece_name(piece: &SourcePiece, k: usize) -> String {
    let name = identifier(&piece.name, "Cloth");
    if k == 0 { name } else { format!("{name}_{k}") }
}

fn cloth_mesh(
    name: &str,
    piece: &SourcePiece,
    shape: &SceneShape,
    after: &[Vec3],
    skeleton: &UsdSkeleton,
    start: usize,
) -> Prim {
    let corners = piece.triangles.iter().flatten().map(u32::to_string);
    let counts = piece.triangles.iter().map(|_| "3".to_owned());
    let st = piece.uvs.as_ref().map(|uvs| {
        format!(
            "texCoord2f[] primvars:st = {} (\n        interpolation = \"vertex\"\n    )",
            texture_coordinates(uvs)
        )
    });
    let blend = Prim::new("BlendShape", "worn")
        .line(format!("uniform vector3f[] offsets = {}", vectors(&shape.shifts)))
        .line(format!("uniform vector3f[] normalOffsets = {}", vectors(&shape.normal_shifts)));
    let mut mesh = Prim::new("Mesh", name)
        .api(&["MaterialBindingAPI", "SkelBindingAPI"])
        .line("uniform bool doubleSided = 1".into())
        .line(format!("float3[] extent = {}", extent([&shape.positions[..], after])))
        .line(format!("int[] faceVertexCounts = {}", list(counts)))
        .line(format!("int[] faceVertexIndices = {}", list(corners)))
        .line(format!("rel material:binding = <{MATERIALS}/{}>", material_name(piece)))
        .line(format!("rel material:binding:physics = <{MATERIALS}/{PHYSICS_MATERIAL}>"))
        .line(format!(
            "normal3f[] normals = {} (\n        interpolation = \"vertex\"\n    )",
            vectors(&shape.normals)
        ))
        .line(format!("point3f[] points = {}", vectors(&shape.positions)))
        .maybe(st)
        .line("uniform token[] skel:blendShapes = [\"worn\"]".into())
        .line(format!("rel skel:blendShapeTargets = <{ROOT}/{name}/worn>"))
        .line(format!("rel skel:skeleton = <{ROOT}/Skeleton>"))
        .line("uniform token subdivisionScheme = \"none\"".into());
    for line in skeleton.binding(start, shape.positions.len()) {
        mesh = mesh.line(line);
    }
    mesh.child(blend)
}

/// Makes the mesh of the garment over time: all worn pieces in one.
pub(super) fn frames_mesh(asset: &SourceAsset, frames: &UsdFrames) -> Prim {
    let triangles = asset.worn_triangles();
    let samples = frames.positions.iter().enumerate().map(|(k, x)| format!("\n        {k}: {},", vectors(x)));
    let extents =
        frames.positions.iter().enumerate().map(|(k, x)| format!("\n        {k}: {},", extent([&x[..]])));
    Prim::new("Mesh", "Frames")
        .api(&["MaterialBindingAPI"])
        .line("uniform bool doubleSided = 1".into())
        .line(format!("float3[] extent.timeSamples = {{{}\n    }}", extents.collect::<String>()))
        .line(format!("int[] faceVertexCounts = {}", list(triangles.iter().map(|_| "3".to_owned()))))
        .line(format!("int[] faceVertexIndices = {}", list(triangles.iter().flatten().map(u32::to_string))))
        .line(format!("rel material:binding:physics = <{MATERIALS}/{PHYSICS_MATERIAL}>"))
        .line(format!("point3f[] points.timeSamples = {{{}\n    }}", samples.collect::<String>()))
        .line("uniform token subdivisionScheme = \"none\"".into())
        .line("token visibility = \"invisible\"".into())
}

fn material_name(piece: &SourcePiece) -> String {
    format!("Surface_{}", identifier(piece.material.as_deref().unwrap_or(""), "cloth"))
}

/// Makes the materials: a surface for each material of the worn pieces, and the physical one of the fabric. `scene` is the name of the
/// scene's file without its ending.
pub(super) fn materials(asset: &SourceAsset, fabric: &Fabric, scene: &str) -> Prim {
    let textures = usd_textures(asset);
    let density = fabric.area_density() / fabric.thickness();
    let physical = Prim::new("Material", PHYSICS_MATERIAL)
        .api(&["PhysicsMaterialAPI", "PhysicsSurfaceDeformableMaterialAPI"])
        .line(format!("float physics:density = {density}"))
        .line(format!("float physics:dynamicFriction = {}", fabric.friction))
        .line(format!("float physics:staticFriction = {}", fabric.friction))
        .line(format!("float physics:surfaceThickness = {}", fabric.thickness()))
        .line(format!("custom string crease:fabric = \"{}\"", identifier(&fabric.name, "fabric")));
    let mut scope = Prim::new("Scope", "Materials").child(physical);
    let mut known = Vec::new();
    for piece in asset.worn_pieces() {
        let name = material_name(piece);
        if known.contains(&name) {
            continue;
        }
        scope = scope.child(surface(asset, piece, &name, scene, &textures));
        known.push(name);
    }
    scope
}

/// Makes the surface `name` of the material of a piece.
fn surface(
    asset: &SourceAsset,
    piece: &SourcePiece,
    name: &str,
    scene: &str,
    textures: &[UsdTexture],
) -> Prim {
    let path = format!("{MATERIALS}/{name}");
    let material =
        asset.document.as_ref().and_then(|document| Some((document, material_of(document, piece)?)));
    let optics = material.map_or(&Value::Null, |(_, material)| &material["pbrMetallicRoughness"]);
    let factor = base_colour(optics, material.is_some());
    let images = match material.filter(|_| piece.uvs.is_some()) {
        Some((document, material)) => {
            SurfaceTextures::new(document, material, &path, scene, textures, factor)
        }
        None => SurfaceTextures::default(),
    };
    // Factors of a texture that is left out say nothing alone.
    let alone = if optics.get("metallicRoughnessTexture").is_some() { &Value::Null } else { optics };
    let [r, g, b, opacity] = factor;
    let plain_colour = format!("color3f inputs:diffuseColor = ({r}, {g}, {b})");
    let is_clear = material.is_some_and(|(_, material)| material["alphaMode"] == "BLEND");
    let mut preview = Prim::new("Shader", "Preview")
        .line("uniform token info:id = \"UsdPreviewSurface\"".into())
        .maybe((!images.has("diffuseColor")).then_some(plain_colour))
        .maybe((is_clear && !images.has("opacity")).then(|| format!("float inputs:opacity = {opacity}")))
        .line(format!("float inputs:metallic = {}", alone["metallicFactor"].as_f64().unwrap_or(0.0)))
        .line(format!("float inputs:roughness = {}", alone["roughnessFactor"].as_f64().unwrap_or(ROUGHNESS)));
    for line in images.inputs {
        preview = preview.line(line);
    }
    let mut surface = Prim::new("Material", name)
        .line(format!("token outputs:surface.connect = <{path}/Preview.outputs:surface>"))
        .child(preview.line("token outputs:surface".into()));
    for shader in images.shaders {
        surface = surface.child(shader);
    }
    surface
}

/// Base colour and opacity, linear: those of the material, else those of cloth without one.
fn base_colour(optics: &Value, has_material: bool) -> [f64; 4] {
    let otherwise = if has_material { [1.0; 4] } else { BASE_COLOUR };
    [0, 1, 2, 3].map(|k| optics["baseColorFactor"][k].as_f64().unwrap_or(otherwise[k]))
}
