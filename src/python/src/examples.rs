//! What is part of the program: a sheet of cloth, and the names of fabrics, wear scripts and memories.

use crate::CreaseError;
use crate::convert::{exception, rows, vectors};
use crate::process::check_not_forked;

use crease::format::ready_memory_names;
use crease::internal::wear::WearScript;
use crease_model::fabric::Fabric;
use crease_model::garment::Garment;
use numpy::PyArray2;
use pyo3::prelude::*;

/// Most cells of a sheet, as many as a bake could take.
const MAX_CELLS: u64 = 1_000_000;

/// Returns positions [m] and triangles of a flat rectangular sheet.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "a pair of arrays")]
pub fn sheet<'py>(
    py: Python<'py>,
    size: [f64; 2],
    cells: [i64; 2],
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
    check_not_forked()?;
    if let Some(side) = size.iter().find(|side| !(**side > 0.0 && side.is_finite())) {
        return Err(CreaseError::new_err(format!("size: {side} is no number above 0")));
    }
    let counts = cells.map(|count| u32::try_from(count).unwrap_or(0));
    let count = u64::from(counts[0]) * u64::from(counts[1]);
    if count == 0 || count > MAX_CELLS {
        let text = format!("cells: {} x {} cells; needs 1 to {MAX_CELLS}", cells[0], cells[1]);
        return Err(CreaseError::new_err(text));
    }
    let garment = Garment::sheet(size, counts).map_err(exception)?;
    let triangles: Vec<[u32; 3]> = garment.triangles.iter().map(|t| t.map(|p| p.0)).collect();
    Ok((vectors(py, &garment.points)?, rows(py, &triangles)?))
}

/// Returns the names of the fabrics of the program.
#[pyfunction]
pub fn fabrics() -> Vec<&'static str> {
    Fabric::preset_names()
}

/// Returns the names of the wear scripts of the program.
#[pyfunction]
pub fn scripts() -> Vec<&'static str> {
    WearScript::preset_names().collect()
}

/// Returns the names of the ready memories of the program.
#[pyfunction]
pub fn memories() -> Vec<&'static str> {
    ready_memory_names().collect()
}
