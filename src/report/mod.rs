//! (see lib.rs)
pub mod render;
