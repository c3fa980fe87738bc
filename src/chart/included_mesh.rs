//! Meshes of the repository that charts bake, compiled in.

use crease::internal::files;
use crease_io::{ReadOptions, read_asset, read_body};
use crease_model::body::AnimatedBody;
use crease_model::error::{Error, Result};
use crease_model::garment::{Garment, SourceAsset, SourcePiece};
use std::sync::Arc;

/// A mesh of the repository, compiled in.
pub(super) struct IncludedMesh {
    /// File name.
    pub(super) file: &'static str,
    /// Its content.
    pub(super) bytes: &'static [u8],
}

pub(super) const TSHIRT_DRAFT: IncludedMesh =
    IncludedMesh { file: "tshirt-draft.glb", bytes: files::TSHIRT_DRAFT };
pub(super) const TSHIRT: IncludedMesh = IncludedMesh { file: "tshirt.glb", bytes: files::TSHIRT };
pub(super) const HANDKERCHIEF: IncludedMesh =
    IncludedMesh { file: "handkerchief.glb", bytes: files::HANDKERCHIEF };
const SLEEVE: IncludedMesh = IncludedMesh { file: "sleeve.glb", bytes: files::SLEEVE };

impl IncludedMesh {
    /// Reads the mesh.
    ///
    /// # Errors
    /// None in practice: the included meshes are valid and complete.
    fn read(&self, options: &ReadOptions) -> Result<SourceAsset> {
        let refuse = |name: &str| Err(Error::input(self.file, name, "refers to another file", ""));
        Ok(read_asset(self.file, self.bytes, options, &mut |name| refuse(name))?.0)
    }

    /// Reads the mesh as a garment.
    pub(super) fn garment(&self) -> Result<Garment> {
        Ok(Garment::from_asset(&self.read(&ReadOptions::default())?)?.0)
    }
}

/// The sleeve and the arm that wears it.
pub(super) fn sleeve_on_arm() -> Result<(Garment, Arc<AnimatedBody>)> {
    let asset = SLEEVE.read(&ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() })?;
    let arm: Vec<&SourcePiece> = asset.pieces.iter().filter(|piece| !piece.worn).collect();
    Ok((Garment::from_asset(&asset)?.0, Arc::new(read_body(&asset, &arm)?)))
}
