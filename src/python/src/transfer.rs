//! `transfer`, as `crease transfer` does it.

use crate::CreaseError;
use crate::convert::{
    FileReading, ReadGarment, check_not_negative, choice, exception, fabric, garment, worded, wrong_type,
};
use crate::process::check_not_forked;
use crate::sidecar::PySidecar;
use crate::worn::PyWorn;
use crease::internal::bake::RelaxResult;
use crease::internal::files::GarmentFile;
use crease::internal::report::{TransferReport, crossing_counts, source_crossings};
use crease::internal::transfer::{
    Align, MatchBy, Transfer, TransferResult, TransferSource, mesh_along_creases,
};
use crease_cli::files::earlier_memory::left_out_warning;
use crease_cli::files::source::{carried_sources, fabric_of, origins, read_source, relax_target};
use crease_io::Sidecar;
use crease_model::fabric::Fabric;
use crease_model::garment::{WornGarment, mistaken_body};
use crease_model::remesh::{Channels, GarmentSurface};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Inputs of a transfer.
struct TransferInput {
    sources: Vec<TransferSource>,
    sidecars: Vec<Sidecar>,
    file: GarmentFile,
    fabric: Fabric,
    options: TransferOptions,
}

/// Options of a transfer. Names are those of the sidecar.
struct TransferOptions {
    match_by: MatchBy,
    align: Align,
    strength: f64,
    mask: Option<String>,
    only: Option<String>,
    channels: Channels,
    mirror: Option<String>,
}

impl TransferInput {
    /// Returns the result, its sidecar, its report without times, and the reason why it is no equilibrium.
    fn run(&self) -> crease_model::error::Result<Transferred> {
        let GarmentFile { asset, garment, .. } = &self.file;
        let target = GarmentSurface::from_garment(garment, asset);
        let TransferOptions { match_by, align, strength, channels, ref mirror, .. } = self.options;
        let transfer = Transfer::between(&self.sources, &target)
            .target_joints(asset)
            .match_by(match_by)
            .align(align)
            .strength(strength)
            .mask(garment.memory_mask.clone())
            .channels(channels)
            .mirror_x(mirror.is_some());
        let carried = transfer.run_along_creases(garment, &mesh_along_creases)?;
        let start = source_crossings(garment);
        let RelaxResult { displacement, warnings, unconverged_reason, .. } =
            relax_target(&self.file.garment, &self.fabric, &self.sidecars, &carried);
        let worn = WornGarment { displacement, memory: carried.memory.clone() };
        let counts = crossing_counts(garment, &worn, &start);
        let mut report = TransferReport {
            points: garment.points.len(),
            triangles: garment.triangles.len(),
            crossings: counts.added,
            crossings_at_start: counts.at_start,
            sources: carried_sources(&self.sources, &carried),
            warnings,
            ..TransferReport::of_transfer(&carried, &target)
        };
        let empty_reason = worded(carried.empty_reason.clone()).next();
        report.warnings.extend(worded(carried.warnings.clone()).chain(empty_reason.clone()));
        report.warnings.extend(worded(worn.hidden_warning(garment)));
        let sidecar = self.sidecar(&worn, &carried, &report)?;
        Ok(Transferred { worn, sidecar, report, unconverged_reason, empty_reason })
    }

    fn sidecar(
        &self,
        worn: &WornGarment,
        carried: &TransferResult,
        report: &TransferReport,
    ) -> crease_model::error::Result<Sidecar> {
        let from = origins(&self.sidecars, &report.sources);
        let TransferOptions { strength, ref mask, ref only, ref mirror, .. } = self.options;
        let run = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "transfer": {"from": from, "strength": strength, "mask": mask, "only": only, "mirror": mirror},
        });
        let GarmentFile { asset, garment, .. } = &self.file;
        let mut sidecar = Sidecar::new(asset, garment, worn, json!(self.fabric), Value::Null, run)?;
        sidecar.triangles.confidence = Some(carried.confidence.clone());
        Ok(sidecar)
    }
}

/// Result of a transfer.
struct Transferred {
    worn: WornGarment,
    sidecar: Sidecar,
    report: TransferReport,
    unconverged_reason: Option<String>,
    empty_reason: Option<String>,
}

