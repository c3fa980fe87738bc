//! `bake`, as `crease bake` does it without a body.

use crate::convert::{FileReading, check_not_negative, choice, exception, fabric, garment, script};
use crate::process::check_not_forked;
use crate::wording::PythonWords;
use crate::worn::PyWorn;
use crease::internal::bake::{BakeOptions, BakeProgress, Observer, Quality};
use crease::internal::job::{BakeJob, BakeJobOptions, BakeSources, JobObserver, OutputOptions};
use crease_model::error::Vocabulary;
use crease_solver::sim::Sewing;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
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

impl JobObserver for Reporter {
    fn words(&self) -> &'static dyn Vocabulary {
        &PythonWords
    }
}

/// Wears a garment: a file, or a pair of positions [m] and triangles. `wear` is a file, the name of a script of `scripts()`, or
/// its content; `fabric` a name of `fabrics()` or a file.
#[pyfunction]
#[pyo3(signature = (garment, wear, *, fabric = None, quality = "standard", memory = true, strength = 1.0, grading = true, hems = true, seams = true, sewing_mask = None, unit = None, up = None, part = None, weld_mm = None, force_size = false, allow_folder = None, forget = false, progress = None))]
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
    allow_folder: Option<PathBuf>,
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
    let bake = BakeOptions {
        quality,
        memory,
        strength,
        own_triangles: !grading,
        sewing: Sewing { hems, seams },
        ..BakeOptions::default()
    };
    let (wear, fabric) = (script(wear)?, self::fabric(fabric)?);
    let reading = FileReading { unit, up, part, weld_mm, force_size, allow_folder, mask: None, sewing_mask };
    let garment = self::garment("garment", garment, reading)?;
    let options = BakeJobOptions {
        sources: BakeSources { garment, wear, fabric, body: None, resolution_mm: None, forget },
        bake,
        frames: None,
        resume: false,
        checkpoint_interval: Duration::MAX,
        sidecar_of_simulated: true,
        // The worn surface, for the finer mesh; no file is written without a path.
        output: OutputOptions { fine: true, ..OutputOptions::default() },
    };
    let mut reporter = Reporter { call: progress, last: Instant::now(), failure: None, stop: false };
    let outcome = py.detach(|| BakeJob::read(options)?.run(&mut reporter));
    match reporter.failure {
        Some(failure) => Err(failure),
        None => PyWorn::new(outcome.map_err(exception)?),
    }
}
