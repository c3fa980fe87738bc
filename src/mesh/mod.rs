//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

pub mod aabb;
pub mod ccd;
pub mod distance;
mod hinge;
mod index;
pub mod intersections;
pub mod point_in_solid;
pub mod static_bvh;
mod topology;
pub mod triangle_bvh;
mod weld;

pub use hinge::{hinge_angle, hinge_gradient, unwrap_angle};
pub use index::{PointIndex, VertexIndex};
pub use topology::{Hinge, NO_TRIANGLE, Topology};
pub use weld::{Groups, Welder};
