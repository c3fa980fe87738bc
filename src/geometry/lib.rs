//! Triangle meshes of cloth and what is asked of them, without physics: vectors and random numbers (`math`), topology, hinge
//! angles, distances, exact intersections, continuous collision detection and bounding-volume trees (`mesh`).
//!
//! A crate of the workspace of `crease`; its interface follows the needs of that library.

#![warn(missing_docs)]
// Units are written [m], [s], [rad] in doc comments: rustdoc would take each for a link.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod math;
pub mod mesh;
