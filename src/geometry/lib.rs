//! Triangle meshes of cloth and what is asked of them, without physics: vectors and random numbers (`math`), topology, hinge
//! angles, distances, exact intersections, continuous collision detection and bounding-volume trees (`mesh`).
//!
//! A crate of the workspace of `crease`; its interface follows the needs of that library.

pub mod math;
pub mod mesh;
