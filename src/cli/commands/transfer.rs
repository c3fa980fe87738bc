//! `crease transfer`: transfer of memory to another garment. Reads sidecars and a mesh, relaxes the mesh with the
//! transferred memory; writes the worn garment, its sidecar and the report, all or none.

use crate::args::apply::ApplyArgs;
use crate::args::export::{ExportArgs, print_checks};
use crate::args::mesh::ClothArgs;
use crate::args::refine::{CoarseGarment, RefineArgs, Refinement};
use crate::args::run::RunArgs;
use crate::args::values::{glb_path, not_negative};
use crate::commands::worn_job::{SideFiles, WornJob, WornResult, outcome};
use crate::files::earlier_memory::left_out_warning;
use crate::files::input;
use crate::files::source::{carried_sources, fabric_of, origins, read_source, relax_target};
use crate::runtime::console;
use crate::runtime::threads::on_threads;
use crate::runtime::wording::ToolWords;
use clap::ValueEnum;
use crease::internal::bake::RelaxResult;
use crease::internal::files::GarmentFile;
use crease::internal::report::{TransferReport, crossing_counts, source_crossings};
use crease::internal::transfer::{
    Align, MatchBy, PointPair, Transfer, TransferResult, TransferSource, mesh_along_creases,
};
use crease_io::{Landmarks, ReadOptions, Sidecar};
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::WornGarment;
use crease_model::remesh::{Channels, GarmentSurface};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Sidecars of the memory to transfer, as written by `crease bake` or compressed with gzip, worn .glb files that name theirs, or
    /// names of memories that `crease example` lists; several are added up
    #[arg(required = true, value_name = "SIDECAR")]
    sidecars: Vec<PathBuf>,
    /// Target garment: .obj, .gltf, .glb or USD
    #[arg(long, value_name = "MESH")]
    to: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// Matching of points of both garments
    #[arg(long = "match", alias = "by", value_name = "MODE", value_enum, default_value_t = MatchArg::Auto)]
    match_by: MatchArg,
    /// Alignment of the source with the target before points are matched by surface
    #[arg(long, value_name = "MODE", value_enum, default_value_t = AlignArg::Auto)]
    align: AlignArg,
    /// File of corresponding points of both garments (`crease schema landmarks`), by which the source is aligned
    #[arg(long, value_name = "FILE", conflicts_with = "align")]
    landmarks: Option<PathBuf>,
    /// Factor on every change of the rest state: 0 for none, 1 for the full change
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = not_negative, default_value_t = 1.0)]
    strength: f64,
    /// Vertex attribute of MESH that scales the transferred memory, 0 to 1: COLOR_0, COLOR_0.g, _MASK, ...
    #[arg(long, value_name = "ATTRIBUTE")]
    mask: Option<String>,
    /// Transfer only creases (rest angles, stiffness) or only bagging (rest lengths) [default: both]
    #[arg(long, value_enum)]
    only: Option<Only>,
    /// Mirror the memory left to right
    #[arg(long, value_enum, value_name = "AXIS")]
    mirror: Option<Axis>,
    /// Fabric of MESH: a name of `crease fabric list`, or a fabric file [default: the fabric of the first sidecar]
    #[arg(long, value_name = "NAME|FILE")]
    fabric: Option<String>,
    #[command(flatten)]
    reading: ClothArgs,
    #[command(flatten)]
    refine: RefineArgs,
    #[command(flatten)]
    apply: ApplyArgs,
    #[command(flatten)]
    export: ExportArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Values of `--match`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MatchArg {
    /// By texture coordinates where both textures agree, else by surface; by vertex number for the same mesh
    Auto,
    /// By texture coordinates
    Uv,
    /// By position on the surface, after alignment
    Surface,
    /// By vertex number; refused unless the mesh is the same
    Same,
}

/// Values of `--align`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AlignArg {
    /// None if most of MESH is close to the source, else by joints, else by bounding boxes
    Auto,
    /// By the joints of a skeleton that both garments are bound to
    Joints,
    /// Map the bounding box of the source to that of MESH
    Box,
    /// No alignment: both garments keep the coordinates of their files, as garments of one body do
    #[value(alias = "place")]
    None,
}

