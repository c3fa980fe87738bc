//! The garment and what flows with it through the pipeline: the source asset it is built from, its rest state, the worn
//! result.
//!
//! [`SourceAsset::from_mesh`] makes an asset from arrays, as `io` does from files.
//! [`Garment::from_asset`] welds, repairs and orients the triangles of a [`SourceAsset`]; [`Garment::refine`]
//! makes it finer. Reads no bytes: `io` does.

mod build;
mod changed_curvature;
mod coincident_layers;
mod contents;
mod diagnostic;
mod feature_edge;
mod file_contents;
mod garment_size;
mod garment_type;
mod inspect;
mod lying;
pub mod material_coords;
mod mesh_arrays;
mod open_seams;
mod refine;
mod repair;
mod rest_state;
mod rigid_parts;
mod sewing;
mod shell;
mod shown_wear;
mod source_asset;
mod tuning;
mod wedges;
mod worn_garment;

pub use changed_curvature::changed_curvature;
pub use contents::{content_warnings, mistaken_body};
pub use diagnostic::{ImportDiagnostic, Severity};
pub use feature_edge::is_feature_hinge;
pub use file_contents::{ClipReport, FileContents, JointReport, MorphReport, PieceAttributes};
pub use garment_size::{GarmentSize, LENGTH_UNITS, is_in_range, is_plausible_unit, usual_units};
pub use garment_type::Garment;
pub use inspect::{Inspection, PartReport, PieceReport, inspect};
pub use lying::{is_flat_across, is_lying_by_normals, max_flat_extent};
pub use mesh_arrays::{MeshOptions, SheetArrays, sheet_arrays};
pub use refine::RefinedMesh;
pub use rest_state::RestState;
pub use rigid_parts::RigidParts;
pub use sewing::{hem_fractions, seam_fractions};
pub use shown_wear::ShownWear;
pub use source_asset::{
    GlbChunk, GltfDocument, ObjFace, ObjLines, Placement, SourceAsset, SourceFormat, SourceJoint,
    SourcePiece, UpAxis,
};
pub use wedges::{corner_uvs, corner_vertices};
pub use worn_garment::WornGarment;
pub(crate) use worn_garment::opened_fraction;
