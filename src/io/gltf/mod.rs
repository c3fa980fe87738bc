//! glTF 2.0, as .gltf and .glb. The document is kept as raw JSON, because unknown content must be written again
//! unchanged; the typed `gltf` crate drops it and rejects valid files, so it serves only to write the container and as
//! oracle in tests.

mod accessor;
mod add_morph_target;
mod animated_weights;
mod append;
mod apply_worn;
mod buffers;
mod container;
mod contents;
mod detail;
mod embed;
mod fine;
mod flat_shading;
mod json_cursor;
mod meshopt;
mod morph;
mod names;
mod obj_to_gltf;
mod piece_reader;
mod primitive;
mod read;
#[cfg(test)]
mod read_tests;
mod read_worn;
mod rest_angle_map;
mod rig;
mod scene;
mod shared_meshes;
mod skin;
mod smooth_shading;
mod sound_normals;
mod worn_target;
mod write;

pub use accessor::{Accessors, Table};
pub use apply_worn::{SourceShape, apply_worn};
pub use container::{is_glb, join_glb, split_glb};
pub use contents::file_contents;
pub use detail::{
    DETAIL_MAP_SIZES, DetailInput, DetailMap, DetailOf, DetailOutput, MapDepth, MapOptions, add_detail_map,
};
pub use embed::{embed_images, image_bytes};
pub use fine::{FINE_EDGE, FineOutput, write_fine_glb};
pub use flat_shading::FlatNormals;
pub use names::{
    FORMER_REST_ANGLE_ATTRIBUTE, REST_ANGLE_CHANGE_ATTRIBUTE, REST_ANGLE_DEG_ATTRIBUTE, STIFFNESS_ATTRIBUTE,
    UNWORN_TARGET, WORN_TARGET, WRINKLES_NAME,
};
pub(crate) use read::read_gltf;
pub(crate) use read_worn::earlier_wear_note;
pub use read_worn::{
    EarlierWear, WornVertices, earlier_wear, has_worn_target, keep_worn_pieces, read_worn, sidecar_name,
};
pub use rest_angle_map::write_rest_angle_map;
pub use rig::read_rig;
pub(crate) use write::{SceneShape, scene_shapes};
pub use write::{plain_glb, write_worn_glb, write_worn_glb_with};
