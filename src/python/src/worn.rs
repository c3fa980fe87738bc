//! `Worn`: the result of a bake or a transfer.

use crate::convert::{exception, object, vectors};
use crate::sidecar::PySidecar;
use crease::io::gltf::{SourceShape, apply_worn, write_worn_glb};
use crease::{GarmentFile, Sidecar, Vec3, WornGarment};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Value, json};
use std::path::PathBuf;

#[pyclass(name = "Worn", module = "crease", frozen)]
pub struct PyWorn {
    pub file: GarmentFile,
    pub worn: WornGarment,
    pub sidecar: Sidecar,
    /// Report of the run, as JSON.
    pub report: String,
    pub warnings: Vec<String>,
    pub converged: bool,
}

impl PyWorn {
    fn glb(&self, extras: &Value, apply: bool, unworn: bool) -> PyResult<Vec<u8>> {
        let GarmentFile { asset, garment, .. } = &self.file;
        let glb = write_worn_glb(asset, garment, &self.worn, extras).map_err(exception)?;
        let source = if unworn { SourceShape::Target } else { SourceShape::Dropped };
        if apply { apply_worn(&asset.file, &glb, source).map_err(exception) } else { Ok(glb) }
    }
}

#[pymethods]
impl PyWorn {
    #[getter]
    fn sidecar(&self) -> PySidecar {
        PySidecar(self.sidecar.clone())
    }

    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let of = |p: &crease::PointIndex| self.worn.displacement[p.at()];
        vectors(py, &self.file.garment.source_point.iter().map(of).collect::<Vec<Vec3>>())
    }

    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, &self.report)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    #[getter]
    fn converged(&self) -> bool {
        self.converged
    }

    #[pyo3(signature = (*, apply = false, unworn = true))]
    fn to_glb<'py>(&self, py: Python<'py>, apply: bool, unworn: bool) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.glb(&Value::Null, apply, unworn)?))
    }

    #[pyo3(signature = (path, *, apply = false, unworn = true))]
    fn save(&self, path: PathBuf, apply: bool, unworn: bool) -> PyResult<()> {
        let beside = path.with_extension("crease.json");
        let name = beside.file_name().map(|name| name.to_string_lossy().into_owned());
        let glb = self.glb(&json!({"crease": {"sidecar": name}}), apply, unworn)?;
        self.sidecar.save(&beside).map_err(exception)?;
        Ok(std::fs::write(path, glb)?)
    }

    fn __repr__(&self) -> String {
        let most = self.worn.displacement.iter().map(|d| d.norm()).fold(0.0, f64::max);
        format!(
            "Worn({} vertices, moved by up to {:.1} mm)",
            self.file.garment.source_point.len(),
            1e3 * most
        )
    }
}
