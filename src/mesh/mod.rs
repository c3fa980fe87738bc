//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

mod index;
mod topology;
mod weld;

pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
pub use weld::{Groups, Welder};
