//! Choice of the worn pieces of a file by name or number.

use crate::pieces::NamedPiece;
use crate::tuning::TUNING;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{ImportDiagnostic, Severity};

/// Marks the pieces that `garment` names as worn, and no others. Returns warnings on names that several meshes have.
pub(super) fn choose_worn(
    file: &str,
    pieces: &mut [NamedPiece],
    garment: Option<&str>,
) -> Result<Vec<ImportDiagnostic>> {
    let Some(wanted) = garment else { return Ok(Vec::new()) };
    let has_triangles = |named: &NamedPiece| !named.piece.triangles.is_empty();
    let is_named = |label: &str| {
        pieces.iter().enumerate().any(|(k, named)| has_triangles(named) && named.is_called(k, label))
    };
    // A name may have a comma in it.
    let labels = if is_named(wanted) { vec![wanted] } else { labels_of(wanted) };
    if let Some(missing) = labels.iter().find(|label| !is_named(label)) {
        return Err(no_such_garment(file, pieces, missing));
    }
    let warnings = labels.iter().filter_map(|label| shared_name(pieces, label)).collect();
    for (k, named) in pieces.iter_mut().enumerate() {
        named.piece.worn = labels.iter().any(|label| named.is_called(k, label));
    }
    Ok(warnings)
}

/// Returns a warning if several meshes are called `label` themselves; a group has any number of them, the primitives of one mesh have its name, and a material is that of any
/// number of them.
fn shared_name(pieces: &[NamedPiece], label: &str) -> Option<ImportDiagnostic> {
    let has_name = |(_, named): &(usize, &NamedPiece)| {
        named.piece.name == label && named.piece.material.as_deref() != Some(label)
    };
    let found: Vec<(usize, &NamedPiece)> = pieces.iter().enumerate().filter(has_name).collect();
    let mut meshes: Vec<usize> = found.iter().map(|(_, named)| named.piece.mesh).collect();
    meshes.dedup();
    if meshes.len() < 2 {
        return None;
    }
    let describe = |(k, named): &(usize, &NamedPiece)| {
        let mesh = match named.piece.node {
            Some(node) => format!("nodes[{node}]"),
            None => format!("meshes[{}]", named.piece.mesh),
        };
        format!("piece#{k} ({mesh}, {} triangles)", named.piece.triangles.len())
    };
    let listed: Vec<String> = found.iter().take(TUNING.max_listed_names).map(describe).collect();
    let more = if found.len() > TUNING.max_listed_names { ", and more" } else { "" };
    Some(ImportDiagnostic {
        severity: Severity::Warning,
        location: String::new(),
        message: Message::from(format!(
            "{} meshes are called \"{label}\" and are taken together: {}{more}; each alone is chosen by its number",
            meshes.len(),
            listed.join(", ")
        )),
    })
}

/// Returns the parts of a list of names.
pub(super) fn labels_of(list: &str) -> Vec<&str> {
    let labels: Vec<&str> = list.split(',').map(str::trim).filter(|label| !label.is_empty()).collect();
    if labels.is_empty() { vec![list] } else { labels }
}

fn no_such_garment(file: &str, pieces: &[NamedPiece], wanted: &str) -> Error {
    let mut names: Vec<&str> = Vec::new();
    for name in pieces.iter().flat_map(|named| &named.names) {
        if !names.contains(&name.as_str()) && names.len() <= TUNING.max_listed_names {
            names.push(name);
        }
    }
    let more = if names.len() > TUNING.max_listed_names { ", and more" } else { "" };
    names.truncate(TUNING.max_listed_names);
    Error::input(
        file,
        "",
        format!("no garment called \"{wanted}\" in it"),
        Message::from(Setting::Garment) + format!(" takes one of: {}{more}", names.join(", ")),
    )
}
