//! Values between Python and the library. Errors of arguments begin with the name of the argument.

use crate::wording::PythonWords;
use crate::{ConvergenceError, CreaseError};
use crease::MeshOptions;
use crease::internal::files::GarmentFile;
use crease::internal::job::{GarmentSource, WearSource};
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_io::{ReadOptions, unit_length};
use crease_model::error::Error;
use crease_model::fabric::DEFAULT_FABRIC;
use crease_model::garment::UpAxis;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Returns the exception of an error. An error of the operating system becomes the subclass of `OSError` that Python has for it.
pub fn exception(error: Error) -> PyErr {
    let text = error.worded(&PythonWords);
    match error {
        Error::Input(problems) => {
            let line = |problem: &crease_model::error::Diagnostic| {
                let text = problem.to_message().worded(&PythonWords);
                match problem.excerpt.as_str() {
                    "" => text,
                    excerpt => format!("{text}\n{excerpt}"),
                }
            };
            CreaseError::new_err(problems.iter().map(line).collect::<Vec<_>>().join("\n"))
        }
        Error::File { file, source } => match source.raw_os_error() {
            Some(code) => PyOSError::new_err((code, system_message(&source), file)),
            None => PyOSError::new_err(text),
        },
        Error::NotConverged(_) | Error::NotPerformed(_) | Error::Empty(_) => ConvergenceError::new_err(text),
        Error::Interrupted => PyKeyboardInterrupt::new_err(text),
        _ => CreaseError::new_err(text),
    }
}

/// Returns the message of an error of the operating system without its number, which `OSError` adds.
fn system_message(source: &std::io::Error) -> String {
    let text = source.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Returns the exception for an argument of the wrong type.
pub fn wrong_type(name: &str, value: &Bound<'_, PyAny>, wanted: &str) -> PyErr {
    let kind = value.get_type().name().map_or_else(|_| "another type".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{name}: needs {wanted}, not {kind}"))
}

/// Returns the path `value`.
pub fn path(name: &str, value: &Bound<'_, PyAny>, wanted: &str) -> PyResult<PathBuf> {
    value.extract().map_err(|_| wrong_type(name, value, wanted))
}

/// Returns an array of one row per entry.
pub fn rows<'py, T: Element + Copy, const N: usize>(
    py: Python<'py>,
    all: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    all.as_flattened().to_pyarray(py).reshape([all.len(), N])
}

/// Returns positions as an array.
pub fn vectors<'py>(py: Python<'py>, all: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    rows(py, &all.iter().map(|&x| x.into()).collect::<Vec<[f64; 3]>>())
}

/// Returns numbers as an array.
pub fn numbers<'py, T: Element + Copy>(py: Python<'py>, all: &[T]) -> Bound<'py, PyArray1<T>> {
    all.to_pyarray(py)
}

/// Returns what `value`, the argument `name`, chooses among `known`.
pub fn choice<T: Copy>(name: &str, value: &str, known: &[(&str, T)]) -> PyResult<T> {
    known.iter().find(|(own, _)| *own == value).map(|(_, chosen)| *chosen).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(own, _)| *own).collect();
        CreaseError::new_err(format!("{name}: {value} is none of {}", names.join(", ")))
    })
}

/// Checks that the argument `name` is finite and at least 0.
pub fn check_not_negative(name: &str, value: f64) -> PyResult<()> {
    match value >= 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(CreaseError::new_err(format!("{name}: {value} is no number of at least 0"))),
    }
}

/// Checks that the entries of the argument `name` are above 0.
pub fn check_above_zero(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().position(|value| *value <= 0.0) {
        Some(k) => {
            Err(CreaseError::new_err(format!("{name}: entry {k} is {}, not a number above 0", values[k])))
        }
        None => Ok(()),
    }
}

/// Kinds of NumPy types that are numbers: truth values, integers, and Python objects, which may be numbers.
const NUMBER_KINDS: &str = "biufO";

