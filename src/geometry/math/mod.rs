//! Vector aliases and small numerical tools used by all other folders.

mod plane_stretch;
mod rng;
mod rotation;
pub mod serde_vec;
mod vector;

pub use plane_stretch::PlaneStretch;
pub use rng::Rng;
pub use rotation::{NearestRotation, nearest_rotation};
pub use vector::{Mat3, Mat4, Vec2, Vec3, bounds, dot};
