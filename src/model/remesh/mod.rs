//! The mesh a garment is simulated on: edges along the lines that the wear creases, lengths graded away from them.
//!
//! ```text
//! garment -> surface mesh (its own triangles) -> cut along lines -> split, collapse, flip, slide to wanted lengths
//!         -> simulation mesh, with the location of each point of one on the other
//! ```
//!
//! The surface of the garment stays as it is whatever its file's triangles are (slivers, either diagonal of a quad, any
//! number). During the wear triangles are bisected where they must bend more than their length can show (`refine`).
//!
//! Knows no script and no fabric: `bake::choose_mesh` says which lines and lengths a wear asks for.

mod carry;
mod fine_mesh;
mod hinge_chains;
mod improve;
mod refine;
mod simulation_mesh;
mod sizing;
mod surface_finder;
mod surface_mesh;
mod tuning;
mod worn_surface;

pub use carry::{
    Channels, Correspondence, DeltaScale, GarmentSurface, Match, MemoryDelta, Query, ResampledFace,
    StretchDelta, WeightedSum, prolongate, resample, resolved_memory, restrict, smallest_rotation,
    texture_gradient, warp_direction,
};
pub use fine_mesh::{FileMesh, FileTriangle, FineMesh, FinePoint, FineVertex};
pub use hinge_chains::HingeChain;
pub use improve::improve;
pub use refine::Refinement;
pub use simulation_mesh::SimulationMesh;
pub use sizing::{Seed, SizeField};
pub use surface_finder::SurfaceFinder;
pub use surface_mesh::{Curve, CutPoint, SurfaceMesh, SurfacePoint, interpolate};
pub use worn_surface::{
    Crease, CreaseChain, CreaseDistances, NearCrease, WornPlace, WornSurface, opened_memory,
};

impl SurfaceMesh<'_> {
    /// The mesh as it is, to simulate on.
    pub fn finish(&self) -> SimulationMesh {
        SimulationMesh::of(self)
    }
}
