//! What cloth is made of. [`Fabric`] is a plain bag of numbers with units and provenance; [`Fabric::preset`] knows
//! the fabrics that come along (one file each under `presets/`), [`Fabric::parse`] reads one of the user's own.

mod fabric_type;
mod preset_list;
mod read;

pub use fabric_type::{Fabric, FabricFormat, FabricMemory, Provenance};
pub use preset_list::DEFAULT_FABRIC;
