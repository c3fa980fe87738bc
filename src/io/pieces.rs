//! Results of the readers of mesh formats, and the transform from a file to the scene.

use crate::garment::{GltfDocument, ImportDiagnostic, SourcePiece, UpAxis};
use crate::math::Mat4;

/// Result of the reader of a format.
pub(super) struct ReadPieces {
    /// Pieces in file order, all marked as worn.
    pub(super) pieces: Vec<NamedPiece>,
    /// Document, for glTF.
    pub(super) document: Option<GltfDocument>,
    /// Repairs and notes.
    pub(super) diagnostics: Vec<ImportDiagnostic>,
}

/// Piece with all names it can be chosen by.
pub(super) struct NamedPiece {
    pub(super) piece: SourcePiece,
    pub(super) names: Vec<String>,
}

/// Returns the transform from file units and axes to metres, y up.
pub(super) fn to_scene(unit_m: f64, up: UpAxis) -> Mat4 {
    let turned = match up {
        UpAxis::Y => Mat4::identity(),
        UpAxis::Z => Mat4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, //
            0.0, -1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 1.0,
        ),
    };
    Mat4::new_scaling(unit_m) * turned
}
