//! `bake`, as `crease bake` does it without a body.

use crate::convert::{
    FileReading, ReadGarment, ReadScript, check_not_negative, choice, exception, fabric, garment, script,
    worded,
};
use crate::process::check_not_forked;
use crate::wording::PythonWords;
use crate::worn::PyWorn;
use crease::internal::bake::{Bake, BakeOptions, BakeProgress, BakeResult, Observer, Quality};
use crease::internal::files::GarmentFile;
use crease::internal::report::{CrossingCounts, Report, crossing_counts, source_crossings};
use crease_cli::files::earlier_memory::EarlierMemory;
use crease_io::Sidecar;
use crease_model::fabric::Fabric;
use crease_model::garment::mistaken_body;
use crease_solver::sim::Sewing;
use pyo3::exceptions::PyTypeError;
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

/// Inputs of a bake, read and checked.
struct BakeInput {
    file: GarmentFile,
    wear: ReadScript,
    fabric: Fabric,
    options: BakeOptions,
    /// Memory that the garment begins with.
    earlier: Option<EarlierMemory>,
    warnings: Vec<String>,
}

impl BakeInput {
    /// Checks what has been read, and reads the memory of an earlier run unless `forget`.
    fn new(
        garment: ReadGarment,
        wear: ReadScript,
        fabric: Fabric,
        options: BakeOptions,
        forget: bool,
    ) -> crease_model::error::Result<(Self, Option<PathBuf>)> {
        let ReadGarment { file, path, warnings: unread } = garment;
        let errors = wear.script.errors_without_body(&wear.name);
        if !errors.is_empty() {
            return Err(crease_model::error::Error::Input(errors));
        }
        if let Some(error) = mistaken_body(&file.asset, &file.garment) {
            return Err(error);
        }
        let mut warnings: Vec<String> = worded(file.content_warnings()).collect();
        let earlier = match path.as_deref().filter(|_| !forget) {
            Some(path) => EarlierMemory::read(path, &file)?,
            None => None,
        };
        let earlier = match earlier {
            Some(Ok(earlier)) => Some(earlier),
            Some(Err(why)) => {
                warnings.push(format!("it has been worn already, and that is left out: {why}"));
                None
            }
            None => None,
        };
        warnings.extend(earlier.as_ref().and_then(|earlier| earlier.fabric_warning(&fabric)));
        warnings.extend(worded(file.repairs()));
        warnings.extend(unread);
        Ok((Self { file, wear, fabric, options, earlier, warnings }, path))
    }

    fn run(&self, observer: &mut Reporter) -> crease_model::error::Result<(BakeResult, CrossingCounts)> {
        let garment = &self.file.garment;
        let bake = Bake::new(garment, &self.fabric, &self.wear.script)
            .script_name(&self.wear.name)
            .options(self.options.clone());
        let bake = match &self.earlier {
            Some(earlier) => bake.earlier_memory(&earlier.memory),
            None => bake,
        };
        let start = source_crossings(garment);
        let baked = bake.run_with(observer)?;
        let counts = crossing_counts(garment, &baked.worn, &start);
        Ok((baked, counts))
    }

    /// Describes the run for the sidecar as the tool does.
    fn run_description(&self, baked: &BakeResult) -> Value {
        let mut description = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "method": self.options.step().method.name(),
            "quality": self.options.quality.name(),
            "memory": if self.options.memory { "on" } else { "off" },
            "simulated_s": baked.report.simulated,
            "steps": baked.report.steps,
        });
        if self.options.strength != 1.0 {
            description["strength"] = json!(self.options.strength);
        }
        if baked.report.points != baked.end.len() {
            description["simulated_points"] = json!(baked.report.points);
        }
        if let Some(earlier) = &self.earlier {
            description["earlier"] = earlier.origin.clone();
        }
        description
    }

    /// The sidecar with the memory of the simulated mesh where that is another one.
    fn sidecar(&self, baked: &BakeResult) -> crease_model::error::Result<Sidecar> {
        let GarmentFile { asset, garment, .. } = &self.file;
        let (fabric, wear) = (json!(self.fabric), json!(self.wear.script));
        let sidecar = Sidecar::new(asset, garment, &baked.worn, fabric, wear, self.run_description(baked))?;
        match baked.simulated.garment.triangles != garment.triangles {
            true => sidecar.with_simulated(&baked.simulated.garment, &baked.simulated.worn),
            false => Ok(sidecar),
        }
    }
}

