//! Files by path: loading garments, scripts, fabrics, bodies and sidecars, saving results, and writing outputs whole or not at all.
//!
//! The only module of the library that opens files; everything below it maps bytes to values. A program that keeps its data
//! elsewhere calls `parse` of the same types, [`crease_io::read_asset`] and [`crease_io::gltf::write_worn_glb`].

mod by_name;
mod checkpoint_file;
mod example_list;
mod format;
mod frame_folder;
mod frame_sequence;
mod garment_file;
mod load;
mod memory;
mod output;
mod read;
mod ready_memory;
mod reference;
mod run_lock;

pub use by_name::{read_fabric, read_script};
pub use checkpoint_file::{CheckpointFile, SavedCheckpoint};
pub use example_list::{HANDKERCHIEF, SLEEVE, TSHIRT, TSHIRT_DRAFT};
pub use format::{format_with_frame, is_gltf};
pub use frame_folder::FrameFolder;
pub use frame_sequence::{frame_paths, read_frames};
pub use garment_file::{GarmentFile, embed_asset_images, read_asset_file, referenced_files};
pub use load::{Load, Save, load_body};
pub use memory::{memory_of_earlier_run, transfer_source};
pub use output::{Outputs, is_stream, output_name};
pub use read::{STANDARD_STREAM, file_name, folder_of, merge_errors, read_bytes, read_text};
pub use ready_memory::{ready_memory, ready_memory_names};
pub use reference::{ReferenceFolders, sidecar_path};
pub use run_lock::RunLock;
