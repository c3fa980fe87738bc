//! Reads the wear in a glTF file from the morph target and the attributes that a bake wrote: enough to look at a worn
//! garment whose sidecar is lost, not enough to wear it further (memory belongs to hinges, and these are vertices).
//!
//! The inverse of `write`, and of `apply_worn` after it. Positions have single precision here, double precision in the sidecar.

use crate::gltf::accessor::Accessors;
use crate::gltf::names::{
    APPLIED_KEY, EXTRAS_KEY, FORMER_REST_ANGLE_ATTRIBUTE, REST_ANGLE_CHANGE_ATTRIBUTE, STIFFNESS_ATTRIBUTE,
    UNWORN_TARGET, WORN_TARGET,
};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::{GltfDocument, ImportDiagnostic, Severity, SourceAsset, SourcePiece};
use serde_json::Value;

/// Wear at the vertices of worn pieces; all lists have one entry per vertex, in file order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WornVertices {
    /// Position with morph weight 1 [m], y up.
    pub positions: Vec<Vec3>,
    /// Position before the wear [m], y up; the worn one where the file does not keep it.
    pub source_positions: Vec<Vec3>,
    /// Change of rest angle [degrees]; 0 where the file has none.
    pub rest_angle_deg: Vec<f64>,
    /// Stiffness ratio [-]; 1 where the file has none.
    pub stiffness_ratio: Vec<f64>,
}

/// Returns the name of the sidecar that the worn meshes of `document` refer to.
pub fn sidecar_name(document: &GltfDocument) -> Option<&str> {
    let meshes = document.json["meshes"].as_array()?;
    meshes.iter().find_map(|mesh| mesh["extras"][EXTRAS_KEY]["sidecar"].as_str())
}

/// Wear of an earlier run in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EarlierWear {
    /// Name of the first piece that was worn.
    pub piece: String,
    /// Name of the sidecar with its memory, if the file has it.
    pub sidecar: Option<String>,
    /// Whether the base shape of the file is the worn one.
    pub is_applied: bool,
}

/// Returns the wear of an earlier run on the worn pieces of `asset`, if there is one.
pub fn earlier_wear(asset: &SourceAsset) -> Option<EarlierWear> {
    let document = asset.document.as_ref()?;
    let is_worn = |piece: &SourcePiece| {
        let extras = &document.json["meshes"][piece.mesh]["extras"][EXTRAS_KEY];
        !extras.is_null() && self::is_worn(document, piece)
    };
    let piece = asset.worn_pieces().find(|piece| is_worn(piece))?;
    Some(EarlierWear {
        piece: piece.name.clone(),
        sidecar: sidecar_name(document).map(str::to_owned),
        is_applied: is_applied(document, piece),
    })
}

/// Describes the wear of an earlier run on `asset`, if there is one.
pub(crate) fn earlier_wear_note(asset: &SourceAsset) -> Option<ImportDiagnostic> {
    let EarlierWear { piece, sidecar, is_applied } = earlier_wear(asset)?;
    let shape =
        if is_applied { "worn shape, which is the base of the file," } else { "shape before that wear" };
    let memory = sidecar.map_or(String::new(), |sidecar| format!("; its memory is in {sidecar}"));
    let message = format!("\"{piece}\" has been worn already, and its {shape} is taken{memory}");
    Some(ImportDiagnostic { severity: Severity::Note, location: String::new(), message: message.into() })
}

/// Marks the pieces that a bake wore as worn, and no others; returns false, and changes nothing, if there is none. They have a
/// worn target and memory; all primitives of one mesh have as many targets, so that those of a body beside the garment
/// have one that moves nothing.
pub fn keep_worn_pieces(asset: &mut SourceAsset) -> bool {
    let Some(document) = &asset.document else { return false };
    let has_target: Vec<bool> = asset.pieces.iter().map(|piece| is_worn(document, piece)).collect();
    let has_memory: Vec<bool> = asset
        .pieces
        .iter()
        .zip(&has_target)
        .map(|(piece, has)| {
            *has && primitive(document, piece)["attributes"].get(STIFFNESS_ATTRIBUTE).is_some()
        })
        .collect();
    let worn = if has_memory.contains(&true) { has_memory } else { has_target };
    if !worn.contains(&true) {
        return false;
    }
    asset.pieces.iter_mut().zip(worn).for_each(|(piece, worn)| piece.worn = worn);
    true
}

/// Reads the wear of the worn pieces of `asset`; empty for a file that is not glTF.
pub fn read_worn(asset: &SourceAsset) -> Result<WornVertices> {
    let mut all = WornVertices::default();
    if let Some(document) = &asset.document {
        for piece in asset.worn_pieces() {
            all.add(document, piece)?;
        }
    }
    Ok(all)
}

