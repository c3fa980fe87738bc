//! The sidecar, `OUT.crease.json`, format `crease-sidecar/1`: the memory of a worn garment as an open file.
//!
//! Last stage of a bake, first stage of a transfer. It holds the welded mesh that the solver used, the memory of every
//! hinge and triangle, the displacement that went into the glTF, and the inputs (fabric, wear script, run). Checksums
//! over the numbers distinguish an edited file from the one that was written; a file without them is accepted.

mod checksums;
mod convert;
mod format;
mod gzip;
mod read_write;
mod surface;
#[cfg(test)]
mod tests;
mod validate;

pub use format::{
    SIDECAR_FORMAT, Sidecar, SidecarChecksums, SidecarCrease, SidecarHinges, SidecarJoint, SidecarMesh,
    SidecarPoints, SidecarSource, SidecarTriangles, SidecarUp,
};
pub use read_write::{read_sidecar, write_sidecar, write_sidecar_to};
pub use surface::sidecar_surface;
