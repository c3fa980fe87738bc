//! `--apply`: the worn shape as the base shape of OUT.glb.

use crease_io::gltf::{FlatNormals, SourceShape, apply_worn};
use crease_model::error::Result;

/// Shape and normals of OUT.glb.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct ApplyArgs {
    /// Make the worn shape the base shape of OUT.glb, for programs that do not read default morph weights; the source shape
    /// becomes the morph target `unworn`
    #[arg(long)]
    apply: bool,
    /// Leave the morph target `unworn` out
    #[arg(long, requires = "apply")]
    no_unworn: bool,
    /// Rotate the normals of flat-shaded vertices with the wear instead of making them smooth
    #[arg(long)]
    keep_normals: bool,
}

impl ApplyArgs {
    /// Treatment of flat-shaded vertices.
    pub fn flat_normals(&self) -> FlatNormals {
        if self.keep_normals { FlatNormals::Kept } else { FlatNormals::Smoothed }
    }

    /// Applies the worn shape of `glb` if that was asked for.
    pub fn applied(&self, file: &str, glb: Vec<u8>) -> Result<Vec<u8>> {
        let source = if self.no_unworn { SourceShape::Dropped } else { SourceShape::Target };
        if self.apply { apply_worn(file, &glb, source) } else { Ok(glb) }
    }
}
