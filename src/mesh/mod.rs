//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

mod hinge;
mod index;
mod topology;

pub use hinge::{hinge_angle, hinge_gradient, hinge_hessian, unwrap_angle};
pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
