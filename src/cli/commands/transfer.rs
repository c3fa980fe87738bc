//! `crease transfer`: memory that one garment earned, on another. Reads sidecars and a mesh, settles the mesh with what
//! came over; writes the worn garment, its sidecar and the report, all or none.

use crate::cli::args::common::{MeshReading, glb_path};
use crate::cli::args::export;
use crate::cli::args::export::ExportArgs;
use crate::cli::args::refine::{Finer, RefineArgs};
use crate::cli::commands::bake::{BakeOutputs, merged};
use crate::cli::files::input;
use crate::cli::files::mesh_file::MeshFile;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crate::cli::runtime::threads::use_threads;
use clap::ValueEnum;
use crease::bake::{RelaxResult, relax};
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::garment::WornGarment;
use crease::io::gltf::write_worn_glb;
use crease::io::{Landmarks, Sidecar, read_sidecar, write_sidecar};
use crease::mesh::intersections::self_intersections;
use crease::report::{CarriedSource, TransferReport, crossing_counts};
use crease::transfer::{
    Align, Channels, GarmentSurface, MatchBy, PointPair, Transfer, TransferResult, TransferSource,
};
use crease::{Error, Result};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Memories to carry over, as `crease bake` wrote them; several lie on one another
    #[arg(required = true, value_name = "SIDECAR")]
    sidecars: Vec<PathBuf>,
    /// Garment they go to: .obj, .gltf or .glb
    #[arg(long, value_name = "MESH")]
    to: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// How points of both garments are matched
    #[arg(long = "match", alias = "by", value_enum, default_value_t = Matching::Auto)]
    match_by: Matching,
    /// How garments are laid over one another before places are matched by surface
    #[arg(long, value_enum, default_value_t = Laying::Auto)]
    align: Laying,
    /// Places of both garments that belong together (`crease schema landmarks`); they lay one over the other
    #[arg(long, value_name = "FILE", conflicts_with = "align")]
    landmarks: Option<PathBuf>,
    /// Multiplies every change: 0 for none, 1 as it is
    #[arg(long, value_name = "S", value_parser = strength, default_value_t = 1.0)]
    strength: f64,
    /// Vertex attribute of MESH that scales what is carried, 0 to 1: COLOR_0, COLOR_0.g, _MASK, ...
    #[arg(long, value_name = "ATTRIBUTE")]
    mask: Option<String>,
    /// Carry only creases (rest angles, stiffness) or only bagging (rest lengths) [default: both]
    #[arg(long, value_enum)]
    only: Option<Only>,
    /// Mirror the memory left to right
    #[arg(long, value_enum, value_name = "AXIS")]
    mirror: Option<Axis>,
    /// What MESH is made of: a name of `crease fabric list`, or a fabric file [default: the fabric of the first sidecar]
    #[arg(long, value_name = "NAME|FILE")]
    fabric: Option<String>,
    #[command(flatten)]
    reading: MeshReading,
    #[command(flatten)]
    finer: RefineArgs,
    #[command(flatten)]
    export: ExportArgs,
    /// Worker threads [default: all cores]. Results are bit-identical for any value.
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// The report on standard output
    #[arg(long)]
    json: bool,
    /// Errors only
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Matching {
    /// By texture where both textures agree, else by surface; the same mesh number by number
    Auto,
    /// By texture coordinates
    Uv,
    /// By place on the surface, boxes laid over one another
    Surface,
    /// Number by number; refused unless the mesh is the same
    Same,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Laying {
    /// As they stand, if most of MESH lies close to the source there; else by joints, else by their boxes
    Auto,
    /// By the joints of one skeleton that both follow
    Joints,
    /// The source's box becomes that of MESH
    Box,
    /// No alignment: both garments keep the coordinates of their files, as garments of one body do
    #[value(alias = "place")]
    None,
}

impl From<Laying> for Align {
    fn from(laying: Laying) -> Self {
        match laying {
            Laying::Auto => Self::Auto,
            Laying::Joints => Self::Joints,
            Laying::Box => Self::Box,
            Laying::None => Self::InPlace,
        }
    }
}

impl From<Matching> for MatchBy {
    fn from(matching: Matching) -> Self {
        match matching {
            Matching::Auto => Self::Auto,
            Matching::Uv => Self::Uv,
            Matching::Surface => Self::Surface,
            Matching::Same => Self::Same,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Only {
    /// Rest angles and stiffness
    Creases,
    /// Rest lengths
    Bagging,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Axis {
    /// Left to right
    X,
}

fn strength(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number from 0 up".to_owned()),
    }
}

impl Arguments {
    fn transfer<'a>(&self, job: &'a Job, target: &'a GarmentSurface) -> Transfer<'a> {
        let channels =
            Channels { creases: self.only != Some(Only::Bagging), bagging: self.only != Some(Only::Creases) };
        Transfer::between(&job.sources, target)
            .target_joints(&job.mesh.asset)
            .match_by(self.match_by.into())
            .align(self.align.into())
            .landmarks(job.landmarks.clone())
            .strength(self.strength)
            .mask(job.mesh.garment.memory_mask.clone())
            .channels(channels)
            .mirror_x(self.mirror.is_some())
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    let began = Instant::now();
    use_threads(arguments.threads)?;
    let files = BakeOutputs::beside(&arguments.output);
    let sidecars = arguments.sidecars.iter().map(PathBuf::as_path);
    let inputs = sidecars.chain([arguments.to.as_path()]).chain(arguments.landmarks.as_deref());
    let mut outputs = Outputs::new(inputs);
    for path in files.paths() {
        outputs.check(path)?;
    }
    arguments.export.check(&files.worn, &outputs)?;
    let mut job = Job::read(&arguments)?;
    let mut warnings = job.mesh.repairs();
    warnings.extend(job.refined.as_ref().map(|finer| finer.told.clone()));
    warnings.extend(job.mesh.embed_images(&arguments.to));
    let garment = &job.mesh.garment;
    let target = job.target();
    let carried = arguments.transfer(&job, &target).run()?;
    let start = self_intersections(&garment.points, &garment.triangles);
    let RelaxResult { displacement, warnings: more, unconverged_reason, .. } = job.settled(&carried);
    warnings.extend(more);
    let worn = WornGarment { displacement, memory: carried.memory.clone() };

    let counts = crossing_counts(garment, &worn, &start);
    let mut report = TransferReport {
        points: garment.points.len(),
        triangles: garment.triangles.len(),
        crossings: counts.made,
        crossings_at_start: counts.at_start,
        sources: job.carried_sources(&carried),
        ..TransferReport::of(&carried, &target)
    };
    report.warnings.extend(warnings);
    let glb = write_worn_glb(&job.mesh.asset, garment, &worn, &files.extras())?;
    let detail = job.refined.as_ref().and_then(|finer| finer.detail(garment, &worn));
    let (glb, maps, notes) = arguments.finer.add(&files.worn, &mut outputs, &job.mesh.asset, detail, glb)?;
    report.detail_maps = maps;
    report.warnings.extend(notes);
    outputs.add(&files.worn, &glb)?;
    let sidecar = job.sidecar(&arguments, &worn, &carried, &report)?;
    outputs.add(&files.sidecar, &write_sidecar(&sidecar))?;
    let asset = &job.mesh.asset;
    report.exports = arguments.export.add(&files.worn, &mut outputs, asset, garment, &worn, &job.fabric)?;
    report.wall_s = began.elapsed().as_secs_f64();
    outputs.add(&files.report, report.to_json().as_bytes())?;
    outputs.commit()?;
    tell(&arguments, &files, &report)?;
    unconverged_reason.map_or(Ok(()), |what| Err(Error::NotConverged(what)))
}

/// What a transfer is made from, read and checked.
struct Job {
    mesh: MeshFile,
    /// What `--resolution` did.
    refined: Option<Finer>,
    sources: Vec<TransferSource>,
    sidecars: Vec<Sidecar>,
    fabric: Fabric,
    /// Source and target place of each [m].
    landmarks: Vec<PointPair>,
}

impl Job {
    /// Reads everything, and reports the faults of all files in one go.
    fn read(arguments: &Arguments) -> Result<Self> {
        let mesh = MeshFile::read_masked(&arguments.to, &arguments.reading, arguments.mask.clone());
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
                let refined = arguments.finer.refine(&mut mesh.garment, |_| Vec::new());
                Ok(Self { mesh, refined, sources, sidecars, fabric, landmarks })
            }
            (mesh, fabric, landmarks) => {
                Err(merged([mesh.err(), fabric.err(), landmarks.err()].into_iter().flatten().chain(errors)))
            }
        }
    }

    /// The surface that memory goes to.
    fn target(&self) -> GarmentSurface {
        let MeshFile { asset, garment, .. } = &self.mesh;
        match self.refined.as_ref().and_then(|finer| finer.coarse.as_ref()) {
            Some((coarse, parent)) => GarmentSurface::from_refined(
                &GarmentSurface::from_garment(coarse, asset),
                garment,
                asset,
                parent,
            ),
            None => GarmentSurface::from_garment(garment, asset),
        }
    }

    /// The target at rest with what came over. Numbers taken over as they are bring their shape along.
    fn settled(&self, carried: &TransferResult) -> RelaxResult {
        if carried.unchanged
            && let Some(sidecar) = self.sidecars.first()
        {
            return RelaxResult { displacement: sidecar.worn().displacement, ..RelaxResult::default() };
        }
        relax(&self.mesh.garment, &self.fabric, &carried.memory)
    }

    fn carried_sources(&self, carried: &TransferResult) -> Vec<CarriedSource> {
        let each = self.sources.iter().zip(&carried.sources);
        each.map(|(source, outcome)| CarriedSource {
            file: source.file.clone(),
            by: outcome.matched_by.name().to_owned(),
            aligned: outcome.aligned_by.map(|by| by.name().to_owned()),
            losses: outcome.losses,
        })
        .collect()
    }

    fn sidecar(
        &self,
        arguments: &Arguments,
        worn: &WornGarment,
        carried: &TransferResult,
        report: &TransferReport,
    ) -> Result<Sidecar> {
        let from: Vec<Value> = self
            .sidecars
            .iter()
            .zip(&report.sources)
            .map(|(sidecar, source)| {
                json!({"sidecar": source.file, "by": source.by, "source": sidecar.source, "wear": sidecar.wear,
                       "run": sidecar.run})
            })
            .collect();
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

fn read_source(path: &Path) -> Result<(TransferSource, Sidecar)> {
    let file = input::name_of(path);
    let sidecar = read_sidecar(&file, &input::bytes(path)?)?;
    Ok((TransferSource::from_sidecar(&file, &sidecar)?, sidecar))
}

/// The fabric the memory was earned in.
fn fabric_of(file: &str, sidecar: &Sidecar) -> Result<Fabric> {
    match &sidecar.fabric {
        Value::Null => Fabric::preset(DEFAULT_FABRIC),
        value => Fabric::parse(&format!("{file}: fabric"), &value.to_string()),
    }
}

fn tell(arguments: &Arguments, files: &BakeOutputs, report: &TransferReport) -> Result<()> {
    if !arguments.quiet && !arguments.json {
        report.warnings.iter().for_each(|warning| console::say(&format!("warning: {warning}")));
        for source in &report.sources {
            console::say(&format!(
                "{}: by {}{}; {:.0} % of its creases left behind, {:.0} % of the target without a source",
                source.file,
                source.by,
                source.aligned.as_ref().map(|by| format!(", laid over by {by}")).unwrap_or_default(),
                100.0 * source.losses.lost_crease_fraction,
                100.0 * source.losses.unmatched_target_fraction,
            ));
        }
        export::tell(&report.exports);
        console::say(&format!(
            "{}: {} points, confidence {:.2}, {:.1} s; {} crossings",
            files.worn.display(),
            report.points,
            report.confidence,
            report.wall_s,
            report.crossings,
        ));
    }
    if arguments.json { console::data(&report.to_json()) } else { Ok(()) }
}
