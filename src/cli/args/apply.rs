//! `--apply`: the worn shape as the base shape of OUT.glb.

use crease::internal::job::ShapeOptions;
use crease_io::gltf::{FlatNormals, SourceShape};

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
    /// Returns the options of OUT.glb.
    pub fn shape(self) -> ShapeOptions {
        let source = if self.no_unworn { SourceShape::Dropped } else { SourceShape::Target };
        let flat_normals = if self.keep_normals { FlatNormals::Kept } else { FlatNormals::Smoothed };
        ShapeOptions { apply: self.apply.then_some(source), flat_normals }
    }
}
