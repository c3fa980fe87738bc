//! Textures of the materials of a glTF file as USD reads them: pictures beside the scene, and the shaders that read them.
//!
//! Base colour with its factor and transparency, and the normal map; PNG and JPEG by the first texture coordinates. Textures that are
//! transformed, of other formats or by other coordinates are left out, and the factor of the base colour counts alone.

use crate::gltf::image_bytes;
use crate::usd::prim::Prim;
use crease_model::garment::{GltfDocument, SourceAsset, SourcePiece};
use serde_json::Value;

/// Picture that a scene refers to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsdTexture {
    /// End of the name of its file, after the name of the scene: `texture-0.png`.
    pub ending: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// Number of the image in the document.
    image: usize,
}

/// Use of a texture in a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TextureUse {
    BaseColour,
    Normal,
}

/// Returns the pictures of the materials of the worn pieces of `asset`.
pub fn usd_textures(asset: &SourceAsset) -> Vec<UsdTexture> {
    let Some(document) = &asset.document else { return Vec::new() };
    let mut textures: Vec<UsdTexture> = Vec::new();
    for piece in asset.worn_pieces().filter(|piece| piece.uvs.is_some()) {
        let Some(material) = material_of(document, piece) else { continue };
        for usage in [TextureUse::BaseColour, TextureUse::Normal] {
            let Some((image, _)) = image_of(document, material, usage) else { continue };
            if textures.iter().any(|known| known.image == image) {
                continue;
            }
            let Some(bytes) = image_bytes(document, image) else { continue };
            let kind = match bytes.as_slice() {
                [0x89, b'P', b'N', b'G', ..] => "png",
                [0xFF, 0xD8, 0xFF, ..] => "jpg",
                _ => continue,
            };
            textures.push(UsdTexture { ending: format!("texture-{image}.{kind}"), bytes, image });
        }
    }
    textures
}

/// Returns the material of a piece.
pub(super) fn material_of<'a>(document: &'a GltfDocument, piece: &SourcePiece) -> Option<&'a Value> {
    let primitive = &document.json["meshes"][piece.mesh]["primitives"][piece.primitive];
    let number = usize::try_from(primitive["material"].as_u64()?).ok()?;
    document.json["materials"].get(number)
}

/// Returns the image of a texture of `material`, and its sampler; `None` for one that USD would show elsewhere or not at all.
fn image_of<'a>(
    document: &'a GltfDocument,
    material: &'a Value,
    usage: TextureUse,
) -> Option<(usize, &'a Value)> {
    let info = match usage {
        TextureUse::BaseColour => &material["pbrMetallicRoughness"]["baseColorTexture"],
        TextureUse::Normal => &material["normalTexture"],
    };
    let is_plain = info["texCoord"].as_u64().unwrap_or(0) == 0
        && info["extensions"].get("KHR_texture_transform").is_none();
    let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok());
    let texture = document.json["textures"].get(number(&info["index"]).filter(|_| is_plain)?)?;
    let image = number(&texture["source"])?;
    let sampler = number(&texture["sampler"]).map_or(&Value::Null, |k| &document.json["samplers"][k]);
    Some((image, sampler))
}

/// Shaders of the textures of a surface, and the inputs of its `UsdPreviewSurface` that they feed.
#[derive(Debug, Default)]
pub(super) struct SurfaceTextures {
    /// Shader prims.
    pub shaders: Vec<Prim>,
    /// Lines of inputs.
    pub inputs: Vec<String>,
}

impl SurfaceTextures {
    /// Makes the shaders of `material`, whose prim is `path`. `scene` is the name of the scene's file without its ending; `textures`
    /// are those of the file. `factor` is the factor of the base colour.
    pub fn new(
        document: &GltfDocument,
        material: &Value,
        path: &str,
        scene: &str,
        textures: &[UsdTexture],
        factor: [f64; 4],
    ) -> Self {
        let mut all = Self::default();
        let file = |image: usize| textures.iter().find(|texture| texture.image == image).map(|t| &t.ending);
        let shader = |name: &str, ending: &str, sampler: &Value, colour_space: &str| {
            let wrap = |key: &str| match sampler[key].as_u64() {
                Some(33_071) => "clamp",
                Some(33_648) => "mirror",
                _ => "repeat",
            };
            Prim::new("Shader", name)
                .line("uniform token info:id = \"UsdUVTexture\"".into())
                .line(format!("asset inputs:file = @./{scene}.{ending}@"))
                .line(format!("token inputs:sourceColorSpace = \"{colour_space}\""))
                .line(format!("float2 inputs:st.connect = <{path}/Coordinates.outputs:result>"))
                .line(format!("token inputs:wrapS = \"{}\"", wrap("wrapS")))
                .line(format!("token inputs:wrapT = \"{}\"", wrap("wrapT")))
        };
        if let Some((image, sampler)) = image_of(document, material, TextureUse::BaseColour)
            && let Some(ending) = file(image)
        {
            let [r, g, b, a] = factor;
            let colour = shader("BaseColour", ending, sampler, "sRGB")
                .line(format!("float4 inputs:scale = ({r}, {g}, {b}, {a})"))
                .line("float outputs:a".into())
                .line("float3 outputs:rgb".into());
            all.shaders.push(colour);
            all.inputs.push(format!("color3f inputs:diffuseColor.connect = <{path}/BaseColour.outputs:rgb>"));
            let mode = material["alphaMode"].as_str().unwrap_or("OPAQUE");
            if mode != "OPAQUE" {
                all.inputs.push(format!("float inputs:opacity.connect = <{path}/BaseColour.outputs:a>"));
            }
            if mode == "MASK" {
                let cutoff = material["alphaCutoff"].as_f64().unwrap_or(0.5);
                all.inputs.push(format!("float inputs:opacityThreshold = {cutoff}"));
            }
        }
        if let Some((image, sampler)) = image_of(document, material, TextureUse::Normal)
            && let Some(ending) = file(image)
        {
            // The only scale that `UsdPreviewSurface` allows for 8 bits: that of glTF's `normalTexture` has no place.
            let normal = shader("NormalMap", ending, sampler, "raw")
                .line("float4 inputs:scale = (2, 2, 2, 1)".into())
                .line("float4 inputs:bias = (-1, -1, -1, 0)".into())
                .line("float3 outputs:rgb".into());
            all.shaders.push(normal);
            all.inputs.push(format!("normal3f inputs:normal.connect = <{path}/NormalMap.outputs:rgb>"));
        }
        if !all.shaders.is_empty() {
            let reader = Prim::new("Shader", "Coordinates")
                .line("uniform token info:id = \"UsdPrimvarReader_float2\"".into())
                .line("string inputs:varname = \"st\"".into())
                .line("float2 outputs:result".into());
            all.shaders.push(reader);
        }
        all
    }

    /// Whether an input called `name` is fed by a texture.
    pub fn has(&self, name: &str) -> bool {
        self.inputs.iter().any(|line| line.contains(&format!("inputs:{name}.connect")))
    }
}