/// Returns `value` as an array of numbers of the type `kind`. NumPy would read numbers from text and cut off imaginary parts.
fn array<'py>(value: &Bound<'py, PyAny>, kind: &str, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    let wrong = |why: String| CreaseError::new_err(format!("{name}: is no array of numbers: {why}"));
    let failed = |error: PyErr| wrong(error.value(value.py()).to_string());
    let own = numpy.call_method1("asarray", (value,)).map_err(failed)?;
    let own_type = own.getattr("dtype")?;
    if !NUMBER_KINDS.contains(&own_type.getattr("kind")?.extract::<String>()?) {
        return Err(wrong(format!("its type is {own_type}")));
    }
    numpy.call_method1("asarray", (own, kind)).map_err(failed)
}

/// Reads a number or a list of numbers, all of them finite.
pub fn list(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let array = array(value, "float64", name)?;
    if array.getattr("ndim")?.extract::<usize>()? > 1 {
        let shape = array.getattr("shape")?;
        return Err(CreaseError::new_err(format!(
            "{name}: needs a number or a list of numbers, not an array of shape {shape}"
        )));
    }
    let flat = array.call_method0("ravel")?;
    let values = flat.cast_into::<PyArray1<f64>>()?.readonly().as_array().to_vec();
    match values.iter().position(|value| !value.is_finite()) {
        Some(k) => {
            Err(CreaseError::new_err(format!("{name}: entry {k} is {}, not a finite number", values[k])))
        }
        None => Ok(values),
    }
}

/// Reads rows of three numbers.
fn rows_of_three<T: Element + Copy>(
    value: &Bound<'_, PyAny>,
    kind: &str,
    name: &str,
) -> PyResult<Vec<[T; 3]>> {
    let array = array(value, kind, name)?;
    let shape = array.getattr("shape")?;
    let wrong = || CreaseError::new_err(format!("{name}: needs an array of shape (n, 3), not {shape}"));
    let array: PyReadonlyArray2<T> = array.extract().map_err(|_| wrong())?;
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(wrong());
    }
    Ok(array.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// Reads triangles. NumPy would cut off fractions and wrap negative numbers around.
fn triangles(value: &Bound<'_, PyAny>, positions: usize) -> PyResult<Vec<[u32; 3]>> {
    let name = "triangles";
    let numpy = value.py().import("numpy")?;
    let kind: String = match numpy.call_method1("asarray", (value,)) {
        Ok(array) => array.getattr("dtype")?.getattr("kind")?.extract()?,
        Err(error) => {
            let why = error.value(value.py());
            return Err(CreaseError::new_err(format!("{name}: is no array of integers: {why}")));
        }
    };
    if !["i", "u"].contains(&kind.as_str()) {
        return Err(CreaseError::new_err(format!(
            "{name}: needs integers, which number the positions from 0"
        )));
    }
    let corner = |row: usize, p: i64| match u32::try_from(p) {
        Ok(corner) if (corner as usize) < positions => Ok(corner),
        _ => Err(CreaseError::new_err(format!(
            "{name}: row {row} names the position {p}, and there are {positions}, numbered from 0"
        ))),
    };
    let rows = rows_of_three::<i64>(value, "int64", name)?;
    rows.into_iter()
        .enumerate()
        .map(|(k, [a, b, c])| Ok([corner(k, a)?, corner(k, b)?, corner(k, c)?]))
        .collect()
}

/// Reads a unit of length: metres, or a name of the tool.
fn unit(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let text = match (value.extract::<f64>(), value.extract::<String>()) {
        (Ok(metres), _) => metres.to_string(),
        (_, Ok(name)) => name,
        _ => return Err(wrong_type("unit", value, "a number of metres, or m, dm, cm, mm, in")),
    };
    let wanted = "expected m, dm, cm, mm, in, or a number of metres above 0";
    unit_length(&text).ok_or_else(|| CreaseError::new_err(format!("unit: {text}: {wanted}")))
}

/// How the file of a garment is read.
#[derive(Default)]
pub struct FileReading<'a, 'py> {
    pub unit: Option<&'a Bound<'py, PyAny>>,
    pub up: Option<&'a str>,
    pub part: Option<String>,
    pub weld_mm: Option<f64>,
    pub force_size: bool,
    pub allow_folder: Option<PathBuf>,
    pub mask: Option<String>,
    pub sewing_mask: Option<String>,
}

impl FileReading<'_, '_> {
    /// Returns the options of the reader.
    fn options(self) -> PyResult<ReadOptions> {
        if let Some(mm) = self.weld_mm.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
            return Err(CreaseError::new_err(format!("weld_mm: {mm} is no number above 0")));
        }
        Ok(ReadOptions {
            unit_m: self.unit.map(unit).transpose()?,
            up: self.up.map(|up| choice("up", up, &[("y", UpAxis::Y), ("z", UpAxis::Z)])).transpose()?,
            garment: self.part,
            mask: self.mask,
            sewing_mask: self.sewing_mask,
            any_size: self.force_size,
            allow_folder: self.allow_folder,
            weld_m: self.weld_mm.map(|mm| 1e-3 * mm),
            ..ReadOptions::default()
        })
    }
}

