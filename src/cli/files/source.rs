//! Sources of a transfer: sidecars by path, or by the worn glTF that names one, and what is said of them in report and sidecar.

use crate::files::input;
use crease::internal::bake::RelaxResult;
use crease::internal::files::{read_asset_file, transfer_source};
use crease::internal::report::CarriedSource;
use crease::internal::transfer::{TransferResult, TransferSource, relax_carried};
use crease_io::gltf::sidecar_name;
use crease_io::{ReadOptions, Sidecar, read_sidecar};
use crease_model::error::{Error, Result};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::Garment;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Reads a sidecar, or the one that a worn glTF names.
pub fn read_source(path: &Path) -> Result<(TransferSource, Sidecar)> {
    let named = if input::is_gltf(path)? { Some(sidecar_of(path)?) } else { None };
    let path = named.as_deref().unwrap_or(path);
    let file = input::name_of(path);
    let sidecar = read_sidecar(&file, &input::bytes(path)?)?;
    Ok((transfer_source(&file, &sidecar)?, sidecar))
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
