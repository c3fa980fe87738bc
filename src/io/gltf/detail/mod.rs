//! Writes fine wrinkles as a normal map: the detail of a garment that was simulated on a finer mesh than its file's.
//!
//! Last pass over the worn GLB. Every triangle of the fine garment lies on one of the file (its parent), so that it has a
//! position in texture space. There the fine garment's worn normal is written in the frame that a viewer computes from
//! the file's worn vertices: normal and tangent with the morph target applied, interpolated and normalised, bitangent
//! cross(normal, tangent) times handedness; directions are solved for in that frame, which need not be orthogonal. The
//! fine normal is the file's normal rotated by the wear (`worn_target`), so that unworn cloth gives a flat map and hard
//! edges stay hard. An existing normal map of the material is rotated with the fine surface (the file's weave continues
//! over the wrinkles; as in Barré-Brisebois and Hill, "Blending in Detail", 2012).
//! Without tangents in the file, MikkTSpace's are added, unworn and worn. Vertices stay unchanged.

mod tangents;
#[cfg(test)]
mod tests;
mod texels;

use crate::garment::{Garment, GltfDocument, Placement, SourceAsset, SourcePiece, WornGarment};
use crate::io::gltf::accessor::Accessors;
use crate::io::gltf::append::{Appender, Purpose};
use crate::io::gltf::detail::tangents::{Tangent, compute_tangents};
pub use crate::io::gltf::detail::texels::MapDepth;
use crate::io::gltf::detail::texels::{TexelSample, Texels};
use crate::io::gltf::flat_shading::FlatNormals;
use crate::io::gltf::read_worn::{column, keep_worn_pieces, worn_target, worn_target_index};
use crate::io::gltf::worn_target::{LinearPart, LinearParts, WornShape};
use crate::io::read::{ReadOptions, read_asset};
use crate::io::tuning::TUNING;
use crate::math::{Mat3, Vec2, Vec3};
use crate::mesh::PointIndex;
use crate::mesh::distance::barycentric;
use crate::{Error, Result};
use rustc_hash::FxHashMap;
use serde_json::{Value, json};

/// Side lengths of a detail map that can be asked for \[texels\].
pub const DETAIL_MAP_SIZES: std::ops::RangeInclusive<usize> = 64..=16384;

/// Garment on the mesh of its file and on the simulated mesh.
#[derive(Debug, Clone, Copy)]
pub struct DetailInput<'a> {
    /// Garment on the mesh of the file.
    pub coarse: &'a Garment,
    /// Garment on the simulated mesh; its first points are those of `coarse`.
    pub fine: &'a Garment,
    /// Per triangle of `fine`: the triangle of `coarse` it lies on.
    pub parent: &'a [u32],
    /// Wear of `fine`.
    pub worn: &'a WornGarment,
    /// Treatment of flat-shaded vertices, that of the worn file.
    pub flat_normals: FlatNormals,
}

/// Detail map of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct DetailMap {
    /// Name of the material, if it has one.
    pub material: Option<String>,
    /// Normal map: PNG, three channels, tangent space as glTF has it (y up).
    pub normal_png: Vec<u8>,
    /// Height of the fine surface over the coarse one: PNG, grey, 16 bits.
    pub height_png: Vec<u8>,
    /// Heights of black and white in `height_png` [m].
    pub height_range_m: [f32; 2],
    /// Whether the material refers to the map; otherwise `notes` of the result give the reason.
    pub in_material: bool,
    /// Mean angle between the map's directions and the normals of the coarse mesh [degrees].
    pub mean_tilt_deg: f64,
    /// Fraction of the map's texels that two parts of the garment fill differently [-]: a texture used twice.
    pub conflicting_fraction: f64,
}

/// Worn GLB with its maps.
#[derive(Debug, Clone, PartialEq)]
pub struct DetailOutput {
    /// GLB file.
    pub glb: Vec<u8>,
    /// Maps, in the order of the materials.
    pub maps: Vec<DetailMap>,
    /// Maps and pieces that could not be used, with reasons.
    pub notes: Vec<String>,
}

