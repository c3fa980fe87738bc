//! The garment of a job: a file, or one that is read already; refined beyond its file, if that is asked for.

use crate::files::GarmentFile;
use crease_geometry::mesh::PointIndex;
use crease_io::{ReadOptions, Sidecar};
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, WornGarment};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Garment that a job starts from.
#[derive(Debug)]
pub enum GarmentSource {
    /// A mesh file.
    File {
        /// Path; `-` for the standard input.
        path: PathBuf,
        /// Unit, axis, parts and masks.
        reading: ReadOptions,
    },
    /// A garment in memory.
    Read(Box<GarmentFile>),
}

/// Garment of a job, and where it comes from.
#[derive(Debug)]
pub struct ReadGarment {
    /// Content of the file and garment, refined.
    pub mesh: GarmentFile,
    /// File that it was read from.
    pub path: Option<PathBuf>,
    /// Options that it was read with.
    pub reading: ReadOptions,
    /// Outcome of the refinement.
    pub refinement: Option<Refinement>,
}

impl GarmentSource {
    /// Path of the file.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File { path, .. } => Some(path),
            Self::Read(_) => None,
        }
    }

    /// Reads the garment.
    pub(super) fn read(self) -> Result<ReadGarment> {
        let (mesh, path, reading) = match self {
            Self::File { path, reading } => (GarmentFile::load(&path, &reading)?, Some(path), reading),
            Self::Read(mesh) => (*mesh, None, ReadOptions::default()),
        };
        Ok(ReadGarment { mesh, path, reading, refinement: None })
    }
}

impl ReadGarment {
    /// Path of the file, or the name of a garment in memory.
    pub fn name(&self) -> &Path {
        self.path.as_deref().unwrap_or(Path::new(&self.mesh.asset.file))
    }

    /// Refines the garment to edges of about `resolution_mm` [mm], if that is given, around the points that `selected` flags: one
    /// flag per point, or none for the whole garment.
    ///
    /// # Errors
    /// A resolution that would make more points than any machine bakes.
    pub fn refine(
        &mut self,
        resolution_mm: Option<f64>,
        selected: impl FnOnce(&Garment) -> Vec<bool>,
    ) -> Result<()> {
        let Some(mm) = resolution_mm else { return Ok(()) };
        let file = self.name().display().to_string();
        self.refinement = Some(Refinement::of(&file, &mut self.mesh.garment, mm, selected)?);
        Ok(())
    }

    /// Returns the sidecar of `worn`; `run` describes the run.
    pub(super) fn sidecar(
        &self,
        worn: &WornGarment,
        fabric: &Fabric,
        wear: Value,
        run: Value,
    ) -> Result<Sidecar> {
        Sidecar::new(&self.mesh.asset, &self.mesh.garment, worn, json!(fabric), wear, run)
    }

    /// Garment as its file has it, before the refinement.
    pub fn coarse(&self) -> &Garment {
        let coarse = self.refinement.as_ref().and_then(|refinement| refinement.coarse.as_ref());
        coarse.map_or(&self.mesh.garment, |coarse| &coarse.garment)
    }
}

/// Most points of a refined garment.
const MAX_REFINED_POINTS: f64 = 1e6;

/// Outcome of refining a garment.
#[derive(Debug)]
pub struct Refinement {
    /// Description for the report.
    pub note: String,
    /// Garment of the file; `None` where it was fine enough.
    pub coarse: Option<CoarseGarment>,
}

/// Garment as its file has it, before refining.
#[derive(Debug)]
pub struct CoarseGarment {
    /// The garment.
    pub garment: Garment,
    /// Per triangle of the refined garment: the triangle of the file that contains it.
    pub parent: Vec<u32>,
}

impl Refinement {
    /// Refines `garment`, of the file `file`, to edges of about `mm` [mm] around the points that `selected` flags: one flag per point,
    /// or none for the whole garment.
    ///
    /// # Errors
    /// A resolution that would make more points than any machine bakes.
    pub fn of(
        file: &str,
        garment: &mut Garment,
        mm: f64,
        selected: impl FnOnce(&Garment) -> Vec<bool>,
    ) -> Result<Self> {
        let edge = garment.mean_edge();
        let selected = selected(garment);
        let count = expected_points(garment, &selected, 1e-3 * mm);
        if count > MAX_REFINED_POINTS {
            let message = Message::from(Setting::Resolution.to_number(mm.to_string()))
                + format!(" would make about {:.1} million points", 1e-6 * count);
            let finest = mm * (count / MAX_REFINED_POINTS).sqrt();
            let finest = format!("{:.1}", (10.0 * finest).ceil() / 10.0);
            let help = Message::from("at most a million can be simulated: ")
                + Setting::Resolution.to_number(finest)
                + " or coarser";
            return Err(Error::input(file, "", message, help));
        }
        let refined = garment.refine(1e-3 * mm, &selected);
        let (before, after) = (garment.points.len(), refined.garment.points.len());
        if after == before {
            let note = format!(
                "resolution: the edges of the file are not longer than {mm} mm ({:.1} mm on average)",
                1e3 * edge
            );
            return Ok(Self { note, coarse: None });
        }
        let region = if selected.is_empty() { "" } else { " where the body can move it" };
        let note = format!("resolution: {after} points instead of {before}, edges of about {mm} mm{region}");
        let coarse = std::mem::replace(garment, refined.garment);
        Ok(Self { note, coarse: Some(CoarseGarment { garment: coarse, parent: refined.parent }) })
    }
}

/// Number of points of `garment` with edges of `edge` [m] where `selected` flags a corner, or everywhere without flags.
fn expected_points(garment: &Garment, selected: &[bool], edge: f64) -> f64 {
    let is_refined =
        |t: &[PointIndex; 3]| selected.is_empty() || t.iter().any(|p| selected.get(p.at()) == Some(&true));
    let refined = garment.triangles.iter().zip(&garment.material).filter(|(t, _)| is_refined(t));
    let area: f64 = refined.map(|(_, m)| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs()).sum();
    // Equilateral triangles, two per point.
    garment.points.len() as f64 + area / (0.75f64.sqrt() * edge * edge)
}
