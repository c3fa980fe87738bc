//! Materials of a detail map: the normal map that is there already, the transform of texture coordinates, and the
//! reference to the new map in every material that draws the garment, those of `KHR_materials_variants` too.

use crate::gltf::append::Appender;
use crate::gltf::detail::references::{VARIANTS, index_of, variant_mappings};
use crate::gltf::detail::surface::{ShownSurface, unit_or};
use crate::gltf::detail::texels::Texels;
use crate::gltf::embed::image_bytes;
use crate::gltf::names::WRINKLES_NAME;
use crate::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_model::garment::GltfDocument;
use serde_json::{Value, json};

/// Extension that moves and scales texture coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// Map from the texture coordinates of a mesh to those of a picture: scaled, then shifted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TextureTransform {
    scale: Vec2,
    offset: Vec2,
}

impl TextureTransform {
    const IDENTITY: Self = Self { scale: Vec2::new(1.0, 1.0), offset: Vec2::new(0.0, 0.0) };

    /// The transform that a reference to a texture states; fails with the reason if it is not of this form.
    fn stated(reference: &Value) -> Result<Self, String> {
        let Some(stated) = reference["extensions"].get(TRANSFORM) else { return Ok(Self::IDENTITY) };
        if stated["rotation"].as_f64().unwrap_or(0.0) != 0.0 {
            return Err(format!("it is rotated ({TRANSFORM})"));
        }
        if stated["texCoord"].as_u64().unwrap_or(0) != 0 {
            return Err("it uses other texture coordinates".into());
        }
        let pair = |name: &str, default: f64| {
            let number = |k: usize| stated[name][k].as_f64().filter(|x| x.is_finite()).unwrap_or(default);
            Vec2::new(number(0), number(1))
        };
        Ok(Self { scale: pair("scale", 1.0), offset: pair("offset", 0.0) })
    }

    /// The transform under which the texture coordinates of `surfaces` fill one picture of `side` texels: the identity if they
    /// lie in a square of one picture's size and fill a good part of it. Otherwise they repeat the picture, lie in several
    /// tiles, or in a small corner, as quantised ones do.
    pub(super) fn fitting<'a>(surfaces: impl Iterator<Item = &'a ShownSurface<'a>>, side: usize) -> Self {
        let used =
            surfaces.flat_map(|s| s.piece.triangles.iter().flatten().filter_map(|&v| s.uvs.get(v as usize)));
        let bounds = used.filter(|uv| uv.iter().all(|x| x.is_finite())).fold(None, |bounds, uv| {
            Some(bounds.map_or((*uv, *uv), |(low, high): (Vec2, Vec2)| (low.inf(uv), high.sup(uv))))
        });
        let Some((low, high)) = bounds else { return Self::IDENTITY };
        let size = high - low;
        let fits = size.max() <= 1.0 + TUNING.uv_border_tol && size.max() >= TUNING.min_uv_extent;
        if fits || size.max() <= 0.0 {
            return Self::IDENTITY;
        }
        // Half a texel stays free at the borders, so that opposite ones do not mix. Small axes are enlarged together.
        let room = 1.0 - 1.0 / side as f64;
        let scale = match size.max() > 1.0 {
            true => size.map(|size| if size > 1.0 { room / size } else { room }),
            false => Vec2::repeat(room / size.max()),
        };
        let offset = Vec2::repeat(0.5) - (low + high).component_mul(&scale) * 0.5;
        Self { scale, offset }
    }

    /// The position of `uv` in the picture.
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        uv.component_mul(&self.scale) + self.offset
    }

    /// Description for a note; `None` for the identity.
    pub(super) fn note(&self) -> Option<String> {
        (*self != Self::IDENTITY).then(|| {
            format!(
                "its texture coordinates do not fit one picture: the normal map of the wrinkles takes them all, by \
                 {TRANSFORM} (scale {:.4}, {:.4})",
                self.scale.x, self.scale.y
            )
        })
    }
}

/// Normal map that a material has already.
pub(super) struct OwnNormalMap {
    pub(super) texels: Texels,
    /// Factor on x and y of its directions.
    pub(super) scale: f64,
    pub(super) transform: TextureTransform,
}

