//! Second phase of a bake: the garment relaxed to its source pose with the memory it earned (`relax_to_source`) or was given
//! (`given_memory`), and its displacement freed of crossings (`uncross`).

pub(super) mod given_memory;
pub(super) mod relax_to_source;
pub(super) mod uncross;