/// Wears a garment: a file, or a pair of positions [m] and triangles. `wear` is a file, the name of a script of `scripts()`, or
/// its content; `fabric` a name of `fabrics()` or a file.
#[pyfunction]
#[pyo3(signature = (garment, wear, *, fabric = None, quality = "standard", memory = true, strength = 1.0, grading = true, hems = true, seams = true, sewing_mask = None, unit = None, up = None, part = None, weld_mm = None, force_size = false, forget = false, progress = None))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn bake(
    py: Python<'_>,
    garment: &Bound<'_, PyAny>,
    wear: &Bound<'_, PyAny>,
    fabric: Option<&Bound<'_, PyAny>>,
    quality: &str,
    memory: bool,
    strength: f64,
    grading: bool,
    hems: bool,
    seams: bool,
    sewing_mask: Option<String>,
    unit: Option<&Bound<'_, PyAny>>,
    up: Option<&str>,
    part: Option<String>,
    weld_mm: Option<f64>,
    force_size: bool,
    forget: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyWorn> {
    check_not_forked()?;
    if let Some(call) = progress.as_ref().filter(|call| !call.bind(py).is_callable()) {
        let kind = call.bind(py).get_type();
        return Err(PyTypeError::new_err(format!("progress: needs a function, not {}", kind.name()?)));
    }
    check_not_negative("strength", strength)?;
    let quality = choice("quality", quality, &Quality::ALL.map(|quality| (quality.name(), quality)))?;
    let options = BakeOptions {
        quality,
        memory,
        strength,
        own_triangles: !grading,
        sewing: Sewing { hems, seams },
        ..BakeOptions::default()
    };
    let (wear, fabric) = (script(wear)?, self::fabric(fabric)?);
    let reading = FileReading { unit, up, part, weld_mm, force_size, mask: None, sewing_mask };
    let garment = self::garment("garment", garment, reading)?;
    let (input, path) = BakeInput::new(garment, wear, fabric, options, forget).map_err(exception)?;
    let mut reporter = Reporter { call: progress, last: Instant::now(), failure: None, stop: false };
    let started = Instant::now();
    let outcome = py.detach(|| input.run(&mut reporter));
    if let Some(failure) = reporter.failure {
        return Err(failure);
    }
    let (baked, counts) = outcome.map_err(exception)?;
    let mut report = Report::of_bake(&input.file.garment, &baked, counts, &PythonWords);
    report.method = input.options.step().method.name().to_owned();
    report.wall_s = started.elapsed().as_secs_f64();
    let sidecar = input.sidecar(&baked).map_err(exception)?;
    let not_performed = baked.report.not_performed.as_ref().map(crease_model::error::Diagnostic::to_message);
    let not_performed = worded(not_performed).next();
    let empty_reason = worded(baked.report.empty_reason.clone()).next();
    let failures = [&not_performed, &baked.report.unconverged_reason, &empty_reason];
    report.warnings.splice(0..0, input.warnings);
    report.warnings.extend(empty_reason.clone());
    Ok(PyWorn {
        failure: failures.into_iter().flatten().next().cloned(),
        worn: baked.worn,
        sidecar,
        report: report.to_json(),
        warnings: report.warnings,
        converged: baked.report.unconverged_reason.is_none(),
        file: input.file,
        path,
    })
}
