//! A garment to be looked at, read from any mesh file, with the sidecar beside it.

use crate::files::input;
use crease::internal::files::{read_asset_file, sidecar_path};
use crease::internal::report::GarmentView;
use crease_io::gltf::{keep_worn_pieces, sidecar_name};
use crease_io::{ReadOptions, Sidecar, read_sidecar};
use crease_model::error::{Error, Result};
use crease_model::garment::SourceAsset;
use std::path::Path;

/// A garment to be drawn.
#[derive(Debug)]
pub struct ViewFile {
    /// Shapes and memory of the garment.
    pub view: GarmentView,
    /// Sidecar, where the file names one that exists.
    #[cfg_attr(not(feature = "viewer"), allow(dead_code, reason = "only the viewer page needs it"))]
    pub sidecar: Option<Sidecar>,
    /// Content of the file.
    #[cfg_attr(not(feature = "viewer"), allow(dead_code, reason = "only the viewer page needs it"))]
    pub asset: SourceAsset,
}

impl ViewFile {
    /// Reads `path`, which may refer to files in its folder and in `allow_folder`. Memory comes from the sidecar if there is one, otherwise from the attributes of the file.
    pub fn read(path: &Path, allow_folder: Option<&Path>) -> Result<Self> {
        let allow_folder = allow_folder.map(Path::to_owned);
        // A garment that is only drawn may have any size.
        let options =
            ReadOptions { any_size: true, skip_damaged: true, allow_folder, ..ReadOptions::default() };
        let (mut asset, _) = read_asset_file(path, &options)?;
        let sidecar = asset.document.as_ref().and_then(sidecar_name).map(|name| sidecar_path(path, name));
        let sidecar = sidecar.transpose()?;
        let Some(sidecar) = sidecar.filter(|path| path.is_file()) else {
            return Ok(Self { view: GarmentView::of_asset(&mut asset)?, sidecar: None, asset });
        };
        let file = input::name_of(&sidecar);
        let sidecar = read_sidecar(&file, &input::bytes(&sidecar)?)?;
        keep_worn_pieces(&mut asset);
        if let Some(message) = sidecar.mesh_mismatch(&asset) {
            let help = format!("put the sidecar that was written with {} beside it", path.display());
            return Err(Error::input(file, "mesh", message, help));
        }
        let view = GarmentView::of_sidecar(&input::name_of(path), &sidecar);
        Ok(Self { view, sidecar: Some(sidecar), asset })
    }
}