/// Reads the existing normal map of a material; fails with the reason if it cannot be combined.
pub(super) fn own_normal_map(
    document: &GltfDocument,
    material: Option<usize>,
) -> Result<Option<OwnNormalMap>, String> {
    let Some(entry) = material.and_then(|m| document.json["materials"][m].get("normalTexture")) else {
        return Ok(None);
    };
    if entry["texCoord"].as_u64().unwrap_or(0) != 0 {
        return Err("it uses other texture coordinates".into());
    }
    let transform = TextureTransform::stated(entry)?;
    let missing = "its picture is not in the file";
    let texture = index_of(&entry["index"]).ok_or(missing)?;
    let image = index_of(&document.json["textures"][texture]["source"]).ok_or(missing)?;
    let bytes = image_bytes(document, image).ok_or(missing)?;
    let texels = Texels::from_png(&bytes).map_err(|reason| format!("only PNG can be combined ({reason})"))?;
    Ok(Some(OwnNormalMap { texels, scale: entry["scale"].as_f64().unwrap_or(1.0), transform }))
}

/// Rotates the directions of the material's own map with the fine surface.
pub(super) fn rotate_with_surface(texels: &mut Texels, own: &OwnNormalMap) {
    let (width, height) = (texels.width, texels.height);
    for (at, fine) in texels.direction.iter_mut().enumerate().filter(|(_, d)| **d != Vec3::zeros()) {
        let uv = Vec2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
        let weave = own.texels.sample(uv.component_div(&Vec2::new(width as f64, height as f64)));
        let weave = Vec3::new(weave.x * own.scale, weave.y * own.scale, weave.z);
        let along = unit_or(Vec3::x() - *fine * fine.x, Vec3::x());
        let rotated = along * weave.x + fine.cross(&along) * weave.y + *fine * weave.z;
        *fine = unit_or(rotated, *fine);
    }
}

/// Writer of normal maps into a document. Equal pictures are stored once.
#[derive(Default)]
pub(super) struct NormalTextures {
    /// Pictures with their textures.
    stored: Vec<(Vec<u8>, usize)>,
}

impl NormalTextures {
    /// Sets `png` as the normal texture of `material` in the primitives of `painted`. A material that other primitives use
    /// too is copied first.
    pub(super) fn set(
        &mut self,
        appender: &mut Appender,
        material: Option<usize>,
        painted: &[&ShownSurface],
        png: &[u8],
        transform: TextureTransform,
    ) {
        let texture = self.texture(appender, png);
        let mut reference = json!({"index": texture});
        if transform != TextureTransform::IDENTITY {
            let pair = |v: Vec2| json!([v.x, v.y]);
            reference["extensions"] =
                json!({TRANSFORM: {"offset": pair(transform.offset), "scale": pair(transform.scale)}});
            appender.use_extension(TRANSFORM);
        }
        let uses = |primitive: &Value| {
            index_of(&primitive["material"]) == material
                || material.is_some()
                    && variant_mappings(primitive).any(|m| index_of(&m["material"]) == material)
        };
        let is_painted = |mesh: usize, primitive: usize| {
            painted.iter().any(|s| (s.piece.mesh, s.piece.primitive) == (mesh, primitive))
        };
        let mut shared = material.is_none();
        for (m, mesh) in appender.list("meshes").iter().enumerate() {
            let primitives = mesh["primitives"].as_array().into_iter().flatten().enumerate();
            shared |= primitives.into_iter().any(|(p, primitive)| uses(primitive) && !is_painted(m, p));
        }
        let mut entry =
            material.and_then(|m| appender.list("materials").get(m).cloned()).unwrap_or_else(|| json!({}));
        entry["normalTexture"] = reference;
        if let Some(m) = material.filter(|_| !shared) {
            appender.list("materials")[m] = entry;
            return;
        }
        let copy = appender.push("materials", entry);
        for surface in painted {
            let Some(mesh) = appender.list("meshes").get_mut(surface.piece.mesh) else { continue };
            let primitive = &mut mesh["primitives"][surface.piece.primitive];
            if index_of(&primitive["material"]) == material {
                primitive["material"] = json!(copy);
            }
            let mappings = primitive.pointer_mut(&format!("/extensions/{VARIANTS}/mappings"));
            for mapping in mappings.and_then(Value::as_array_mut).into_iter().flatten() {
                if material.is_some() && index_of(&mapping["material"]) == material {
                    mapping["material"] = json!(copy);
                }
            }
        }
    }

    fn texture(&mut self, appender: &mut Appender, png: &[u8]) -> usize {
        if let Some((_, texture)) = self.stored.iter().find(|(stored, _)| stored == png) {
            return *texture;
        }
        let view = appender.bytes(png.to_vec());
        let image = appender
            .push("images", json!({"bufferView": view, "mimeType": "image/png", "name": WRINKLES_NAME}));
        let texture = appender.push("textures", json!({"source": image, "name": WRINKLES_NAME}));
        self.stored.push((png.to_vec(), texture));
        texture
    }
}
