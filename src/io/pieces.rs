//! Results of the readers of mesh formats.

use crease_model::error::{Diagnostic, Setting};
use crease_model::garment::{GltfDocument, ImportDiagnostic, ObjLines, SourcePiece, UpAxis};

/// Settings that name the masks of a piece: of its memory, of its hems and seams.
pub(super) const MASK_SETTINGS: [Setting; 2] = [Setting::Mask, Setting::SewingMask];

/// Result of the reader of a format.
pub(super) struct ReadPieces {
    /// Pieces in file order, all marked as worn.
    pub(super) pieces: Vec<NamedPiece>,
    /// Pieces that cannot be read; refused only if they are asked for.
    pub(super) damaged: Vec<DamagedPiece>,
    /// Document, for glTF.
    pub(super) document: Option<GltfDocument>,
    /// Lines, for OBJ.
    pub(super) obj: Option<ObjLines>,
    /// Unit and axis, where they are those of the file.
    pub(super) frame: Option<FileFrame>,
    /// Repairs and notes.
    pub(super) diagnostics: Vec<ImportDiagnostic>,
}

/// Unit and up axis of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FileFrame {
    /// Metres per file unit.
    pub(super) unit_m: f64,
    /// Up axis.
    pub(super) up: UpAxis,
    /// Whether the file itself states its unit.
    pub(super) states_unit: bool,
}

/// Piece with all names it can be chosen by.
pub(super) struct NamedPiece {
    pub(super) piece: SourcePiece,
    pub(super) names: Vec<String>,
}

impl NamedPiece {
    /// Returns whether the piece, number `number` of its file, is what `label` chooses: a name, NAME:MATERIAL, or `piece#NUMBER`.
    pub(super) fn is_called(&self, number: usize, label: &str) -> bool {
        let has_name = |wanted: &str| self.names.iter().any(|name| name == wanted);
        let with_material = label.rsplit_once(':').is_some_and(|(name, material)| {
            has_name(name) && self.piece.material.as_deref() == Some(material)
        });
        has_name(label) || with_material || label == format!("piece#{number}")
    }
}

/// Piece that cannot be read.
pub(super) struct DamagedPiece {
    pub(super) names: Vec<String>,
    pub(super) errors: Vec<Diagnostic>,
}
