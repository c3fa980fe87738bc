//! Bytes <-> nouns: OBJ, glTF, sidecar, landmarks. No paths, no file system; every attribute name once.

mod asset;
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

pub use asset::{GltfDocument, Placement, SourceAsset, SourceFormat, SourceJoint, SourcePiece, UpAxis};
pub use body::sequence;
pub use checksum::SidecarChecksums;
pub use frames::frame_obj;
pub use landmarks::{Landmark, Landmarks};
pub use read::{ReadOptions, read_asset};
pub use shape_obj::{read_shape_obj, shape_obj};
pub use sidecar::{
    SIDECAR_FORMAT, Sidecar, SidecarHinges, SidecarJoint, SidecarMesh, SidecarPoints, SidecarSource,
    SidecarTriangles, SidecarUp, read_sidecar, write_sidecar,
};
pub use usda::{UsdaMemory, read_usda, usda, wrapped_deg};