impl WornVertices {
    fn add(&mut self, document: &GltfDocument, piece: &SourcePiece) -> Result<()> {
        let count = piece.positions.len();
        let attributes = &primitive(document, piece)["attributes"];
        let target = worn_target(document, piece).or_else(|| named_target(document, piece, UNWORN_TARGET));
        let shift = target.map_or(&Value::Null, |target| &target["POSITION"]);
        let shift = column(document, shift, 3, count, "POSITION of the worn target")?;
        let is_applied = is_applied(document, piece);
        for (v, own) in piece.positions.iter().enumerate() {
            let shift = shift.as_ref().and_then(|all| all.get(3 * v..3 * v + 3)).unwrap_or(&[0.0; 3]);
            let moved = own + Vec3::from_row_slice(shift);
            let [base, moved] = [own, &moved].map(|x| (piece.placement.matrix(v) * x.push(1.0)).xyz());
            let (source, worn) = if is_applied { (moved, base) } else { (base, moved) };
            self.positions.push(worn);
            self.source_positions.push(source);
        }
        let scalars = |name: &str, otherwise: f64| {
            Ok(column(document, &attributes[name], 1, count, name)?.unwrap_or_else(|| vec![otherwise; count]))
        };
        let is_present = |name: &&str| attributes.get(*name).is_some();
        let names = [REST_ANGLE_CHANGE_ATTRIBUTE, FORMER_REST_ANGLE_ATTRIBUTE];
        let name = names.into_iter().find(is_present).unwrap_or(REST_ANGLE_CHANGE_ATTRIBUTE);
        self.rest_angle_deg.extend(scalars(name, 0.0)?);
        self.stiffness_ratio.extend(scalars(STIFFNESS_ATTRIBUTE, 1.0)?);
        Ok(())
    }
}

fn primitive<'a>(document: &'a GltfDocument, piece: &SourcePiece) -> &'a Value {
    &document.json["meshes"][piece.mesh]["primitives"][piece.primitive]
}

/// Whether a piece is worn: it has a worn target, or its mesh has the worn shape as its base.
fn is_worn(document: &GltfDocument, piece: &SourcePiece) -> bool {
    let has_memory = primitive(document, piece)["attributes"].get(STIFFNESS_ATTRIBUTE).is_some();
    worn_target(document, piece).is_some() || (has_memory && is_applied(document, piece))
}

/// Whether the base shape of the mesh of a piece is the worn one.
fn is_applied(document: &GltfDocument, piece: &SourcePiece) -> bool {
    document.json["meshes"][piece.mesh]["extras"][EXTRAS_KEY][APPLIED_KEY] == true
}

/// Returns the target `name` of a piece.
fn named_target<'a>(document: &'a GltfDocument, piece: &SourcePiece, name: &str) -> Option<&'a Value> {
    let names = document.json["meshes"][piece.mesh]["extras"]["targetNames"].as_array()?;
    primitive(document, piece)["targets"].get(names.iter().rposition(|own| own == name)?)
}

/// Returns the worn target of a piece.
pub(super) fn worn_target<'a>(document: &'a GltfDocument, piece: &SourcePiece) -> Option<&'a Value> {
    named_target(document, piece, WORN_TARGET)
}

/// Whether a mesh of `document` has the shape that was worn as a morph target: not where that is its base shape.
pub fn has_worn_target(document: &GltfDocument) -> bool {
    let has_name = |mesh: &Value| {
        let names = mesh["extras"]["targetNames"].as_array();
        names.is_some_and(|names| names.iter().any(|name| name == WORN_TARGET))
    };
    document.json["meshes"].as_array().is_some_and(|meshes| meshes.iter().any(has_name))
}

/// Returns the index of the worn target among the targets of a piece.
pub(super) fn worn_target_index(document: &GltfDocument, piece: &SourcePiece) -> Option<usize> {
    let names = document.json["meshes"][piece.mesh]["extras"]["targetNames"].as_array()?;
    names.iter().rposition(|name| name == WORN_TARGET)
}

/// Reads all numbers of an accessor, row by row; `None` if `accessor` is no index.
pub(super) fn column(
    document: &GltfDocument,
    accessor: &Value,
    width: usize,
    count: usize,
    user: &str,
) -> Result<Option<Vec<f64>>> {
    let Some(index) = accessor.as_u64().and_then(|i| usize::try_from(i).ok()) else { return Ok(None) };
    let table = Accessors::new(document).table_of(index, width, Some(count), user)?;
    Ok(Some(table.rows().flatten().copied().collect()))
}
