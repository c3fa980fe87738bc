//! The nouns that flow through the pipeline: the garment, its memory, its state, the worn result.

mod build;
mod coarsen;
mod diagnostic;
mod garment_type;
mod inspect;
mod lying;
mod material_coords;
mod refine;
mod repair;
mod rest_state;
mod source_asset;
mod wedges;
mod worn;

pub use coarsen::CoarseMesh;
pub use diagnostic::{ImportDiagnostic, Severity};
pub use garment_type::Garment;
pub use inspect::{Inspection, PartReport, PieceReport, inspect};
pub use lying::{Footprint, is_lying, is_lying_by_normals};
pub use refine::RefinedMesh;
pub use rest_state::RestState;
pub use source_asset::{
    GltfDocument, Placement, SourceAsset, SourceFormat, SourceJoint, SourcePiece, UpAxis,
};
pub use wedges::{corner_uvs, corner_vertices};
pub use worn::WornGarment;
