//! Memory of an earlier run: a worn file names its sidecar, which stands beside it.

use crate::files::input;
use crease::internal::files::{GarmentFile, memory_of_earlier_run};
use crease_io::gltf::{EarlierWear, earlier_wear};
use crease_io::read_sidecar;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::RestState;
use serde_json::{Value, json};
use std::path::Path;

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
    pub fn read(path: &Path, mesh: &GarmentFile) -> Result<Option<std::result::Result<Self, String>>> {
        let Some(EarlierWear { sidecar, is_applied, .. }) = earlier_wear(&mesh.asset) else {
            return Ok(None);
        };
        if is_applied {
            let why =
                "the worn shape is the base of this file; bake the file as it was before --apply".to_owned();
            return Ok(Some(Err(why)));
        }
        let beside = sidecar.map(|name| path.with_file_name(name));
        let Some(beside) = beside.filter(|beside| beside.is_file()) else {
            let why = "its sidecar, OUT.crease.json, is not beside it; put it there".to_owned();
            return Ok(Some(Err(why)));
        };
        let file = input::name_of(&beside);
        let sidecar = read_sidecar(&file, &input::bytes(&beside)?)?;
        let Some(memory) = memory_of_earlier_run(&file, &sidecar, &mesh.garment, &mesh.asset)? else {
            let what = sidecar.mesh_mismatch(&mesh.asset).unwrap_or_default();
            return Ok(Some(Err(format!(
                "{file} {what}; put the sidecar that was written with this file beside it"
            ))));
        };
        let fabric = sidecar.fabric["name"].as_str().map(str::to_owned);
        let origin = json!({"sidecar": file, "wear": sidecar.wear, "fabric": fabric, "run": sidecar.run});
        Ok(Some(Ok(Self { sidecar: file, memory, fabric, origin })))
    }

    /// Returns a warning if the memory was earned on another fabric than `fabric`.
    pub fn fabric_warning(&self, fabric: &Fabric) -> Option<String> {
        let earned = self.fabric.as_ref().filter(|earned| **earned != fabric.name)?;
        Some(format!(
            "the memory in {} was earned on {earned}, and the garment is of {} now: --fabric chooses",
            self.sidecar, fabric.name
        ))
    }
}

/// Returns a warning for a command that leaves the memory of an earlier run out, if `mesh`, read from `path`, has one.
pub fn left_out_warning(path: &Path, mesh: &GarmentFile) -> Option<String> {
    let EarlierWear { piece, sidecar, .. } = earlier_wear(&mesh.asset)?;
    let sidecar = sidecar.unwrap_or_else(|| "its sidecar".to_owned());
    Some(format!(
        "\"{piece}\" has been worn already: the earlier memory, in {sidecar}, is left out. To have both: crease transfer {sidecar} \
         NEW.crease.json --to {} -o BOTH.glb",
        input::name_of(path)
    ))
}
