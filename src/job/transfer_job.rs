//! [`TransferJob`]: a transfer of memory to another garment, from sidecars and a mesh to outputs.

use crate::bake::{RelaxResult, SimulatedGarment};
use crate::files::{GarmentFile, file_name, merge_errors, read_fabric, read_text};
use crate::job::garment_source::{CoarseGarment, GarmentSource, ReadGarment};
use crate::job::memory_source::{
    MemorySource, carried_sources, fabric_of, left_out_warning, origins, relax_target,
};
use crate::job::observer::JobObserver;
use crate::job::output_options::OutputOptions;
use crate::job::outputs::{JobOutputs, JobRecord, TOOL, failure_of};
use crate::report::{TransferReport, crossing_counts, source_crossings};
use crate::transfer::{
    CarriedOnMesh, PointPair, Transfer, TransferOptions, TransferResult, TransferSource, mesh_along_creases,
};
use crease_geometry::math::Vec3;
use crease_io::{Landmarks, Sidecar, sidecar_surface};
use crease_model::error::{Message, Result};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{ShownWear, WornGarment};
use crease_model::remesh::{Crease, GarmentSurface, WornSurface};
use serde_json::{Value, json};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// Transfer of memory to another garment: sources and options.
#[derive(Debug)]
pub struct TransferJob {
    /// Memory to transfer; several are added up.
    pub sources: Vec<MemorySource>,
    /// Target garment; its mask scales the transferred memory.
    pub target: GarmentSource,
    /// Length of edges to which the target is refined [mm]; `None` for the mesh of the file.
    pub resolution_mm: Option<f64>,
    /// Fabric of the target: the name of a preset, a file, or `-`; `None` for that of the first source.
    pub fabric: Option<String>,
    /// File of corresponding points of both garments, by which the source is aligned.
    pub landmarks: Option<PathBuf>,
    /// Options of the transfer. The job sets the landmarks, the joints, and the mask.
    pub transfer: TransferOptions,
    /// Files to write.
    pub output: OutputOptions,
}

/// Inputs of a transfer, read and checked.
struct TransferInput {
    target: ReadGarment,
    sources: Vec<TransferSource>,
    sidecars: Vec<Sidecar>,
    fabric: Fabric,
    options: TransferOptions,
}

impl TransferJob {
    /// Checks that the outputs can be written, reads the sources, transfers the memory, and relaxes the target with it.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] with every problem of the files, [`crease_model::error::Error::File`] for one that cannot be read, and those of
    /// [`Transfer::run`].
    pub fn run(mut self, observer: &mut dyn JobObserver) -> Result<JobOutputs<TransferReport>> {
        let files = self.sources.iter().map(MemorySource::path);
        let files = files.chain([self.target.path(), self.landmarks.as_deref()]).flatten();
        let mut record = JobRecord::start(std::mem::take(&mut self.output), files)?;
        let mut input = TransferInput::read(self)?;
        record.accept(&mut input.target, observer)?;
        record.warn(left_out_warning(input.target.name(), &input.target.mesh));
        record.inputs_read()?;
        let garment = &input.target.mesh.garment;
        let surface = input.surface();
        let transfer = Transfer::between(&input.sources, &surface).options(input.options.clone());
        let carried = transfer.run_along_creases(garment, &mesh_along_creases)?;
        let start = source_crossings(garment);
        let RelaxResult { displacement, on_mesh, warnings, unconverged_reason, .. } =
            relax_target(garment, &input.fabric, &input.sidecars, &carried);
        let worn = WornGarment { displacement, memory: carried.memory.clone() };
        record.warn(warnings);
        record.warn(carried.warnings.clone());
        record.warn_of_failure(carried.empty_reason.clone(), observer.words());
        let shown = ShownWear::of(&worn, garment);
        let is_worn = carried.empty_reason.is_none();
        record.warn(worn.hidden_warning(garment).or(shown.faint_warning().filter(|_| is_worn)));
        record.computed();

        let counts = crossing_counts(garment, &worn, &start);
        let report = TransferReport {
            points: garment.points.len(),
            triangles: garment.triangles.len(),
            crossings: counts.added,
            crossings_at_start: counts.at_start,
            crossings_in_result: counts.in_result,
            shown: shown.into(),
            sources: carried_sources(&input.sources, &carried),
            ..TransferReport::of_transfer(&carried, &surface)
        };
        let on_mesh = worn_on_mesh(&carried, on_mesh);
        let surface = match record.output.shows_surface() {
            true => input.worn_surface(&carried, on_mesh.as_ref())?,
            false => None,
        };
        let sidecar = input.sidecar(&worn, &carried, on_mesh.as_ref(), &report)?;
        let TransferInput { target, fabric, .. } = input;
        let mut outputs =
            JobOutputs::new(target, fabric, Some((worn, sidecar)), report, record, observer.words());
        outputs.surface = surface.map_or_else(OnceCell::new, OnceCell::from);
        outputs.converged = unconverged_reason.is_none();
        outputs.failure = failure_of(unconverged_reason.map(Message::from), carried.empty_reason);
        Ok(outputs)
    }
}

