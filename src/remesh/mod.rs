//! The mesh a garment is simulated on: edges along the lines that the wear creases, lengths graded away from them.
//!
//! ```text
//! garment -> surface mesh (its own triangles) -> cut along lines -> split, collapse, flip, slide to wanted lengths
//!         -> simulation mesh, with the location of each point of one on the other
//! ```
//!
//! The surface of the garment stays as it is whatever its file's triangles are (slivers, either diagonal of a quad, any
//! number). Knows no script and no fabric: `bake::adaptive_mesh` says which lines and lengths a wear asks for.

mod aligned_mesh;
mod improve;
mod sizing;
mod surface_mesh;
mod tuning;

pub use aligned_mesh::AlignedMesh;
pub use improve::improve;
pub use sizing::{Seed, SizeField};
pub use surface_mesh::{Curve, CutPoint, SurfaceMesh, SurfacePoint};

impl SurfaceMesh<'_> {
    /// The mesh as it is, to simulate on.
    pub fn finish(&self) -> AlignedMesh {
        AlignedMesh::of(self)
    }
}
