//! The commands, one file or folder each: from arguments to options, a library call, and files.

pub mod apply;
pub mod bake;
pub mod batch;
#[cfg(feature = "charts")]
pub mod chart;
pub mod completions;
pub mod example;
pub mod fabric;
pub mod from_motion;
pub mod inspect;
mod reference;
pub mod render;
pub mod schema;
pub mod transfer;
#[cfg(feature = "viewer")]
pub mod view;
mod worn_job;
