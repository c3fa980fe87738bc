//! `bake` and `transfer`.

use crate::CreaseError;
use crate::convert::{exception, fabric, garment, rows, vectors};
use crate::sidecar::PySidecar;
use crate::worn::PyWorn;
use crease::bake::{Bake, BakeProgress, Observer, Quality, mesh_along_creases, relax_carried};
use crease::mesh::intersections::self_intersections;
use crease::report::{Report, crossing_counts};
use crease::transfer::{Align, DrawnCreases, GarmentSurface, MatchBy, Transfer, TransferSource};
use crease::{Fabric, GarmentFile, Sidecar, WearScript, WornGarment};
use numpy::PyArray2;
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time between two calls of Python during a bake.
const CALL_INTERVAL: Duration = Duration::from_millis(100);

/// Reports to a Python function, and asks Python whether Ctrl-C was pressed.
struct Reporter {
    call: Option<Py<PyAny>>,
    last: Instant,
    failure: Option<PyErr>,
    stop: bool,
}

impl Reporter {
    fn ask(&mut self, now: &BakeProgress) -> PyResult<bool> {
        Python::attach(|py| {
            py.check_signals()?;
            let Some(call) = &self.call else { return Ok(false) };
            let answer = call.call1(py, (now.stage, now.time, now.total))?;
            Ok(answer.extract::<bool>(py).is_ok_and(|go_on| !go_on))
        })
    }
}

impl Observer for Reporter {
    fn progress(&mut self, now: &BakeProgress) {
        if self.last.elapsed() < CALL_INTERVAL {
            return;
        }
        self.last = Instant::now();
        match self.ask(now) {
            Ok(stop) => self.stop |= stop,
            Err(error) => {
                self.stop = true;
                self.failure = Some(error);
            }
        }
    }

    fn should_stop(&mut self) -> bool {
        self.stop
    }
}

/// Reads a wear script: a file, the name of one of the program's, or its content.
fn script(wear: &Bound<'_, PyAny>) -> PyResult<WearScript> {
    let Ok(path) = wear.extract::<PathBuf>() else {
        let text: String = wear.py().import("json")?.call_method1("dumps", (wear,))?.extract()?;
        return WearScript::parse("wear", &text).map_err(exception);
    };
    let name = path.to_string_lossy();
    match path.is_file() || path.extension().is_some() {
        true => WearScript::load(&path).map_err(exception),
        false => WearScript::preset(&name).map_err(exception),
    }
}

#[pyfunction]
#[pyo3(signature = (garment, wear, *, fabric = "kow-tshirt", quality = "standard", memory = true, unit = None, part = None, progress = None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn bake(
    py: Python<'_>,
    garment: &Bound<'_, PyAny>,
    wear: &Bound<'_, PyAny>,
    fabric: &str,
    quality: &str,
    memory: bool,
    unit: Option<f64>,
    part: Option<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyWorn> {
    let file = crate::convert::garment(garment, unit, part)?;
    let script = script(wear)?;
    let fabric = crate::convert::fabric(fabric)?;
    let quality = Quality::from_name(quality).ok_or_else(|| {
        let names = Quality::ALL.map(Quality::name).join(", ");
        CreaseError::new_err(format!("quality: {quality} is none of {names}"))
    })?;
    let errors = script.errors_without_body("wear");
    if !errors.is_empty() {
        return Err(exception(crease::Error::Input(errors)));
    }
    let mut reporter = Reporter { call: progress, last: Instant::now(), failure: None, stop: false };
    let started = Instant::now();
    let outcome = py.detach(|| {
        let bake = Bake::new(&file.garment, &fabric, &script).quality(quality).memory(memory);
        let baked = bake.run_with(&mut reporter)?;
        let start = self_intersections(&file.garment.points, &file.garment.triangles);
        let counts = crossing_counts(&file.garment, &baked.worn, &start);
        Ok((baked, counts))
    });
    if let Some(failure) = reporter.failure {
        return Err(failure);
    }
    let (baked, counts) = outcome.map_err(exception)?;
    let mut report = Report::of_bake(&file.garment, &baked, counts);
    report.method = quality.step_options().method.name().to_owned();
    report.wall_s = started.elapsed().as_secs_f64();
    report.warnings.splice(0..0, file.repairs());
    let run = json!({
        "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
        "method": report.method,
        "quality": quality.name(),
        "memory": if memory { "on" } else { "off" },
        "simulated_s": baked.report.simulated,
        "steps": baked.report.steps,
    });
    let sidecar = sidecar(&file, &baked.worn, &fabric, json!(script), run)?;
    Ok(PyWorn {
        worn: baked.worn,
        sidecar,
        report: report.to_json(),
        warnings: report.warnings.clone(),
        converged: baked.report.unconverged_reason.is_none(),
        file,
    })
}

