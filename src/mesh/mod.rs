//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

pub mod boxes;
pub mod crossings;
pub mod distance;
mod index;
pub mod motion;
mod topology;
pub mod tree;

pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
