//! Writes the worn surface as a normal map: what the file's triangles cannot show of it.
//!
//! Last pass over the worn GLB. Every texel belongs to a place of the file's triangles, and there the worn surface (`WornSurface`) says
//! how the wear turned the cloth: the file's own normal, turned by that, is written in the frame that a viewer computes from
//! the file's worn vertices: normal and tangent with the morph target applied, interpolated and normalised, bitangent
//! cross(normal, tangent) times handedness; directions are solved for in that frame, which need not be orthogonal.
//! Unworn cloth gives a flat map, hard edges stay hard, and creases are as narrow as those of the surface whatever the
//! file's triangles are. An existing normal map of the material is rotated with the worn surface (the file's weave continues
//! over the wrinkles; as in Barré-Brisebois and Hill, "Blending in Detail", 2012).
//! Without tangents in the file, MikkTSpace's are added, unworn and worn. Vertices stay unchanged.

mod input;
mod material;
mod painter;
mod references;
mod surface;
mod tangents;
#[cfg(test)]
pub(super) mod tests;
mod texels;

pub use input::DetailInput;
pub use texels::{DetailOf, MapDepth, MapOptions};

use crate::gltf::append::Appender;
use crate::gltf::detail::material::{NormalTextures, TextureTransform, own_normal_map, rotate_with_surface};
use crate::gltf::detail::painter::Painter;
use crate::gltf::detail::surface::{ShownSurface, surfaces};
use crate::gltf::detail::texels::Texels;
use crate::gltf::read_worn::keep_worn_pieces;
use crate::read::{ReadOptions, read_asset};
use crate::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Result};
use crease_model::garment::{GltfDocument, SourceAsset};
use crease_model::remesh::CreaseDistances;

/// Side lengths of a detail map that can be asked for \[texels\].
pub const DETAIL_MAP_SIZES: std::ops::RangeInclusive<usize> = 64..=16384;

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
    /// Angles of creases: PNG, grey, 8 bits, white for half a turn; `None` if they are not asked for.
    pub crease_png: Option<Vec<u8>>,
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

/// Adds maps to the worn file `glb` (as [`crate::gltf::write_worn_glb`] wrote it for
/// `detail.coarse`; `asset` is its source).
pub fn add_detail_map(
    glb: &[u8],
    asset: &SourceAsset,
    detail: &DetailInput,
    options: MapOptions,
) -> Result<DetailOutput> {
    let side = options.side;
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
    let surfaces = surfaces(&worn, document, detail, options.of, &mut notes)?;
    let mut appender = Appender::from_document(&worn.file, document)?;
    if options.of == DetailOf::Rest {
        surfaces.iter().for_each(|surface| surface.add_tangents(&mut appender));
    }
    let creases = options.creases.then(|| CreaseDistances::new(detail.surface, TUNING.crease_mask_reach));
    let painter = Painter::new(detail, &surfaces, creases.as_ref(), options.of);
    let maps = Maps { document, surfaces: &surfaces, painter, options };
    let maps =
        maps.add(&mut appender, &mut notes).map_err(|e| Error::input(&asset.file, "detail map", e, ""))?;
    Ok(DetailOutput { glb: appender.into_glb(), maps, notes })
}

/// Surfaces that one map of a material shows, painted.
struct Painted {
    /// Indices of the surfaces.
    surfaces: Vec<usize>,
    texels: Texels,
    filled: usize,
}

impl Painted {
    /// Fraction of the filled texels that two parts of the garment fill differently [-].
    fn conflicting_fraction(&self) -> f64 {
        self.texels.conflicts as f64 / self.filled.max(1) as f64
    }

    fn is_consistent(&self) -> bool {
        self.conflicting_fraction() <= TUNING.max_conflicting_fraction
    }
}

/// Maps to be made.
struct Maps<'a> {
    document: &'a GltfDocument,
    surfaces: &'a [ShownSurface<'a>],
    painter: Painter<'a>,
    options: MapOptions,
}