impl From<AlignArg> for Align {
    fn from(argument: AlignArg) -> Self {
        match argument {
            AlignArg::Auto => Self::Auto,
            AlignArg::Joints => Self::Joints,
            AlignArg::Box => Self::Box,
            AlignArg::None => Self::InPlace,
        }
    }
}

impl From<MatchArg> for MatchBy {
    fn from(argument: MatchArg) -> Self {
        match argument {
            MatchArg::Auto => Self::Auto,
            MatchArg::Uv => Self::Uv,
            MatchArg::Surface => Self::Surface,
            MatchArg::Same => Self::Same,
        }
    }
}

/// Values of `--only`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Only {
    /// Rest angles and stiffness
    Creases,
    /// Rest lengths
    Bagging,
}

/// Values of `--mirror`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Axis {
    /// Left to right
    X,
}

impl Arguments {
    fn transfer<'a>(&self, input: &'a TransferInput, target: &'a GarmentSurface) -> Transfer<'a> {
        let channels =
            Channels { creases: self.only != Some(Only::Bagging), bagging: self.only != Some(Only::Creases) };
        Transfer::between(&input.sources, target)
            .target_joints(&input.mesh.asset)
            .match_by(self.match_by.into())
            .align(self.align.into())
            .landmarks(input.landmarks.clone())
            .strength(self.strength)
            .mask(input.mesh.garment.memory_mask.clone())
            .channels(channels)
            .mirror_x(self.mirror.is_some())
    }
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    on_threads(arguments.run.threads, || transfer(&arguments))
}

fn transfer(arguments: &Arguments) -> Result<()> {
    let side_files = SideFiles {
        apply: arguments.apply,
        detail: Some((&arguments.refine, None)),
        export: Some(&arguments.export),
        ..SideFiles::default()
    };
    let sidecars = arguments.sidecars.iter().map(PathBuf::as_path);
    let inputs = sidecars.chain([arguments.to.as_path()]).chain(arguments.landmarks.as_deref());
    let named = arguments.sidecars.iter().map(|path| ("SIDECAR", Some(path.as_path())));
    let others = [
        ("--to", Some(arguments.to.as_path())),
        ("--landmarks", arguments.landmarks.as_deref()),
        ("--fabric", arguments.fabric.as_deref().map(Path::new)),
    ];
    input::check_streams(&named.chain(others).collect::<Vec<_>>())?;
    let mut job = WornJob::start(&arguments.run, &arguments.output, inputs, side_files)?;
    let mut input = TransferInput::read(arguments)?;
    job.accept_mesh(&mut input.mesh, &arguments.to, input.refinement.as_ref())?;
    job.warn(left_out_warning(&arguments.to, &input.mesh));
    job.inputs_read();
    let garment = &input.mesh.garment;
    let target = input.target();
    let carried = arguments.transfer(&input, &target).run_along_creases(garment, &mesh_along_creases)?;
    let start = source_crossings(garment);
    let RelaxResult { displacement, warnings, unconverged_reason, .. } =
        relax_target(&input.mesh.garment, &input.fabric, &input.sidecars, &carried);
    job.warn(warnings);
    job.warn(carried.warnings.clone());
    let empty_reason = carried.empty_reason.as_ref().map(|reason| reason.worded(&ToolWords));
    job.warn_of_failure(empty_reason.as_deref());
    let worn = WornGarment { displacement, memory: carried.memory.clone() };
    job.warn(worn.hidden_warning(garment));

    let computed = Instant::now();
    let counts = crossing_counts(garment, &worn, &start);
    let report = TransferReport {
        points: garment.points.len(),
        triangles: garment.triangles.len(),
        crossings: counts.added,
        crossings_at_start: counts.at_start,
        sources: carried_sources(&input.sources, &carried),
        ..TransferReport::of_transfer(&carried, &target)
    };
    let sidecar = input.sidecar(arguments, &worn, &carried, &report)?;
    let result = WornResult {
        mesh: &input.mesh,
        worn: &worn,
        fabric: &input.fabric,
        sidecar: &sidecar,
        side_files: SideFiles { detail: Some((&arguments.refine, input.refinement.as_ref())), ..side_files },
        computed,
    };
    job.write(&result, report)?.print(print_summary)?;
    outcome(unconverged_reason, empty_reason)
}

