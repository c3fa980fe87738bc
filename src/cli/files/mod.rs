//! Reading and writing files: inputs with their names in messages, outputs written whole or not at all.

pub mod checkpoints;
pub mod frames;
pub mod input;
pub mod mesh_file;
pub mod output;
