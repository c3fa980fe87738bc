//! Bytes <-> nouns: OBJ, glTF, sidecar, landmarks. No paths, no file system; every attribute name once.

mod asset;
mod checksum;
mod fault_list;
mod frames;
pub mod gltf;
mod landmarks;
mod obj;
mod read;
mod shape_obj;
mod sidecar;
mod usda;
mod wearer;

pub use asset::{GltfDocument, Placement, SourceAsset, SourceFormat, SourceJoint, SourcePiece, UpAxis};
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
pub use wearer::sequence;
