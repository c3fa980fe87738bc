//! Fabrics: the parameters of cloth, with units and provenance. [`Fabric::preset`] returns one that is built in (one file each
//! under `presets/`), [`Fabric::parse`] reads a file of the user.

mod fabric_type;
mod preset_list;
mod read;

pub use fabric_type::{EventGuard, Fabric, FabricFormat, FabricMemory, Provenance};
pub use preset_list::{DEFAULT_FABRIC, PAPER_FABRIC};
