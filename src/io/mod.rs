//! Bytes <-> nouns: OBJ, glTF, sidecar, landmarks. No paths, no file system; every attribute name once.

mod body;
mod checksum;
mod diagnostics;
mod frames;
pub mod gltf;
mod landmarks;
mod obj;
mod read;
mod shape_obj;
mod sidecar;
mod usda;

pub use body::sequence_from_assets;
pub use checksum::SidecarChecksums;
pub use frames::write_frame_obj;
pub use landmarks::{Landmark, Landmarks};
pub use read::{ReadOptions, read_asset};
pub use shape_obj::{read_shape_obj, write_shape_obj};
pub use sidecar::{
    SIDECAR_FORMAT, Sidecar, SidecarHinges, SidecarJoint, SidecarMesh, SidecarPoints, SidecarSource,
    SidecarTriangles, SidecarUp, read_sidecar, write_sidecar,
};
pub use usda::{UsdaMemory, read_usda, wrapped_deg, write_usda};
