//! Readers and writers of files: OBJ, glTF, USD, sidecar, landmarks.
//!
//! Converts between bytes and the types of `garment` and `body`. Knows no paths and no file system: the tool opens files.

mod body;
mod choose_worn;
mod corners;
mod error_list;
mod frames;
mod garment_skin;
pub mod gltf;
mod landmarks;
mod obj;
mod pieces;
mod polygon;
mod read;
mod shape_obj;
mod sidecar;
mod size;
mod tuning;
mod usd;

pub use body::{read_body, read_body_frames, sequence_from_assets};
pub use frames::write_frame_obj;
pub use garment_skin::read_garment_skin;
pub use landmarks::{Landmark, Landmarks};
pub use read::{ReadOptions, Resolve, read_asset, read_asset_with};
pub use shape_obj::{FrameRow, FrameRows, read_shape_obj, write_shape_obj};
pub use sidecar::{
    SIDECAR_FORMAT, Sidecar, SidecarChecksums, SidecarCrease, SidecarHinges, SidecarJoint, SidecarMesh,
    SidecarPoints, SidecarSource, SidecarTriangles, SidecarUp, read_sidecar, sidecar_surface, write_sidecar,
    write_sidecar_to,
};
pub use size::{check_size, compare_body_size, compare_frame_size, unit_length};
pub use usd::FILE_EXTENSIONS as USD_EXTENSIONS;
pub use usd::{
    UsdFrames, UsdScene, UsdShape, UsdTexture, UsdaMemory, is_usd, read_usda, usd_textures, wrapped_deg,
    write_usda,
};