fn sidecar(
    file: &GarmentFile,
    worn: &WornGarment,
    fabric: &Fabric,
    wear: Value,
    run: Value,
) -> PyResult<Sidecar> {
    Sidecar::new(&file.asset, &file.garment, worn, json!(fabric), wear, run).map_err(exception)
}

/// Reads one sidecar, or a list of them; each is an object or a file.
fn sidecars(value: &Bound<'_, PyAny>) -> PyResult<Vec<Sidecar>> {
    let one = |value: &Bound<'_, PyAny>| -> PyResult<Sidecar> {
        match value.cast::<PySidecar>() {
            Ok(own) => Ok(own.get().0.clone()),
            Err(_) => Sidecar::load(value.extract::<PathBuf>()?).map_err(exception),
        }
    };
    match value.cast::<PySidecar>().is_ok() || value.extract::<PathBuf>().is_ok() {
        true => Ok(vec![one(value)?]),
        false => value.try_iter()?.map(|entry| one(&entry?)).collect(),
    }
}

#[pyfunction]
#[pyo3(signature = (sidecars, to, *, fabric = None, match_by = "auto", align = "auto", strength = 1.0, unit = None, part = None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn transfer(
    py: Python<'_>,
    sidecars: &Bound<'_, PyAny>,
    to: &Bound<'_, PyAny>,
    fabric: Option<&str>,
    match_by: &str,
    align: &str,
    strength: f64,
    unit: Option<f64>,
    part: Option<String>,
) -> PyResult<PyWorn> {
    let wrong = |name: &str, value: &str, known: &str| {
        CreaseError::new_err(format!("{name}: {value} is none of {known}"))
    };
    let match_by = match match_by {
        "auto" => MatchBy::Auto,
        "uv" => MatchBy::Uv,
        "surface" => MatchBy::Surface,
        "same" => MatchBy::Same,
        other => return Err(wrong("match_by", other, "auto, uv, surface, same")),
    };
    let align = match align {
        "auto" => Align::Auto,
        "joints" => Align::Joints,
        "box" => Align::Box,
        "none" => Align::InPlace,
        other => return Err(wrong("align", other, "auto, joints, box, none")),
    };
    if !(strength >= 0.0 && strength.is_finite()) {
        return Err(CreaseError::new_err(format!("strength: {strength} is no number of at least 0")));
    }
    let from = self::sidecars(sidecars)?;
    let sources: Vec<TransferSource> = from
        .iter()
        .map(|sidecar| TransferSource::from_sidecar("sidecar", sidecar))
        .collect::<crease::Result<_>>()
        .map_err(exception)?;
    let file = garment(to, unit, part)?;
    let fabric = match (fabric, from.first().map(|sidecar| &sidecar.fabric)) {
        (Some(name), _) => self::fabric(name)?,
        (None, Some(Value::Object(own))) => {
            Fabric::parse("sidecar: fabric", &json!(own).to_string()).map_err(exception)?
        }
        _ => self::fabric(crease::DEFAULT_FABRIC)?,
    };
    let (carried, relaxed) = py
        .detach(|| {
            let target = GarmentSurface::from_garment(&file.garment, &file.asset);
            let transfer = Transfer::between(&sources, &target).target_joints(&file.asset);
            let transfer = transfer.match_by(match_by).align(align).strength(strength);
            let make = |drawn: DrawnCreases| mesh_along_creases(&file.garment, drawn);
            let carried = transfer.run_along_creases(&file.garment, &make)?;
            let relaxed = relax_carried(&file.garment, &fabric, &carried);
            Ok((carried, relaxed))
        })
        .map_err(exception)?;
    let worn = WornGarment { displacement: relaxed.displacement, memory: carried.memory };
    let run =
        json!({"tool": concat!("crease ", env!("CARGO_PKG_VERSION")), "transfer": {"strength": strength}});
    let mut sidecar = sidecar(&file, &worn, &fabric, Value::Null, run)?;
    sidecar.triangles.confidence = Some(carried.confidence);
    let converged = relaxed.unconverged_reason.is_none();
    let report = json!({"points": file.garment.points.len(), "warnings": relaxed.warnings}).to_string();
    Ok(PyWorn { file, worn, sidecar, report, warnings: relaxed.warnings, converged })
}

#[pyfunction]
#[allow(clippy::type_complexity, reason = "a pair of arrays")]
pub fn sheet<'py>(
    py: Python<'py>,
    size: [f64; 2],
    cells: [u32; 2],
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
    let garment = GarmentFile::sheet(size, cells).map_err(exception)?.garment;
    let triangles: Vec<[u32; 3]> = garment.triangles.iter().map(|t| t.map(|p| p.0)).collect();
    Ok((vectors(py, &garment.points)?, rows(py, &triangles)?))
}

#[pyfunction]
pub fn fabrics() -> Vec<&'static str> {
    Fabric::preset_names()
}

#[pyfunction]
pub fn scripts() -> Vec<&'static str> {
    WearScript::preset_names().collect()
}
