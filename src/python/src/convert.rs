//! Values between Python and the library.

use crate::{ConvergenceError, CreaseError};
use crease::{Error, Fabric, GarmentFile, ReadOptions, Vec3};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Returns the exception of an error.
pub fn exception(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Input(_) => CreaseError::new_err(text),
        Error::File { .. } => PyOSError::new_err(text),
        Error::NotConverged(_) | Error::NotPerformed(_) | Error::Empty(_) => ConvergenceError::new_err(text),
        Error::Interrupted => PyKeyboardInterrupt::new_err(text),
    }
}

/// Returns an array of one row per entry.
pub fn rows<'py, T: numpy::Element + Copy, const N: usize>(
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
pub fn numbers<'py, T: numpy::Element + Copy>(py: Python<'py>, all: &[T]) -> Bound<'py, PyArray1<T>> {
    all.to_pyarray(py)
}

/// Reads anything that NumPy makes a list of numbers of.
pub fn list(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("ravel", (numpy.call_method1("asarray", (value, "float64"))?,))?;
    let array = array
        .cast_into::<PyArray1<f64>>()
        .map_err(|_| CreaseError::new_err(format!("{name}: no numbers")))?;
    let values = array.readonly();
    Ok(values.as_array().to_vec())
}

/// Reads rows of three.
fn rows_of_three<T: numpy::Element + Copy>(
    value: &Bound<'_, PyAny>,
    kind: &str,
    name: &str,
) -> PyResult<Vec<[T; 3]>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (value, kind))?;
    let wrong = || CreaseError::new_err(format!("{name}: needs an array of shape (n, 3)"));
    let array: PyReadonlyArray2<T> = array.extract().map_err(|_| wrong())?;
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(wrong());
    }
    Ok(array.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// Reads a garment: a file, or positions and triangles.
pub fn garment(value: &Bound<'_, PyAny>, unit: Option<f64>, part: Option<String>) -> PyResult<GarmentFile> {
    if let Ok((positions, triangles)) = value.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
        let positions = rows_of_three::<f64>(&positions, "float64", "positions")?;
        let triangles = rows_of_three::<u32>(&triangles, "uint32", "triangles")?;
        return GarmentFile::from_mesh("mesh", &positions, &triangles).map_err(exception);
    }
    let path: PathBuf = value.extract()?;
    let options = ReadOptions { unit_m: unit, garment: part, ..ReadOptions::default() };
    let mut file = value.py().detach(|| GarmentFile::load(&path, &options)).map_err(exception)?;
    file.embed_images(&path);
    Ok(file)
}

/// Returns the fabric `name`: one of the program's, or a file.
pub fn fabric(name: &str) -> PyResult<Fabric> {
    let is_file = std::path::Path::new(name).is_file();
    if is_file { Fabric::load(name) } else { Fabric::preset(name) }.map_err(exception)
}

/// Returns a JSON value as a Python object.
pub fn object<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
