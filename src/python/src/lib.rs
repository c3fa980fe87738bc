//! The Python module `crease._crease`: the library over NumPy arrays, and the command-line tool.
//!
//! Types and documentation for Python are in `crease/_crease.pyi`. Arrays are copied in and out.

mod bake;
mod convert;
mod examples;
mod memory;
mod process;
mod sidecar;
mod tool;
mod transfer;
mod wording;
mod worn;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyModule;

pyo3::create_exception!(_crease, CreaseError, PyValueError);
pyo3::create_exception!(_crease, ConvergenceError, CreaseError);

#[pymodule]
fn _crease(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("CreaseError", py.get_type::<CreaseError>())?;
    module.add("ConvergenceError", py.get_type::<ConvergenceError>())?;
    module.add_class::<sidecar::PySidecar>()?;
    module.add_class::<sidecar::PyCrease>()?;
    module.add_class::<worn::PyWorn>()?;
    module.add_class::<memory::MemoryState>()?;
    module.add_function(wrap_pyfunction!(bake::bake, module)?)?;
    module.add_function(wrap_pyfunction!(transfer::transfer, module)?)?;
    module.add_function(wrap_pyfunction!(examples::sheet, module)?)?;
    module.add_function(wrap_pyfunction!(examples::fabrics, module)?)?;
    module.add_function(wrap_pyfunction!(examples::scripts, module)?)?;
    module.add_function(wrap_pyfunction!(examples::memories, module)?)?;
    module.add_function(wrap_pyfunction!(memory::advance_memory, module)?)?;
    module.add_function(wrap_pyfunction!(tool::run_tool, module)?)
}
