//! The memory of a sidecar as a transfer takes it.

use crate::transfer::{TransferSource, earlier_memory};
use crease_io::{Sidecar, sidecar_surface};
use crease_model::error::Result;
use crease_model::garment::{Garment, RestState, SourceAsset};

/// The surface, memory and joints of `sidecar`; `file` is its name in messages.
///
/// # Errors
/// [`crease_model::error::Error::Input`] if a triangle is degenerate or the hinges are not those of the triangles.
pub fn transfer_source(file: &str, sidecar: &Sidecar) -> Result<TransferSource> {
    let (surface, memory) = sidecar_surface(file, sidecar)?;
    let simulated = sidecar.simulated.as_deref().map(|own| sidecar_surface(file, own));
    let simulated = simulated.transpose()?;
    Ok(TransferSource { file: file.to_owned(), surface, memory, joints: sidecar.joints(), simulated })
}

/// Returns the memory in `sidecar` (`file` is its name in messages) on `garment`, which was built from `asset`: the file that was
/// written with it. `None` if the sidecar is of another mesh, or of an edited one.
///
/// # Errors
/// Those of [`transfer_source`].
pub fn memory_of_earlier_run(
    file: &str,
    sidecar: &Sidecar,
    garment: &Garment,
    asset: &SourceAsset,
) -> Result<Option<RestState>> {
    if sidecar.mesh_mismatch(asset).is_some() {
        return Ok(None);
    }
    let source = transfer_source(file, sidecar)?;
    earlier_memory(source, &sidecar.mesh.source_point, garment, asset).map(Some)
}
