//! `transfer`, as `crease transfer` does it.

use crate::CreaseError;
use crate::convert::{FileReading, check_not_negative, choice, exception, fabric, garment, wrong_type};
use crate::process::check_not_forked;
use crate::sidecar::PySidecar;
use crate::wording::PythonWords;
use crate::worn::PyWorn;
use crease::internal::job::{MemorySource, OutputOptions, TransferJob};
use crease::internal::transfer::{Align, MatchBy, TransferOptions};
use crease_model::remesh::Channels;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Reads one sidecar, or a list of them; each is an object, a file, a worn glTF that names one, or the name of a ready memory.
fn sources(value: &Bound<'_, PyAny>) -> PyResult<Vec<MemorySource>> {
    let wanted = "a Sidecar or the path of one, or a list of these";
    let one = |value: &Bound<'_, PyAny>| -> PyResult<MemorySource> {
        if let Ok(own) = value.cast::<PySidecar>() {
            return Ok(MemorySource::Sidecar(Box::new(own.get().0.clone())));
        }
        let path: PathBuf = value.extract().map_err(|_| wrong_type("sidecars", value, wanted))?;
        Ok(MemorySource::File(path))
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
#[pyo3(signature = (sidecars, to, *, fabric = None, match_by = "auto", align = "auto", strength = 1.0, mask = None, sewing_mask = None, only = None, mirror = None, unit = None, up = None, part = None, weld_mm = None, force_size = false, allow_folder = None))]
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
    allow_folder: Option<PathBuf>,
) -> PyResult<PyWorn> {
    check_not_forked()?;
    check_not_negative("strength", strength)?;
    let transfer = TransferOptions {
        match_by: choice("match_by", match_by, &MatchBy::ALL)?,
        align: choice("align", align, &ALIGN)?,
        strength,
        channels: only.as_deref().map_or(Ok(Channels::ALL), |only| choice("only", only, &CHANNELS))?,
        mirror_x: mirror.as_deref().map(|axis| choice("mirror", axis, &[("x", ())])).transpose()?.is_some(),
        ..TransferOptions::full(0)
    };
    let sources = self::sources(sidecars)?;
    let target = garment(
        "to",
        to,
        FileReading { unit, up, part, weld_mm, force_size, allow_folder, mask, sewing_mask },
    )?;
    let fabric = fabric.map(|fabric| self::fabric(Some(fabric))).transpose()?;
    let job = TransferJob {
        sources,
        target,
        resolution_mm: None,
        fabric,
        landmarks: None,
        transfer,
        output: OutputOptions { fine: true, ..OutputOptions::default() },
    };
    PyWorn::new(py.detach(|| job.run(&mut PythonWords)).map_err(exception)?)
}
