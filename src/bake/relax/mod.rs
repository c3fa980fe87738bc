//! Second phase of a bake: the garment relaxed to its source pose with the memory it earned (`relax_to_source`) or was given
//! (`given_memory`), read off at the points of the garment (`garment_reading`), whose triangles follow it without
//! crossing (`shape_follower`).

pub(super) mod garment_reading;
pub(super) mod given_memory;
pub(super) mod relax_to_source;
mod shape_follower;