/// Inputs of a transfer, read and checked.
struct TransferInput {
    mesh: GarmentFile,
    /// Outcome of `--resolution`.
    refinement: Option<Refinement>,
    sources: Vec<TransferSource>,
    sidecars: Vec<Sidecar>,
    fabric: Fabric,
    /// Source and target position of each landmark [m].
    landmarks: Vec<PointPair>,
}

impl TransferInput {
    /// Reads all files. The errors of all of them are reported together.
    fn read(arguments: &Arguments) -> Result<Self> {
        let options = ReadOptions { mask: arguments.mask.clone(), ..arguments.reading.options() };
        let mesh = GarmentFile::load(&arguments.to, &options);
        let (mut sources, mut sidecars, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        for path in &arguments.sidecars {
            match read_source(path) {
                Ok((source, sidecar)) => {
                    sources.push(source);
                    sidecars.push(sidecar);
                }
                Err(error) => errors.push(error),
            }
        }
        let fabric = match (&arguments.fabric, sidecars.first()) {
            (Some(name), _) => input::fabric(name),
            (None, Some(first)) => fabric_of(&input::name_of(&arguments.sidecars[0]), first),
            (None, None) => input::fabric(DEFAULT_FABRIC),
        };
        let landmarks = arguments.landmarks.as_deref().map_or(Ok(Vec::new()), |path| {
            Landmarks::parse(&input::name_of(path), &input::text(path)?)
                .map(|landmarks| landmarks.position_pairs().into_iter().map(PointPair::from).collect())
        });
        match (mesh, fabric, landmarks) {
            (Ok(mut mesh), Ok(fabric), Ok(landmarks)) if errors.is_empty() => {
                let refinement = arguments.refine.refine(&arguments.to, &mut mesh.garment, |_| Vec::new())?;
                Ok(Self { mesh, refinement, sources, sidecars, fabric, landmarks })
            }
            (mesh, fabric, landmarks) => Err(input::merge_errors(
                [mesh.err(), fabric.err(), landmarks.err()].into_iter().flatten().chain(errors),
            )),
        }
    }

    /// Returns the surface that memory is transferred to.
    fn target(&self) -> GarmentSurface {
        let GarmentFile { asset, garment, .. } = &self.mesh;
        match self.refinement.as_ref().and_then(|refinement| refinement.coarse.as_ref()) {
            Some(CoarseGarment { garment: coarse, parent }) => GarmentSurface::from_refined(
                &GarmentSurface::from_garment(coarse, asset),
                garment,
                asset,
                parent,
            ),
            None => GarmentSurface::from_garment(garment, asset),
        }
    }

    fn sidecar(
        &self,
        arguments: &Arguments,
        worn: &WornGarment,
        carried: &TransferResult,
        report: &TransferReport,
    ) -> Result<Sidecar> {
        let from = origins(&self.sidecars, &report.sources);
        let run = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "transfer": {
                "from": from,
                "strength": arguments.strength,
                "mask": arguments.mask,
                "only": arguments.only.and_then(|only| only.to_possible_value()).map(|v| v.get_name().to_owned()),
                "mirror": arguments.mirror.map(|_| "x"),
            },
        });
        let (asset, garment) = (&self.mesh.asset, &self.mesh.garment);
        let mut sidecar = Sidecar::new(asset, garment, worn, json!(self.fabric), Value::Null, run)?;
        sidecar.triangles.confidence = Some(carried.confidence.clone());
        Ok(sidecar)
    }
}

fn print_summary(worn: &str, report: &TransferReport) {
    for source in &report.sources {
        console::message(&format!(
            "{}: matched by {}{}; {:.0} % of its creases lost, {:.0} % of the target unmatched",
            source.file,
            source.by,
            match source.aligned.as_deref() {
                Some("place") => ", not aligned".to_owned(),
                Some(by) => format!(", aligned by {by}"),
                None => String::new(),
            },
            100.0 * source.losses.lost_crease_fraction,
            100.0 * source.losses.unmatched_target_fraction,
        ));
    }
    print_checks(&report.exports);
    console::message(&format!(
        "{worn}: {} points, confidence {:.2}, {:.1} s; {} crossings",
        report.points, report.confidence, report.wall_s, report.crossings,
    ));
}
