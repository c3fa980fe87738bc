//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

pub mod boxes;
pub mod crossings;
pub mod distance;
mod hinge;
mod index;
pub mod inside;
pub mod motion;
pub mod patches;
mod topology;
pub mod tree;
mod weld;

pub use hinge::{hinge_angle, hinge_gradient, hinge_hessian, unwrap_angle};
pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
pub use weld::{Groups, Welder};
