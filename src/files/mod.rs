//! Files by path: loading garments, scripts, fabrics, bodies and sidecars, and saving results.
//!
//! The only module of the library that opens files; everything below it maps bytes to values. A program that keeps its data
//! elsewhere calls `parse` of the same types, [`crease_io::read_asset`] and [`crease_io::gltf::write_worn_glb`].

mod example_list;
mod garment_file;
mod load;
mod memory;
mod read;
mod ready_memory;

pub use example_list::{HANDKERCHIEF, SLEEVE, TSHIRT, TSHIRT_DRAFT};
pub use garment_file::{GarmentFile, embed_asset_images, read_asset_file};
pub use load::{Load, Save, load_body};
pub use memory::{memory_of_earlier_run, transfer_source};
pub use read::{STANDARD_STREAM, file_name, read_bytes, read_text};
pub use ready_memory::{ready_memory, ready_memory_names};
