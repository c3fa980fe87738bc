//! glTF 2.0, as .gltf and .glb. The document is kept as raw JSON, because what a file holds beyond what we know must
//! come out again untouched; the typed `gltf` crate drops it and refuses legal files, so it serves as writer of the
//! container and as oracle in tests.

mod accessor;
mod buffers;
mod container;
mod cursor;
mod primitive;
mod read;
mod scene;
mod skin;

pub use accessor::{Accessors, Table};
pub use container::{is_glb, join_glb, split_glb};
pub(in crate::format) use read::read_gltf;
