//! Reading and writing files: inputs with their names in messages, outputs written whole or not at all.

pub mod checkpoints;
pub mod earlier_memory;
pub mod frame_folder;
pub mod frame_sequence;
pub mod input;
pub mod output;
pub mod source;
pub mod view_file;
pub mod wear;
pub mod worn_outputs;