/// Adds maps of `side` x `side` texels to the worn file `glb` (as [`crate::io::gltf::write_worn_glb`] wrote it for
/// `detail.coarse`; `asset` is its source).
pub fn add_detail_map(
    glb: &[u8],
    asset: &SourceAsset,
    detail: &DetailInput,
    side: usize,
    depth: MapDepth,
) -> Result<DetailOutput> {
    if !DETAIL_MAP_SIZES.contains(&side) {
        let message = format!(
            "{side} texels a side are outside {} to {}",
            DETAIL_MAP_SIZES.start(),
            DETAIL_MAP_SIZES.end()
        );
        return Err(Error::input(&asset.file, "detail map", message, "ask for 2048"));
    }
    let worn = read_back(glb, asset, detail)?;
    let Some(document) = &worn.document else {
        return Err(Error::input(&asset.file, "detail map", "the worn file is no glTF", ""));
    };
    let mut notes = Vec::new();
    let surfaces = surfaces(&worn, document, detail, &mut notes)?;
    let mut appender = Appender::from_document(&worn.file, document)?;
    for surface in &surfaces {
        surface.add_tangents(&mut appender);
    }
    let mut materials: Vec<Option<usize>> = surfaces.iter().map(|s| s.material).collect();
    materials.sort_unstable();
    materials.dedup();
    let painter = Painter::new(detail, &surfaces);
    let mut maps = Vec::new();
    for material in materials {
        let mut texels = painter.paint(material, side);
        let filled = texels.filled_count();
        if filled == 0 {
            continue;
        }
        let tilt = |d: &Vec3| if *d == Vec3::zeros() { 0.0 } else { d.z.clamp(-1.0, 1.0).acos() };
        let mean_tilt_deg = (texels.direction.iter().map(tilt).sum::<f64>() / filled as f64).to_degrees();
        let conflicting_fraction = texels.conflicts as f64 / filled as f64;
        let name = material.and_then(|m| document.json["materials"][m]["name"].as_str()).map(str::to_owned);
        let in_material = match own_normal_map(document, material) {
            Ok(own) => {
                if let Some((own, scale)) = own {
                    rotate_with_surface(&mut texels, &own, scale);
                }
                true
            }
            Err(reason) => {
                let of = name.as_deref().unwrap_or("a material without a name");
                notes.push(format!(
                    "the normal map of {of} stays unchanged, that of the wrinkles is a separate file: {reason}"
                ));
                false
            }
        };
        texels.pad(TUNING.padding_texels);
        let broken = |message: String| Error::input(&asset.file, "detail map", message, "");
        let normal_png = texels.to_png(depth).map_err(broken)?;
        let (height_png, height_range_m) = texels.height_png().map_err(broken)?;
        if in_material {
            set_normal_texture(&mut appender, material, &surfaces, &normal_png);
        }
        maps.push(DetailMap {
            material: name,
            normal_png,
            height_png,
            height_range_m,
            in_material,
            mean_tilt_deg,
            conflicting_fraction,
        });
    }
    Ok(DetailOutput { glb: appender.into_glb(), maps, notes })
}

/// Reads the worn file again; its worn vertices are those of the garment.
fn read_back(glb: &[u8], asset: &SourceAsset, detail: &DetailInput) -> Result<SourceAsset> {
    // The worn file of an OBJ is in metres, y up; that of a glTF in the unit of its source.
    let is_gltf = asset.document.is_some();
    let options = ReadOptions {
        unit_m: Some(if is_gltf { asset.unit_m } else { 1.0 }),
        up: is_gltf.then_some(asset.up),
        ..ReadOptions::default()
    };
    let mut nothing = |name: &str| Err(Error::input(&asset.file, name, "is an external file", ""));
    let (mut worn, _) = read_asset(&asset.file, glb, &options, &mut nothing)?;
    keep_worn_pieces(&mut worn);
    let count: usize = worn.worn_pieces().map(|piece| piece.positions.len()).sum();
    let fits = count == detail.fine.source_point.len()
        && detail.parent.len() == detail.fine.triangles.len()
        && detail.worn.displacement.len() == detail.fine.points.len()
        && detail.coarse.points.len() <= detail.fine.points.len()
        && detail.parent.iter().all(|&k| (k as usize) < detail.coarse.triangles.len());
    match fits {
        true => Ok(worn),
        false => {
            let message = "the worn file and the finer garment are not of one mesh";
            Err(Error::input(&asset.file, "detail map", message, "use what was made of this file"))
        }
    }
}

