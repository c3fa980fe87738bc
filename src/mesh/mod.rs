//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

mod index;
mod topology;

pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
