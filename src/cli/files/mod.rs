//! Reading and writing files: inputs with their names in messages, outputs written whole or not at all.

pub mod input;
pub mod output;
pub mod view_file;
