//! Memory that a job starts from: sidecars, by path or by the worn glTF that names one, and the memory of an earlier run, whose sidecar
//! stands beside a worn file.

use crate::bake::RelaxResult;
use crate::files::{
    GarmentFile, STANDARD_STREAM, file_name, is_gltf, memory_of_earlier_run, read_asset_file, read_bytes,
    ready_memory, sidecar_path, transfer_source,
};
use crate::report::CarriedSource;
use crate::transfer::{TransferResult, TransferSource, relax_carried};
use crease_io::gltf::{EarlierWear, earlier_wear, sidecar_name};
use crease_io::{ReadOptions, Sidecar, read_sidecar};
use crease_model::error::{Error, Message, Operation, Result, Setting};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{Garment, RestState};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Memory that a transfer starts from.
#[derive(Debug)]
pub enum MemorySource {
    /// A sidecar, a worn glTF that names one, the name of a ready memory, or `-` for the standard input.
    File(PathBuf),
    /// A sidecar in memory.
    Sidecar(Box<Sidecar>),
}

impl MemorySource {
    /// Path of the file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Sidecar(_) => None,
        }
    }

    /// Name of the file in messages.
    pub(super) fn name(&self) -> String {
        self.path().map_or("sidecar".to_owned(), file_name)
    }

    /// Reads the memory and its sidecar.
    pub(super) fn read(self) -> Result<(TransferSource, Sidecar)> {
        match self {
            Self::File(path) => read_source(&path),
            Self::Sidecar(sidecar) => Ok((transfer_source("sidecar", &sidecar)?, *sidecar)),
        }
    }
}

/// Reads a sidecar, or the one that a worn glTF names, or else the ready memory of that name.
fn read_source(path: &Path) -> Result<(TransferSource, Sidecar)> {
    if let Some(name) = ready_name(path) {
        let sidecar = ready_memory(name)?;
        return Ok((transfer_source(name, &sidecar)?, sidecar));
    }
    let named = if is_gltf(path)? { Some(sidecar_of(path)?) } else { None };
    let path = named.as_deref().unwrap_or(path);
    let file = file_name(path);
    let sidecar = read_sidecar(&file, &read_bytes(path)?)?;
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
    let help = "bake it first, or give the OUT.crease.json of the worn garment";
    let none = || Error::input(file_name(path), "", "names no sidecar: it is no worn garment", help);
    sidecar_path(path, name.ok_or_else(none)?)
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

/// Memory that a garment begins with.
#[derive(Debug)]
pub struct EarlierMemory {
    /// Name of the sidecar.
    pub sidecar: String,
    /// The memory, one entry per hinge and triangle of the garment.
    pub memory: RestState,
    /// Name of the fabric that it was earned on.
    pub fabric: Option<String>,
    /// Origin of the memory, for the sidecar of the run.
    pub origin: Value,
}

impl EarlierMemory {
    /// Reads the memory that the worn file `path`, with the garment `mesh`, refers to. `Err` with the reason where the file was worn
    /// and its memory cannot be carried on; `None` for a file that was never worn.
    ///
    /// # Errors
    /// A sidecar that is damaged.
    pub fn read(path: &Path, mesh: &GarmentFile) -> Result<Option<std::result::Result<Self, Message>>> {
        let Some(EarlierWear { sidecar, is_applied, .. }) = earlier_wear(&mesh.asset) else {
            return Ok(None);
        };
        if is_applied {
            let why =
                Message::from("the worn shape is the base of this file; bake the file as it was before ");
            return Ok(Some(Err(why + Setting::Apply)));
        }
        let beside = sidecar.as_ref().map(|name| sidecar_path(path, name)).transpose()?;
        let Some(beside) = beside.filter(|beside| beside.is_file()) else {
            return Ok(Some(Err(missing_sidecar(path, sidecar.as_deref()).into())));
        };
        let file = file_name(&beside);
        let sidecar = read_sidecar(&file, &read_bytes(&beside)?)?;
        let Some(memory) = memory_of_earlier_run(&file, &sidecar, &mesh.garment, &mesh.asset)? else {
            let what = sidecar.mesh_mismatch(&mesh.asset).unwrap_or_default();
            let why = format!("{file} {what}; put the sidecar that was written with this file beside it");
            return Ok(Some(Err(why.into())));
        };
        let fabric = sidecar.fabric["name"].as_str().map(str::to_owned);
        let origin = json!({"sidecar": file, "wear": sidecar.wear, "fabric": fabric, "run": sidecar.run});
        Ok(Some(Ok(Self { sidecar: file, memory, fabric, origin })))
    }

    /// Returns a warning if the memory was earned on another fabric than `fabric`.
    pub fn fabric_warning(&self, fabric: &Fabric) -> Option<Message> {
        let earned = self.fabric.as_ref().filter(|earned| **earned != fabric.name)?;
        let text = format!(
            "the memory in {} was earned on {earned}, and the garment is of {} now: ",
            self.sidecar, fabric.name
        );
        Some(Message::from(text) + Setting::Fabric + " chooses")
    }
}

/// Returns a warning for a command that leaves the memory of an earlier run out, if `mesh`, read from `path`, has one.
pub fn left_out_warning(path: &Path, mesh: &GarmentFile) -> Option<Message> {
    let EarlierWear { piece, sidecar: name, .. } = earlier_wear(&mesh.asset)?;
    let beside = name.as_ref().and_then(|name| sidecar_path(path, name).ok());
    let Some(sidecar) = beside.filter(|beside| beside.is_file()).as_deref().map(file_name) else {
        let missing = missing_sidecar(path, name.as_deref());
        let text =
            format!("\"{piece}\" has been worn already, and the earlier memory is left out: {missing}");
        return Some(text.into());
    };
    let text = format!(
        "\"{piece}\" has been worn already: the earlier memory, in {sidecar}, is left out. To have both: "
    );
    let call = Message::from(Operation::Transfer) + format!(" {sidecar} NEW.crease.json ");
    Some(Message::from(text) + call + Setting::Target.to(file_name(path)) + " -o BOTH.glb")
}

/// Says that the sidecar of the worn file `path`, which names it `name`, is missing, and what to do.
fn missing_sidecar(path: &Path, name: Option<&str>) -> String {
    let own = file_name(&path.with_extension("crease.json"));
    match name.filter(|name| *name != own) {
        Some(name) => format!("neither {own} nor {name} is beside it; put one there"),
        None => format!("its sidecar, {own}, is not beside it; put it there"),
    }
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
