//! Triangle meshes as geometry: indices, topology, hinge angles, distances, search. Knows no cloth and no file.

pub mod aabb;
pub mod ccd;
pub mod distance;
mod edge_distance;
mod hinge;
mod index;
pub mod intersections;
mod long_edge;
pub mod orientation;
pub mod point_in_solid;
mod rotation_field;
pub mod static_bvh;
mod surface_walk;
mod topology;
pub mod triangle;
pub mod triangle_bvh;
mod tuning;
mod weld;

pub use edge_distance::edge_distances;
pub use hinge::{hinge_angle, hinge_gradient, unwrap_angle};
pub use index::{INVALID, PointIndex, VertexIndex};
pub use long_edge::LongEdge;
pub use rotation_field::{mean_rotation, point_rotations, turned, weighted_rotation};
pub use surface_walk::SurfaceWalk;
pub use topology::{Hinge, Topology, edge_key, loop_length, triangle_key};
pub use weld::{Groups, Welder};
