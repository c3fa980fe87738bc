//! The commands: one file each, from arguments over options and a library call to files.

pub mod bake;
pub mod batch;
#[cfg(feature = "charts")]
pub mod chart;
pub mod completions;
pub mod fabric;
pub mod inspect;
pub mod remember;
pub mod render;
pub mod schema;
pub mod transfer;
#[cfg(feature = "viewer")]
pub mod view;
