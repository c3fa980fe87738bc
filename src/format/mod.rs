//! Bytes <-> nouns: OBJ, glTF, sidecar. No paths, no file system; every attribute name once.

mod asset;
pub mod gltf;

pub use asset::{GltfDocument, Placement, SourceAsset, SourceFormat, SourcePiece, UpAxis};