/// Checks that nothing was given that is for files only.
fn check_no_file_options(options: &ReadOptions) -> PyResult<()> {
    let ReadOptions { garment, mask, sewing_mask, .. } = options;
    let given =
        [("part", garment.is_some()), ("mask", mask.is_some()), ("sewing_mask", sewing_mask.is_some())];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(CreaseError::new_err(format!(
            "{option}: is for files only; all triangles of arrays are the garment"
        ))),
        None => Ok(()),
    }
}

/// Returns the argument `name`, a garment: a file, or positions and triangles.
pub fn garment(name: &str, value: &Bound<'_, PyAny>, reading: FileReading) -> PyResult<GarmentSource> {
    let options = reading.options()?;
    let wanted = "the path of a file, or a pair of positions and triangles";
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok(GarmentSource::File { path, reading: options });
    }
    let Ok([positions, corners]) = value.extract::<[Bound<'_, PyAny>; 2]>() else {
        return Err(wrong_type(name, value, wanted));
    };
    check_no_file_options(&options)?;
    let positions = rows_of_three::<f64>(&positions, "float64", "positions")?;
    let triangles = triangles(&corners, positions.len())?;
    let mut mesh = MeshOptions::default().any_size(options.any_size).up(options.up.unwrap_or_default());
    (mesh.unit_m, mesh.weld_m) = (options.unit_m, options.weld_m);
    let file = value.py().detach(|| GarmentFile::from_mesh(&positions, &triangles, mesh));
    Ok(GarmentSource::Read(Box::new(file.map_err(exception)?)))
}

/// Returns the fabric of a job: the name of one of the program's, or a file; by default that of the tool.
pub fn fabric(value: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
    let Some(value) = value else { return Ok(DEFAULT_FABRIC.to_owned()) };
    let path = path("fabric", value, "a name of fabrics(), or the path of a file")?;
    Ok(path.to_string_lossy().into_owned())
}

/// Returns a wear script: a file, the name of one of the program's, or its content.
pub fn script(value: &Bound<'_, PyAny>) -> PyResult<WearSource> {
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok(WearSource::File(path));
    }
    let py = value.py();
    let mapping = py.import("collections.abc")?.getattr("Mapping")?;
    if !value.is_instance(&mapping)? {
        return Err(wrong_type("wear", value, "a name of scripts(), the path of a file, or a dict"));
    }
    let content = py.get_type::<PyDict>().call1((value,))?;
    let text = py.import("json")?.call_method1("dumps", (content,)).map_err(|error| {
        let why = error.value(py);
        PyTypeError::new_err(format!("wear: {why}"))
    })?;
    let script = WearScript::parse("wear", &text.extract::<String>()?).map_err(exception)?;
    Ok(WearSource::Script { name: "wear".to_owned(), script: Box::new(script) })
}

/// Returns a JSON value as a Python object.
pub fn object<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
