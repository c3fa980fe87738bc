//! Groups of command-line arguments that several commands share.

pub mod body;
pub mod common;
pub mod export;
pub mod refine;
