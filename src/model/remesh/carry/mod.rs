//! Memory and shapes carried between a garment and a mesh on its surface, or on another garment's.
//!
//! ```text
//! memory of one mesh -> change of curvature, stiffness, rest lengths per triangle of the other (resample, scatter, smoothing)
//!                    -> angles of its hinges (hinge_fit) -> rest state (memory_delta)
//! shape of a simulation mesh -> positions of the garment's points (shape)
//! ```
//!
//! A map between the surfaces ([`Correspondence`]) says which triangle belongs to a point: [`prolongate`] and [`restrict`] have that of
//! a mesh on the garment itself, a transfer between garments brings its own. The memory is a field on the surface, a change of
//! curvature with its direction per area, so that it does not depend on the edges it was earned on. [`resolved_memory`] is the part of
//! a memory that a mesh can show.

mod correspondence;
mod hinge_fit;
mod memory_delta;
mod prolongate;
mod resample;
mod resolved_memory;
mod scatter;
mod shape;
mod smoothing;
mod surface;
mod tuning;

pub use correspondence::{Correspondence, Match, Query, smallest_rotation};
pub use memory_delta::{Channels, DeltaScale, MemoryDelta};
pub use prolongate::{prolongate, restrict};
pub use resample::{ResampledFace, StretchDelta, WeightedSum, resample};
pub use resolved_memory::resolved_memory;
pub use surface::{GarmentSurface, texture_gradient, warp_direction};
