//! Bytes <-> nouns: OBJ, glTF, sidecar. No paths, no file system; every attribute name once.

mod asset;
mod fault_list;
pub mod gltf;
mod obj;
mod read;

pub use asset::{GltfDocument, Placement, SourceAsset, SourceFormat, SourcePiece, UpAxis};
pub use read::{ReadOptions, read_asset};