impl Maps<'_> {
    /// Makes the maps of all materials and refers to them; fails with the reason if a picture cannot be written.
    fn add(
        &self,
        appender: &mut Appender,
        notes: &mut Vec<String>,
    ) -> std::result::Result<Vec<DetailMap>, String> {
        let mut materials: Vec<Option<usize>> =
            self.surfaces.iter().flat_map(|s| s.materials.iter().copied()).collect();
        materials.sort_unstable();
        materials.dedup();
        let (mut maps, mut textures) = (Vec::new(), NormalTextures::default());
        for material in materials {
            let name = material.and_then(|m| self.document.json["materials"][m]["name"].as_str());
            let called = name.unwrap_or("a material without a name");
            let users: Vec<usize> = (0..self.surfaces.len())
                .filter(|&s| self.surfaces[s].materials.contains(&material))
                .collect();
            let own = own_normal_map(self.document, material);
            let transform = match &own {
                Ok(Some(own)) => own.transform,
                _ => TextureTransform::fitting(users.iter().map(|&s| &self.surfaces[s]), self.options.side),
            };
            let all_painted = self.paint(users, transform);
            if all_painted.iter().all(|painted| painted.filled == 0) {
                notes.push(format!(
                    "no detail map of {called}: its texture coordinates have no area; unwrap the garment"
                ));
                continue;
            }
            notes.extend(transform.note().map(|note| format!("{called}: {note}")));
            for painted in all_painted.into_iter().filter(|painted| painted.filled > 0) {
                let mut painted = painted;
                let conflicting_fraction = painted.conflicting_fraction();
                let reason = match &own {
                    _ if self.options.of == DetailOf::All => Some(format!(
                        "{called} is left without the normal map of all of the wear: that is for the mesh without it"
                    )),
                    Err(reason) => Some(format!("the normal map of {called} stays unchanged: {reason}")),
                    Ok(_) if !painted.is_consistent() => Some(format!(
                        "{called} is left without the normal map of the wrinkles: parts of the garment lie on one \
                         another in its texture and contradict each other in {:.0} % of it; give every part its own \
                         place in the texture",
                        (100.0 * conflicting_fraction).min(100.0)
                    )),
                    Ok(_) => None,
                };
                let tilt = |d: &Vec3| if *d == Vec3::zeros() { 0.0 } else { d.z.clamp(-1.0, 1.0).acos() };
                let tilts = painted.texels.direction.iter().map(tilt).sum::<f64>();
                if let (Ok(Some(own)), None) = (&own, &reason) {
                    rotate_with_surface(&mut painted.texels, own);
                }
                painted.texels.pad(TUNING.padding_texels);
                let normal_png = painted.texels.to_png(self.options.depth)?;
                let (height_png, height_range_m) = painted.texels.height_png()?;
                let crease_png = if self.options.creases { Some(painted.texels.crease_png()?) } else { None };
                let in_material = reason.is_none();
                if in_material {
                    let shown: Vec<&ShownSurface> =
                        painted.surfaces.iter().map(|&s| &self.surfaces[s]).collect();
                    textures.set(appender, material, &shown, &normal_png, transform);
                }
                notes.extend(reason.map(|reason| format!("{reason}; that map is a separate file")));
                maps.push(DetailMap {
                    material: name.map(str::to_owned),
                    normal_png,
                    height_png,
                    height_range_m,
                    crease_png,
                    in_material,
                    mean_tilt_deg: (tilts / painted.filled as f64).to_degrees(),
                    conflicting_fraction,
                });
            }
        }
        Ok(maps)
    }

    /// Paints `users` into one map, or each into a map of its own if they contradict each other in one.
    fn paint(&self, users: Vec<usize>, transform: TextureTransform) -> Vec<Painted> {
        let paint = |surfaces: Vec<usize>| {
            let texels = self.painter.paint(&surfaces, transform, self.options.side);
            let filled = texels.filled_count();
            Painted { surfaces, texels, filled }
        };
        let together = paint(users.clone());
        if together.is_consistent() || users.len() < 2 {
            return vec![together];
        }
        let apart: Vec<Painted> = users.into_iter().map(|user| paint(vec![user])).collect();
        if apart.iter().all(Painted::is_consistent) { apart } else { vec![together] }
    }
}

/// Reads the worn file again; its worn vertices are those of the garment.
pub(super) fn read_back(glb: &[u8], asset: &SourceAsset, detail: &DetailInput) -> Result<SourceAsset> {
    // The worn file of an OBJ is in metres, y up; that of a glTF in the unit of its source.
    let is_gltf = asset.document.is_some();
    let options = ReadOptions {
        unit_m: Some(if is_gltf { asset.unit_m } else { 1.0 }),
        up: is_gltf.then_some(asset.up),
        any_size: true,
        skip_damaged: true,
        ..ReadOptions::default()
    };
    let mut nothing = |name: &str| Err(Error::input(&asset.file, name, "is an external file", ""));
    let (mut worn, _) = read_asset(&asset.file, glb, &options, &mut nothing)?;
    keep_worn_pieces(&mut worn);
    let count: usize = worn.worn_pieces().map(|piece| piece.positions.len()).sum();
    let fits =
        count == detail.coarse.source_point.len() && detail.coarse.points.len() <= detail.displacement.len();
    match fits {
        true => Ok(worn),
        false => {
            let message = "the worn file and the garment are not of one mesh";
            Err(Error::input(&asset.file, "worn surface", message, "use what was made of this file"))
        }
    }
}