/// Reads one sidecar, or a list of them; each is an object, a file, a worn glTF that names one, or the name of a ready memory.
fn sources(value: &Bound<'_, PyAny>) -> PyResult<Vec<(TransferSource, Sidecar)>> {
    let wanted = "a Sidecar or the path of one, or a list of these";
    let one = |value: &Bound<'_, PyAny>| -> PyResult<(TransferSource, Sidecar)> {
        if let Ok(own) = value.cast::<PySidecar>() {
            let sidecar = own.get().0.clone();
            let source = crease::transfer_source("sidecar", &sidecar).map_err(exception)?;
            return Ok((source, sidecar));
        }
        let path: PathBuf = value.extract().map_err(|_| wrong_type("sidecars", value, wanted))?;
        read_source(&path).map_err(exception)
    };
    if value.cast::<PySidecar>().is_ok() || value.extract::<PathBuf>().is_ok() {
        return Ok(vec![one(value)?]);
    }
    let entries = value.try_iter().map_err(|_| wrong_type("sidecars", value, wanted))?;
    let all: Vec<_> = entries.map(|entry| one(&entry?)).collect::<PyResult<_>>()?;
    match all.is_empty() {
        true => Err(CreaseError::new_err("sidecars: there is none (give at least one)")),
        false => Ok(all),
    }
}

/// Names of `match_by`.
const MATCH_BY: [(&str, MatchBy); 4] =
    [("auto", MatchBy::Auto), ("uv", MatchBy::Uv), ("surface", MatchBy::Surface), ("same", MatchBy::Same)];
/// Names of `align`.
const ALIGN: [(&str, Align); 4] =
    [("auto", Align::Auto), ("joints", Align::Joints), ("box", Align::Box), ("none", Align::InPlace)];
/// Names of `only`.
const CHANNELS: [(&str, Channels); 2] = [
    ("creases", Channels { creases: true, bagging: false }),
    ("bagging", Channels { creases: false, bagging: true }),
];

/// Puts memory on another garment. `sidecars` is a `Sidecar`, the path of one or of a worn .glb that names it, the name of a ready
/// memory, or a list of these; `to` is a file, or a pair of positions [m] and triangles.
#[pyfunction]
#[pyo3(signature = (sidecars, to, *, fabric = None, match_by = "auto", align = "auto", strength = 1.0, mask = None, sewing_mask = None, only = None, mirror = None, unit = None, up = None, part = None, weld_mm = None, force_size = false))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn transfer(
    py: Python<'_>,
    sidecars: &Bound<'_, PyAny>,
    to: &Bound<'_, PyAny>,
    fabric: Option<&Bound<'_, PyAny>>,
    match_by: &str,
    align: &str,
    strength: f64,
    mask: Option<String>,
    sewing_mask: Option<String>,
    only: Option<String>,
    mirror: Option<String>,
    unit: Option<&Bound<'_, PyAny>>,
    up: Option<&str>,
    part: Option<String>,
    weld_mm: Option<f64>,
    force_size: bool,
) -> PyResult<PyWorn> {
    check_not_forked()?;
    let started = Instant::now();
    check_not_negative("strength", strength)?;
    let options = TransferOptions {
        match_by: choice("match_by", match_by, &MATCH_BY)?,
        align: choice("align", align, &ALIGN)?,
        strength,
        channels: only.as_deref().map_or(Ok(Channels::ALL), |only| choice("only", only, &CHANNELS))?,
        mask: mask.clone(),
        only,
        mirror,
    };
    if let Some(axis) = &options.mirror {
        choice("mirror", axis, &[("x", ())])?;
    }
    let (sources, sidecars): (Vec<_>, Vec<_>) = self::sources(sidecars)?.into_iter().unzip();
    let ReadGarment { file, path, warnings: unread } =
        garment("to", to, FileReading { unit, up, part, weld_mm, force_size, mask, sewing_mask })?;
    if let Some(error) = mistaken_body(&file.asset, &file.garment) {
        return Err(exception(error));
    }
    let fabric = match (fabric, sidecars.first()) {
        (None, Some(first)) => fabric_of(&sources[0].file, first).map_err(exception)?,
        _ => self::fabric(fabric)?,
    };
    let mut warnings: Vec<String> = worded(file.content_warnings()).collect();
    warnings.extend(worded(file.repairs()));
    warnings.extend(unread);
    warnings.extend(left_out_warning(path.as_deref().unwrap_or(Path::new("mesh")), &file));
    let input = TransferInput { sources, sidecars, file, fabric, options };
    let done = py.detach(|| input.run()).map_err(exception)?;
    let Transferred { worn, sidecar, mut report, unconverged_reason, empty_reason } = done;
    report.wall_s = started.elapsed().as_secs_f64();
    report.warnings.splice(0..0, warnings);
    Ok(PyWorn {
        worn,
        sidecar,
        report: report.to_json(),
        warnings: report.warnings,
        converged: unconverged_reason.is_none(),
        failure: unconverged_reason.or(empty_reason),
        file: input.file,
        path,
    })
}
