//! `Worn`: the result of a bake or a transfer.

use crate::CreaseError;
use crate::convert::{exception, object, vectors};
use crate::process::check_not_forked;
use crate::sidecar::PySidecar;
use crease::internal::files::GarmentFile;
use crease_cli::files::output::Outputs;
use crease_cli::files::worn_outputs::WornOutputs;
use crease_geometry::math::Vec3;
use crease_io::gltf::{FlatNormals, SourceShape, apply_worn, write_worn_glb_with};
use crease_io::{Sidecar, write_sidecar};
use crease_model::garment::WornGarment;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::Value;
use std::path::PathBuf;

/// A worn garment.
#[pyclass(name = "Worn", module = "crease", frozen)]
pub struct PyWorn {
    pub file: GarmentFile,
    pub worn: WornGarment,
    pub sidecar: Sidecar,
    /// Report of the run, as JSON.
    pub report: String,
    pub warnings: Vec<String>,
    pub converged: bool,
    /// Reason why the tool would end with exit code 3.
    pub failure: Option<String>,
    /// File of the garment, which is never overwritten.
    pub path: Option<PathBuf>,
}

/// Shape and normals of a worn file.
#[derive(Clone, Copy)]
struct ShapeOptions {
    apply: bool,
    unworn: bool,
    keep_normals: bool,
}

impl PyWorn {
    fn glb(&self, extras: &Value, shape: ShapeOptions) -> PyResult<Vec<u8>> {
        check_not_forked()?;
        if !shape.apply && !shape.unworn {
            return Err(CreaseError::new_err("unworn: False is for apply=True only"));
        }
        let GarmentFile { asset, garment, .. } = &self.file;
        let normals = if shape.keep_normals { FlatNormals::Kept } else { FlatNormals::Smoothed };
        let glb = write_worn_glb_with(asset, garment, &self.worn, extras, normals).map_err(exception)?;
        let source = if shape.unworn { SourceShape::Target } else { SourceShape::Dropped };
        if shape.apply { apply_worn(&asset.file, &glb, source).map_err(exception) } else { Ok(glb) }
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

    #[getter]
    fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    #[pyo3(signature = (*, apply = false, unworn = true, keep_normals = false))]
    fn to_glb<'py>(
        &self,
        py: Python<'py>,
        apply: bool,
        unworn: bool,
        keep_normals: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.glb(&Value::Null, ShapeOptions { apply, unworn, keep_normals })?))
    }

    #[pyo3(signature = (path, *, apply = false, unworn = true, keep_normals = false))]
    /// Writes both files whole, or none.
    fn save(&self, path: PathBuf, apply: bool, unworn: bool, keep_normals: bool) -> PyResult<()> {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb")) {
            let message = format!("path: {}: expected a file name that ends in .glb", path.display());
            return Err(CreaseError::new_err(message));
        }
        let files = WornOutputs::beside(&path);
        let mut outputs = Outputs::new(self.path.as_deref());
        let glb = self.glb(&files.extras(), ShapeOptions { apply, unworn, keep_normals })?;
        let added = outputs.add(&files.worn, &glb);
        let mut sidecar = files.sidecar.iter();
        let added = added
            .and_then(|()| sidecar.try_for_each(|path| outputs.add(path, &write_sidecar(&self.sidecar))));
        added.and_then(|()| outputs.commit()).map_err(exception)
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
