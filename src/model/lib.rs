//! The data that a bake works on, without physics: located errors (`error`), JSON that people write (`json`), fabrics
//! (`fabric`), garments and their rest state (`garment`), animated bodies (`body`), and the meshes that are simulated in a
//! garment's place (`remesh`).
//!
//! A crate of the workspace of `crease`; its interface follows the needs of that library.

pub mod body;
pub mod error;
pub mod fabric;
pub mod garment;
pub mod json;
pub mod printable;
pub mod remesh;
