//! `Sidecar`: the memory of a garment as arrays.

use crate::convert::{exception, numbers, rows, vectors};
use crease::{Load, Save};
use crease_geometry::math::Vec3;
use crease_io::{Sidecar, SidecarCrease, read_sidecar, write_sidecar};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Content of a sidecar file: text, or bytes, plain or compressed with gzip.
#[derive(FromPyObject)]
pub enum Content {
    Text(String),
    Bytes(Vec<u8>),
}

/// A crease of a garment: a curve on its surface. All arrays are copies.
#[pyclass(name = "Crease", module = "crease", frozen)]
pub struct PyCrease(pub SidecarCrease);

#[pymethods]
impl PyCrease {
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        numbers(py, &self.0.triangles)
    }

    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.0.weights)
    }

    #[getter]
    fn angle<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.angle_rad)
    }

    #[getter]
    fn stiffness_ratio<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.stiffness_ratio)
    }

    #[getter]
    fn width(&self) -> f64 {
        self.0.width_m
    }

    fn __repr__(&self) -> String {
        format!("Crease({} places, {} mm wide)", self.0.triangles.len(), 1e3 * self.0.width_m)
    }
}

/// What worn cloth remembers. All arrays are copies.
#[pyclass(name = "Sidecar", module = "crease", frozen)]
pub struct PySidecar(pub Sidecar);

#[pymethods]
impl PySidecar {
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Sidecar::load(&path).map(Self).map_err(exception)
    }

    #[staticmethod]
    fn parse(text: Content) -> PyResult<Self> {
        let bytes = match text {
            Content::Text(text) => text.into_bytes(),
            Content::Bytes(bytes) => bytes,
        };
        read_sidecar("sidecar", &bytes).map(Self).map_err(exception)
    }

    fn save(&self, path: PathBuf) -> PyResult<()> {
        self.0.save(&path).map_err(exception)
    }

    fn to_json(&self) -> String {
        String::from_utf8_lossy(&write_sidecar(&self.0)).into_owned()
    }

    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, &self.0.mesh_points())
    }

    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.0.mesh.triangles)
    }

    #[getter]
    fn source_point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        numbers(py, &self.0.mesh.source_point)
    }

    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let moves: Vec<Vec3> = self.0.points.displacement_m.iter().map(|&d| Vec3::from(d)).collect();
        vectors(py, &moves)
    }

    #[getter]
    fn hinge_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.0.hinges.points)
    }

    #[getter]
    fn source_angle<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.hinges.source_angle_rad)
    }

    #[getter]
    fn rest_angle<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.hinges.rest_angle_rad)
    }

    #[getter]
    fn stiffness_ratio<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.hinges.stiffness_ratio)
    }

    #[getter]
    fn rest_stretch_warp<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.triangles.rest_stretch_warp)
    }

    #[getter]
    fn rest_stretch_weft<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.triangles.rest_stretch_weft)
    }

    #[getter]
    fn creases(&self) -> Vec<PyCrease> {
        self.0.creases.iter().flatten().cloned().map(PyCrease).collect()
    }

    #[getter]
    fn simulated(&self) -> Option<Self> {
        self.0.simulated.as_deref().cloned().map(Self)
    }

    fn __repr__(&self) -> String {
        format!("Sidecar({} points, {} hinges)", self.0.mesh.points_m.len(), self.0.hinges.points.len())
    }
}