/// Tangent frame of a vertex.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// Unit normal.
    normal: Vec3,
    tangent: Tangent,
}

/// Tangents before and after wear, one per vertex.
struct AddedTangents {
    unworn: Vec<Tangent>,
    worn: Vec<Tangent>,
}

/// Worn piece as a viewer shows it.
struct Surface<'a> {
    piece: &'a SourcePiece,
    material: Option<usize>,
    uvs: &'a [Vec2],
    /// Per vertex: its point.
    points: &'a [PointIndex],
    /// Per vertex, scene: unit normal before wear.
    unworn: Vec<Vec3>,
    /// Per vertex, scene: frame with the worn target applied.
    worn: Vec<Frame>,
    /// Tangents that the file lacks, own coordinates.
    added: Option<AddedTangents>,
    /// Index of the worn target among those of the primitive.
    target: usize,
}

/// Returns the worn pieces that can have a map; notes go to `notes`.
fn surfaces<'a>(
    worn: &'a SourceAsset,
    document: &GltfDocument,
    detail: &'a DetailInput,
    notes: &mut Vec<String>,
) -> Result<Vec<Surface<'a>>> {
    let mut surfaces = Vec::new();
    let mut rest = &detail.fine.source_point[..];
    for piece in worn.worn_pieces() {
        let (points, after) = rest.split_at(piece.positions.len());
        rest = after;
        let (Some(uvs), Some(normals)) = (&piece.uvs, &piece.normals) else {
            let lacks = if piece.uvs.is_none() { "texture coordinates" } else { "normals" };
            notes.push(format!("{} has no {lacks} and gets no map", piece.name));
            continue;
        };
        surfaces.push(Surface::new(&worn.file, document, piece, points, uvs, normals)?);
    }
    Ok(surfaces)
}

impl<'a> Surface<'a> {
    fn new(
        file: &str,
        document: &GltfDocument,
        piece: &'a SourcePiece,
        points: &'a [PointIndex],
        uvs: &'a [Vec2],
        normals: &[Vec3],
    ) -> Result<Self> {
        let count = piece.positions.len();
        let primitive = &document.json["meshes"][piece.mesh]["primitives"][piece.primitive];
        let target = worn_target(document, piece).unwrap_or(&Value::Null);
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
                let unworn = compute_tangents(&piece.positions, normals, uvs, &piece.triangles);
                let mut worn = compute_tangents(&positions, &worn_normals, uvs, &piece.triangles);
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
            material: primitive["material"].as_u64().and_then(|m| usize::try_from(m).ok()),
            uvs,
            points,
            unworn: normals.iter().enumerate().map(|(v, n)| in_scene(v, n)).collect(),
            worn: (0..count).map(frame).collect(),
            added,
            target: worn_target_index(document, piece).unwrap_or(0),
        })
    }

    /// Adds tangents to the document where it has none.
    fn add_tangents(&self, appender: &mut Appender) {
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

fn unit_or(v: Vec3, otherwise: Vec3) -> Vec3 {
    v.try_normalize(1e-12).unwrap_or(otherwise)
}

/// Corners of a coarse triangle.
#[derive(Debug, Clone, Copy)]
struct SurfaceCorners {
    /// Index of the surface.
    surface: usize,
    /// Vertices of that surface.
    vertices: [usize; 3],
}

/// Painter of the maps.
struct Painter<'a> {
    detail: &'a DetailInput<'a>,
    surfaces: &'a [Surface<'a>],
    /// Per triangle of the coarse garment: the vertices of its corners.
    corners: Vec<Option<SurfaceCorners>>,
    shape: WornShape<'a>,
    /// Per surface and vertex: whether it is flat-shaded and has smooth normals after the wear.
    flat: Vec<Vec<bool>>,
}