impl TransferInput {
    /// Reads all files. The errors of all of them are reported together.
    fn read(job: TransferJob) -> Result<Self> {
        let TransferJob { sources, target, resolution_mm, fabric, landmarks, transfer: mut options, .. } =
            job;
        let target = target.read();
        let first_name = sources.first().map(MemorySource::name);
        let mut read: Vec<(TransferSource, Sidecar)> = Vec::new();
        let mut errors = Vec::new();
        for source in sources {
            match source.read() {
                Ok(source) => read.push(source),
                Err(error) => errors.push(error),
            }
        }
        let fabric = match (fabric, read.first().zip(first_name)) {
            (Some(name), _) => read_fabric(&name),
            (None, Some(((_, sidecar), file))) => fabric_of(&file, sidecar),
            (None, None) => Fabric::preset(DEFAULT_FABRIC),
        };
        let landmarks = landmarks.as_deref().map_or(Ok(Vec::new()), read_landmarks);
        match (target, fabric, landmarks) {
            (Ok(mut target), Ok(fabric), Ok(landmarks)) if errors.is_empty() => {
                target.refine(resolution_mm, |_| Vec::new())?;
                let (sources, sidecars) = read.into_iter().unzip();
                options.landmarks = landmarks;
                options.joints = target.mesh.asset.worn_joints();
                options.mask = target.mesh.garment.memory_mask.clone();
                Ok(Self { target, sources, sidecars, fabric, options })
            }
            (target, fabric, landmarks) => Err(merge_errors(
                [target.err(), fabric.err(), landmarks.err()].into_iter().flatten().chain(errors),
            )),
        }
    }

    /// Returns the surface that memory is transferred to.
    fn surface(&self) -> GarmentSurface {
        let GarmentFile { asset, garment, .. } = &self.target.mesh;
        match self.target.refinement.as_ref().and_then(|refinement| refinement.coarse.as_ref()) {
            Some(CoarseGarment { garment: coarse, parent }) => GarmentSurface::from_refined(
                &GarmentSurface::from_garment(coarse, asset),
                garment,
                asset,
                parent,
            ),
            None => GarmentSurface::from_garment(garment, asset),
        }
    }

    /// Returns what was worn on the mesh that the target was relaxed on; for memory that was
    /// transferred unchanged, on the mesh that its sidecar holds. `None` where the memory is on the target's own triangles only.
    fn worn_surface(
        &self,
        carried: &TransferResult,
        on_mesh: Option<&SimulatedGarment>,
    ) -> Result<Option<WornSurface>> {
        let width = self.fabric.crease_width();
        if let Some(SimulatedGarment { garment, worn }) = on_mesh {
            let mesh = GarmentSurface::without_texture(garment);
            return Ok(Some(WornSurface::new(&mesh, worn, width)));
        }
        let own = self.sidecars.first().filter(|_| carried.unchanged);
        let Some(own) = own.and_then(|sidecar| sidecar.simulated.as_deref()) else { return Ok(None) };
        let (mesh, memory) = sidecar_surface(&self.target.mesh.asset.file, own)?;
        let worn = WornGarment { displacement: own.worn().displacement, memory };
        Ok(Some(WornSurface::new(&mesh, &worn, width)))
    }

    fn sidecar(
        &self,
        worn: &WornGarment,
        carried: &TransferResult,
        on_mesh: Option<&SimulatedGarment>,
        report: &TransferReport,
    ) -> Result<Sidecar> {
        let from = origins(&self.sidecars, &report.sources);
        let TransferOptions { strength, channels, mirror_x, .. } = self.options;
        let only = match (channels.creases, channels.bagging) {
            (true, false) => Some("creases"),
            (false, true) => Some("bagging"),
            _ => None,
        };
        let run = json!({
            "tool": TOOL,
            "transfer": {
                "from": from,
                "strength": strength,
                "mask": self.target.reading.mask,
                "only": only,
                "mirror": mirror_x.then_some("x"),
            },
        });
        let mut sidecar = self.target.sidecar(worn, &self.fabric, Value::Null, run)?;
        sidecar.triangles.confidence = Some(carried.confidence.clone());
        let own = self.sidecars.first().filter(|_| carried.unchanged);
        match (own, on_mesh) {
            (Some(own), _) => {
                Ok(Sidecar { creases: own.creases.clone(), simulated: own.simulated.clone(), ..sidecar })
            }
            (None, Some(on_mesh)) => {
                let surface = GarmentSurface::without_texture(&on_mesh.garment);
                let (garment, width) = (&self.target.mesh.garment, self.fabric.crease_width());
                sidecar
                    .with_creases(&Crease::find(&surface, &on_mesh.worn.memory, garment, width))?
                    .with_simulated(&on_mesh.garment, &on_mesh.worn)
            }
            (None, None) => Ok(sidecar),
        }
    }
}

/// The mesh that the target of `carried` was relaxed on, `displacement` being that of its points [m], with what was worn.
fn worn_on_mesh(carried: &TransferResult, displacement: Option<Vec<Vec3>>) -> Option<SimulatedGarment> {
    let CarriedOnMesh { mesh, memory } = carried.on_mesh.as_ref()?;
    let worn = WornGarment { displacement: displacement?, memory: memory.clone() };
    Some(SimulatedGarment { garment: mesh.garment.clone(), worn })
}

/// Reads the source and target position of each landmark of the file `path` [m].
fn read_landmarks(path: &Path) -> Result<Vec<PointPair>> {
    let landmarks = Landmarks::parse(&file_name(path), &read_text(path)?)?;
    Ok(landmarks.position_pairs().into_iter().map(PointPair::from).collect())
}
