//! glTF 2.0, as .gltf and .glb. The document is kept as raw JSON, because what a file holds beyond what we know must
//! come out again untouched; the typed `gltf` crate drops it and refuses legal files, so it serves as writer of the
//! container and as oracle in tests.

mod accessor;
mod add_morph_target;
mod animated_weights;
mod append;
mod buffers;
mod container;
mod detail;
mod embed;
mod json_cursor;
mod obj_to_gltf;
mod primitive;
mod read;
mod read_worn;
mod rest_angle_map;
mod rig;
mod scene;
mod skin;
mod worn_target;
mod write;

pub use accessor::{Accessors, Table};
pub use container::{is_glb, join_glb, split_glb};
pub use detail::{DETAIL_MAP_SIZES, DetailInput, DetailMap, DetailOutput, add_detail_map};
pub use embed::embed_images;
pub(in crate::io) use read::read_gltf;
pub use read_worn::{WornVertices, keep_worn_pieces, read_worn, sidecar_name};
pub use rest_angle_map::{REST_ANGLE_DEG_ATTRIBUTE, rest_angle_per_point, write_rest_angle_map};
pub use rig::read_rig;
pub use write::{external_images, write_worn_glb};

/// Name of the morph target that holds the worn shape.
pub const WORN_TARGET: &str = "worn";
/// Vertex attribute: change of rest angle (rest minus source angle) of largest magnitude among the hinges whose edge
/// ends at the vertex, in degrees, signed; 0 where nothing is remembered.
pub const REST_ANGLE_CHANGE_ATTRIBUTE: &str = "_CREASE_REST_ANGLE_CHANGE";
/// Name of [`REST_ANGLE_CHANGE_ATTRIBUTE`] in files written by earlier versions; read, never written.
pub const FORMER_REST_ANGLE_ATTRIBUTE: &str = "_CREASE_REST_ANGLE";
/// Vertex attribute: mean stiffness ratio of the hinges whose edge ends at the vertex [-]; 1 where there is none.
pub const STIFFNESS_ATTRIBUTE: &str = "_CREASE_STIFFNESS";