impl<'a> Painter<'a> {
    fn new(detail: &'a DetailInput, surfaces: &'a [Surface]) -> Self {
        let sorted = |mut points: [PointIndex; 3]| {
            points.sort_unstable();
            points
        };
        let mut found = FxHashMap::default();
        for (s, surface) in surfaces.iter().enumerate() {
            for t in &surface.piece.triangles {
                let vertices = t.map(|v| v as usize);
                if vertices.iter().all(|&v| v < surface.points.len()) {
                    found.entry(sorted(vertices.map(|v| surface.points[v]))).or_insert((s, vertices));
                }
            }
        }
        let corners = detail.coarse.triangles.iter().map(|t| {
            let &(s, vertices) = found.get(&sorted(*t))?;
            let points = surfaces[s].points;
            let mut corners = [0; 3];
            for (corner, p) in corners.iter_mut().zip(t) {
                *corner = *vertices.iter().find(|&&v| points[v] == *p)?;
            }
            Some(SurfaceCorners { surface: s, vertices: corners })
        });
        let shape = WornShape::new(detail.fine, detail.worn, detail.flat_normals);
        // The corners of the file's triangles are points of the fine garment, too.
        let flat = |s: &Surface| shape.flat_vertices(s.points, &s.unworn, &s.piece.triangles);
        let flat = surfaces.iter().map(flat).collect();
        Self { detail, surfaces, corners: corners.collect(), shape, flat }
    }

    /// Paints the map of one material.
    fn paint(&self, material: Option<usize>, side: usize) -> Texels {
        let mut texels = Texels::new(side);
        let DetailInput { coarse, fine, parent, worn, .. } = *self.detail;
        for (triangle, &k) in fine.triangles.iter().zip(parent) {
            let Some(SurfaceCorners { surface, vertices }) = self.corners[k as usize] else { continue };
            let is_flat = vertices.iter().all(|&v| self.flat[surface][v]);
            let surface = &self.surfaces[surface];
            if surface.material != material {
                continue;
            }
            let corners = coarse.triangles[k as usize].map(|p| coarse.points[p.at()]);
            let weights = triangle.map(|p| barycentric(&fine.points[p.at()], &corners));
            let mix = |weights: &[f64; 3], of: &dyn Fn(usize) -> Vec3| -> Vec3 {
                weights.iter().zip(vertices).map(|(w, v)| of(v) * *w).sum()
            };
            let normals: [Vec3; 3] = std::array::from_fn(|i| {
                let base = unit_or(mix(&weights[i], &|v| surface.unworn[v]), Vec3::z());
                let smooth = is_flat.then(|| self.shape.smooth_normal(triangle[i], base)).flatten();
                let rotated = || self.shape.worn_normal(triangle[i], base, LinearPart::identity());
                smooth.or_else(rotated).unwrap_or(base)
            });
            let position = |p: PointIndex, points: &[Vec3]| points[p.at()] + worn.displacement[p.at()];
            let above = triangle.map(|p| position(p, &fine.points));
            let below = coarse.triangles[k as usize].map(|p| position(p, &coarse.points));
            let uvs = weights.map(|w| w.iter().zip(vertices).map(|(w, v)| surface.uvs[v] * *w).sum());
            texels.fill(uvs, &|b| {
                let blend = |of: &[Vec3; 3]| of[0] * b[0] + of[1] * b[1] + of[2] * b[2];
                let on_parent: [f64; 3] = std::array::from_fn(|j| (0..3).map(|i| b[i] * weights[i][j]).sum());
                let n = mix(&on_parent, &|v| surface.worn[v].normal).try_normalize(1e-9)?;
                let t = mix(&on_parent, &|v| surface.worn[v].tangent.direction).try_normalize(1e-9)?;
                let bitangent = n.cross(&t) * surface.worn[vertices[0]].tangent.handedness;
                let frame = Mat3::from_columns(&[t, bitangent, n]);
                let direction =
                    (frame.try_inverse()? * blend(&normals).try_normalize(1e-9)?).try_normalize(1e-9)?;
                let on_coarse: Vec3 = below.iter().zip(on_parent).map(|(x, s)| x * s).sum();
                // A map cannot point below its surface.
                (direction.z > 0.0)
                    .then(|| TexelSample { direction, height_m: n.dot(&(blend(&above) - on_coarse)) })
            });
        }
        texels
    }
}

