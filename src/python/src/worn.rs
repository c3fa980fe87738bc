//! `Worn`: the result of a bake or a transfer.

use crate::CreaseError;
use crate::convert::{exception, object, vectors};
use crate::process::check_not_forked;
use crate::sidecar::PySidecar;
use crate::wording::PythonWords;
use crease::internal::files::Outputs;
use crease::internal::job::{JobOutputs, JobReport, ReadGarment, ShapeOptions, WornPaths};
use crease_geometry::math::Vec3;
use crease_io::gltf::{DetailInput, FlatNormals, SourceShape};
use crease_io::{Sidecar, write_sidecar};
use crease_model::error::Error;
use crease_model::garment::WornGarment;
use crease_model::remesh::WornSurface;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::Value;
use std::path::PathBuf;

/// A worn garment.
#[pyclass(name = "Worn", module = "crease", frozen)]
pub struct PyWorn {
    garment: ReadGarment,
    worn: WornGarment,
    /// What was worn, on the mesh that was simulated.
    surface: WornSurface,
    sidecar: Sidecar,
    /// Report of the run, as JSON.
    report: String,
    warnings: Vec<String>,
    converged: bool,
    /// Reason why the tool would end with exit code 3.
    failure: Option<String>,
}

impl PyWorn {
    /// Takes the outputs of a job that writes no files.
    pub fn new<R: JobReport>(mut outputs: JobOutputs<R>) -> PyResult<Self> {
        outputs.write().map_err(exception)?;
        let surface = outputs.take_surface();
        let JobOutputs { garment, worn, mut report, failure, converged, .. } = outputs;
        let failure = failure.map(|error| match error {
            Error::NotConverged(reason) | Error::Empty(reason) => reason.worded(&PythonWords),
            Error::NotPerformed(reason) => reason.to_message().worded(&PythonWords),
            other => other.worded(&PythonWords),
        });
        let Some(((worn, sidecar), surface)) = worn.zip(surface) else {
            return Err(CreaseError::new_err(failure.unwrap_or_default()));
        };
        Ok(Self {
            worn,
            surface,
            sidecar,
            report: report.json(),
            warnings: report.warnings().to_vec(),
            converged,
            failure,
            garment,
        })
    }

    fn shape(apply: bool, unworn: bool, keep_normals: bool) -> PyResult<ShapeOptions> {
        check_not_forked()?;
        if !apply && !unworn {
            return Err(CreaseError::new_err("unworn: False is for apply=True only"));
        }
        let source = if unworn { SourceShape::Target } else { SourceShape::Dropped };
        let flat_normals = if keep_normals { FlatNormals::Kept } else { FlatNormals::Smoothed };
        Ok(ShapeOptions { apply: apply.then_some(source), flat_normals })
    }

    fn glb(&self, shape: ShapeOptions, extras: &Value) -> PyResult<Vec<u8>> {
        shape.glb(&self.garment.mesh, &self.worn, extras).map_err(exception)
    }

    fn fine_glb(&self, shape: ShapeOptions) -> PyResult<Vec<u8>> {
        let detail = DetailInput {
            coarse: self.garment.coarse(),
            displacement: &self.worn.displacement,
            surface: &self.surface,
            flat_normals: shape.flat_normals,
        };
        let mesh = &self.garment.mesh;
        let fine = shape.fine_glb(&mesh.asset.file, mesh, &self.worn, &detail).map_err(exception)?;
        Ok(fine.0)
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
        let of = |p: &crease_geometry::mesh::PointIndex| self.worn.displacement[p.at()];
        vectors(py, &self.garment.mesh.garment.source_point.iter().map(of).collect::<Vec<Vec3>>())
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

    #[getter]
    fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    #[pyo3(signature = (*, apply = false, unworn = true, keep_normals = false, fine = false))]
    fn to_glb<'py>(
        &self,
        py: Python<'py>,
        apply: bool,
        unworn: bool,
        keep_normals: bool,
        fine: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let shape = Self::shape(apply, unworn, keep_normals)?;
        let glb = if fine { self.fine_glb(shape)? } else { self.glb(shape, &Value::Null)? };
        Ok(PyBytes::new(py, &glb))
    }

    #[pyo3(signature = (path, *, apply = false, unworn = true, keep_normals = false, fine = false))]
    /// Writes all files whole, or none.
    fn save(&self, path: PathBuf, apply: bool, unworn: bool, keep_normals: bool, fine: bool) -> PyResult<()> {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb")) {
            let message = format!("path: {}: expected a file name that ends in .glb", path.display());
            return Err(CreaseError::new_err(message));
        }
        let files = WornPaths::beside(&path);
        let shape = Self::shape(apply, unworn, keep_normals)?;
        let glb = self.glb(shape, &files.extras())?;
        let fine = if fine { Some(self.fine_glb(shape)?) } else { None };
        let mut outputs = Outputs::new(self.garment.path.as_deref());
        let added = outputs.add(&files.worn, &glb).and_then(|()| match &files.sidecar {
            Some(path) => outputs.add(path, &write_sidecar(&self.sidecar)),
            None => Ok(()),
        });
        let added = added.and_then(|()| fine.map_or(Ok(()), |fine| outputs.add(&files.fine(), &fine)));
        added.and_then(|()| outputs.commit()).map(drop).map_err(exception)
    }

    fn __repr__(&self) -> String {
        let most = self.worn.displacement.iter().map(|d| d.norm()).fold(0.0, f64::max);
        format!(
            "Worn({} vertices, moved by up to {:.1} mm)",
            self.garment.mesh.garment.source_point.len(),
            1e3 * most
        )
    }
}
