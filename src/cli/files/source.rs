//! Sources of a transfer: sidecars by path, or by the worn glTF that names one, and what is said of them in report and sidecar.

use crate::files::input;
use crease::internal::bake::RelaxResult;
use crease::internal::files::{STANDARD_STREAM, read_asset_file, ready_memory, transfer_source};
use crease::internal::report::CarriedSource;
use crease::internal::transfer::{TransferResult, TransferSource, relax_carried};
use crease_io::gltf::sidecar_name;
use crease_io::{ReadOptions, Sidecar, read_sidecar};
use crease_model::error::{Error, Result};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::Garment;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Reads a sidecar, or the one that a worn glTF names, or else the ready memory of that name.
pub fn read_source(path: &Path) -> Result<(TransferSource, Sidecar)> {
    if let Some(name) = ready_name(path) {
        let sidecar = ready_memory(name)?;
        return Ok((transfer_source(name, &sidecar)?, sidecar));
    }
    let named = if input::is_gltf(path)? { Some(sidecar_of(path)?) } else { None };
    let path = named.as_deref().unwrap_or(path);
    let file = input::name_of(path);
    let sidecar = read_sidecar(&file, &input::bytes(path)?)?;
    Ok((transfer_source(&file, &sidecar)?, sidecar))
}

/// Returns `path` if it stands for a ready memory: there is no such file, and it has neither folder nor ending.
fn ready_name(path: &Path) -> Option<&str> {
    let name = path.to_str().filter(|name| *name != STANDARD_STREAM)?;
    let is_bare = path.extension().is_none() && path.components().count() == 1;
    (is_bare && !path.exists()).then_some(name)
}

/// Returns the sidecar that the worn glTF `path` names.
fn sidecar_of(path: &Path) -> Result<PathBuf> {
    // An explicit unit: nothing but the name is read.
    let options = ReadOptions { unit_m: Some(1.0), ..ReadOptions::default() };
    let (asset, _) = read_asset_file(path, &options)?;
    let name = asset.document.as_ref().and_then(sidecar_name);
    name.map(|name| path.with_file_name(name)).ok_or_else(|| {
        let help = "bake it first, or give the OUT.crease.json of the worn garment";
        Error::input(input::name_of(path), "", "names no sidecar: it is no worn garment", help)
    })
}

/// Returns the fabric of a sidecar, `file` in messages.
pub fn fabric_of(file: &str, sidecar: &Sidecar) -> Result<Fabric> {
    match &sidecar.fabric {
        Value::Null => Fabric::preset(DEFAULT_FABRIC),
        value => Fabric::parse(&format!("{file}: fabric"), &value.to_string()),
    }
}

/// Relaxes the target `garment` with the transferred memory. Memory of the first of `sidecars` that was transferred unchanged keeps
/// its shape.
pub fn relax_target(
    garment: &Garment,
    fabric: &Fabric,
    sidecars: &[Sidecar],
    carried: &TransferResult,
) -> RelaxResult {
    match sidecars.first().filter(|_| carried.unchanged) {
        Some(own) => RelaxResult { displacement: own.worn().displacement, ..RelaxResult::default() },
        None => relax_carried(garment, fabric, carried),
    }
}

/// Returns what the report says of each of `sources`.
pub fn carried_sources(sources: &[TransferSource], carried: &TransferResult) -> Vec<CarriedSource> {
    let each = sources.iter().zip(&carried.sources);
    each.map(|(source, outcome)| CarriedSource {
        file: source.file.clone(),
        by: outcome.matched_by.name().to_owned(),
        aligned: outcome.aligned_by.map(|by| by.name().to_owned()),
        losses: outcome.losses,
    })
    .collect()
}

/// Returns what the sidecar of the target says of each of `sidecars`, which the report lists as `sources`.
pub fn origins(sidecars: &[Sidecar], sources: &[CarriedSource]) -> Vec<Value> {
    let each = sidecars.iter().zip(sources);
    each.map(|(sidecar, source)| {
        json!({"sidecar": source.file, "by": source.by, "source": sidecar.source, "wear": sidecar.wear,
               "run": sidecar.run})
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_name_without_a_file_is_a_ready_memory() {
        let (source, sidecar) = read_source(Path::new("elbow")).expect("is part of the program");
        assert_eq!((source.file.as_str(), sidecar.source.file.as_str()), ("elbow", "garments/sleeve.glb"));
        let message = |name| read_source(Path::new(name)).map(|_| ()).expect_err("there is none").to_string();
        assert!(message("elbwo").contains("did you mean `elbow`?"));
        assert!(message("elbow.crease.json").contains("there is no such file"));
    }
}