/// Reads the existing normal map of a material, with its scale; fails with the reason if it cannot be combined.
fn own_normal_map(
    document: &GltfDocument,
    material: Option<usize>,
) -> std::result::Result<Option<(Texels, f64)>, String> {
    let Some(entry) = material.and_then(|m| document.json["materials"][m].get("normalTexture")) else {
        return Ok(None);
    };
    if entry["texCoord"].as_u64().unwrap_or(0) != 0 {
        return Err("it uses other texture coordinates".into());
    }
    if entry["extensions"].get("KHR_texture_transform").is_some() {
        return Err("it is moved or scaled (KHR_texture_transform)".into());
    }
    let index = |value: &Value| value.as_u64().and_then(|i| usize::try_from(i).ok());
    let missing = "its picture is not in the file";
    let texture = index(&entry["index"]).ok_or(missing)?;
    let image = index(&document.json["textures"][texture]["source"]).ok_or(missing)?;
    let view = index(&document.json["images"][image]["bufferView"]).ok_or(missing)?;
    let view = &document.json["bufferViews"][view];
    let (start, length) =
        (index(&view["byteOffset"]).unwrap_or(0), index(&view["byteLength"]).ok_or(missing)?);
    let buffer = document.buffers.get(index(&view["buffer"]).ok_or(missing)?).ok_or(missing)?;
    let bytes = start.checked_add(length).and_then(|end| buffer.get(start..end)).ok_or(missing)?;
    let own = Texels::from_png(bytes).map_err(|reason| format!("only PNG can be combined ({reason})"))?;
    Ok(Some((own, entry["scale"].as_f64().unwrap_or(1.0))))
}

/// Rotates the directions of the material's own map with the fine surface.
fn rotate_with_surface(texels: &mut Texels, own: &Texels, scale: f64) {
    let (width, height) = (texels.width, texels.height);
    for (at, fine) in texels.direction.iter_mut().enumerate().filter(|(_, d)| **d != Vec3::zeros()) {
        let uv = Vec2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
        let weave = own.sample(uv.component_div(&Vec2::new(width as f64, height as f64)));
        let weave = Vec3::new(weave.x * scale, weave.y * scale, weave.z);
        let along = unit_or(Vec3::x() - *fine * fine.x, Vec3::x());
        let rotated = along * weave.x + fine.cross(&along) * weave.y + *fine * weave.z;
        *fine = unit_or(rotated, *fine);
    }
}

/// Sets `png` as the normal texture of the worn primitives of `material`. A material that others use too is copied first.
fn set_normal_texture(appender: &mut Appender, material: Option<usize>, surfaces: &[Surface], png: &[u8]) {
    let view = appender.bytes(png.to_vec());
    let image =
        appender.push("images", json!({"bufferView": view, "mimeType": "image/png", "name": "wrinkles"}));
    let texture = appender.push("textures", json!({"source": image, "name": "wrinkles"}));
    let mine = |mesh: usize, primitive: usize| {
        surfaces.iter().any(|s| (s.piece.mesh, s.piece.primitive) == (mesh, primitive))
    };
    let mut shared = material.is_none();
    for (m, mesh) in appender.list("meshes").iter().enumerate() {
        for (p, primitive) in mesh["primitives"].as_array().into_iter().flatten().enumerate() {
            let uses = primitive["material"].as_u64() == material.map(|m| m as u64);
            shared |= uses && !mine(m, p);
        }
    }
    let mut entry =
        material.and_then(|m| appender.list("materials").get(m).cloned()).unwrap_or_else(|| json!({}));
    entry["normalTexture"] = json!({"index": texture});
    match material.filter(|_| !shared) {
        Some(m) => appender.list("materials")[m] = entry,
        None => {
            let copy = appender.push("materials", entry);
            for surface in surfaces.iter().filter(|s| s.material == material) {
                if let Some(mesh) = appender.list("meshes").get_mut(surface.piece.mesh) {
                    mesh["primitives"][surface.piece.primitive]["material"] = json!(copy);
                }
            }
        }
    }
}
