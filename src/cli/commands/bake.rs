//! `crease bake`: the main job. Reads a mesh, a wear script and a fabric; writes the worn garment, its sidecar and the
//! report, all three or none.
//!
//! Everything that can be refused is refused before the long part: files are read, outputs tried, and the worn garment
//! written once without wear.

use crate::cli::args::body::BodyArgs;
use crate::cli::args::common::{MeshReading, glb_path, positive, seconds};
use crate::cli::args::export;
use crate::cli::args::export::ExportArgs;
use crate::cli::args::refine::{Finer, RefineArgs};
use crate::cli::files::checkpoints::CheckpointFile;
use crate::cli::files::frames::FrameFolder;
use crate::cli::files::input;
use crate::cli::files::mesh_file::MeshFile;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crate::cli::runtime::interrupt::Interrupt;
use crate::cli::runtime::progress::{Progress, StepNews};
use crate::cli::runtime::threads::use_threads;
use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crease::bake::{
    Bake, BakeOptions, BakeResult, Checkpoint, ModelDecision, ModelPlan, Observer, Quality, active_points,
};
use crease::body::AnimatedBody;
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::garment::{Garment, RestState, WornGarment};
use crease::io::gltf::write_worn_glb;
use crease::io::{Sidecar, write_sidecar};
use crease::math::Vec3;
use crease::mesh::intersections::self_intersections;
use crease::report::render::{Camera, encode_png};
use crease::report::{ColorBy, GarmentView, Report, crossing_counts};
use crease::sim::Method;
use crease::wear::WearScript;
use crease::{Error, Result};
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease bake shirt.glb --wear garments/wear/fold-thrice.json -o worn.glb --preview
  crease bake shirt.obj --unit cm --fabric denim --wear wear.json -o worn.glb --frames frames
  crease bake shirt.glb --wear wear.json -o worn.glb --resume    go on after Ctrl-C or a crash
  crease bake shirt.glb --wear wear.json --explain               what would be modelled, and why")]
pub struct Arguments {
    /// Garment: .obj, .gltf or .glb
    mesh: PathBuf,
    /// What is done to it: a wear script, crease-wear/1
    #[arg(long, value_name = "SCRIPT")]
    wear: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path, required_unless_present = "explain")]
    output: Option<PathBuf>,
    /// What it is made of: a name of `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    #[command(flatten)]
    reading: MeshReading,
    #[command(flatten)]
    body: BodyArgs,
    #[command(flatten)]
    finer: RefineArgs,
    /// Simulate the whole garment, including regions the body cannot reach
    #[arg(long, alias = "no-sleep")]
    simulate_all: bool,
    /// Simulate the triangles of the file, without coarsening where the script creases nothing
    #[arg(long)]
    no_grading: bool,
    #[command(flatten)]
    export: ExportArgs,
    /// Time integration [default: that of the quality]
    #[arg(long, value_name = "NAME", value_parser = method_parser())]
    method: Option<Method>,
    /// Speed against accuracy: how fine steps are, and how far each is solved
    #[arg(long, value_name = "NAME", default_value = Quality::Standard.name(), value_parser = quality_parser())]
    quality: Quality,
    /// Validation run: every model on at full size, fixed short time steps; slow
    #[arg(long, alias = "everything")]
    full_fidelity: bool,
    /// Memory law of the cloth
    #[arg(long, value_enum, default_value_t = MemoryLaw::On)]
    memory: MemoryLaw,
    /// Also draw OUT.png: the garment before and after
    #[arg(long, requires = "output")]
    preview: bool,
    /// Folder for the simulated mesh over time: frame_0000.obj ...
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Frames per second of wear
    #[arg(long, value_name = "N", value_parser = positive, default_value_t = 10.0, requires = "frames")]
    fps: f64,
    /// Worker threads [default: all cores]. Results are bit-identical for any value.
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Go on from OUT.checkpoint, if an interrupted run left one; the result is the same to the last bit
    #[arg(long)]
    resume: bool,
    /// How often OUT.checkpoint is written between the actions of the script [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = seconds)]
    checkpoint_every: f64,
    /// Say which models are on and why, with the number behind each; without -o, do no more
    #[arg(long)]
    explain: bool,
    /// The report on standard output, progress as JSON lines
    #[arg(long)]
    json: bool,
    /// No progress, errors only
    #[arg(long)]
    quiet: bool,
}

/// Size of each half of `--preview` [pixels].
const PREVIEW: [usize; 2] = [800, 600];

/// Values of `--memory`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MemoryLaw {
    /// The law of Kim, Oh and Wohn
    #[value(alias = "paper")]
    On,
    /// No memory: a purely elastic simulation
    Off,
}

/// The library's own list of integrators, by name.
fn method_parser() -> impl TypedValueParser<Value = Method> {
    let names = PossibleValuesParser::new(
        Method::ALL.iter().map(|m| PossibleValue::new(m.name()).help(m.description())),
    );
    names.try_map(|name| Method::from_name(&name).ok_or("no such method"))
}

/// The library's own list of qualities, by name.
fn quality_parser() -> impl TypedValueParser<Value = Quality> {
    let names = Quality::ALL.map(|quality| PossibleValue::new(quality.name()).help(quality.description()));
    PossibleValuesParser::new(names).try_map(|name| Quality::from_name(&name).ok_or("no such quality"))
}

impl Arguments {
    fn method(&self) -> Method {
        self.method.unwrap_or(self.quality.step().method)
    }

    fn memory_on(&self) -> bool {
        self.memory == MemoryLaw::On
    }

    fn options(&self, body: Option<&Arc<AnimatedBody>>) -> BakeOptions {
        let mut options = BakeOptions {
            memory: self.memory_on(),
            body: body.cloned(),
            deactivate_static: !self.simulate_all,
            adaptive_mesh: BakeOptions::for_quality(self.quality).adaptive_mesh && !self.no_grading,
            ..BakeOptions::for_quality(self.quality)
        };
        options.step.method = self.method();
        options.full_fidelity = self.full_fidelity;
        options.frames_per_second = if self.frames.is_some() { self.fps } else { 0.0 };
        options
    }

    /// What the sidecar says of the run. Nothing that differs from run to run: the same wear gives the same bytes.
    fn run_note(&self, baked: &BakeResult) -> Value {
        let mut note = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "method": self.method().name(),
            "quality": self.quality.name(),
            "memory": if self.memory_on() { "on" } else { "off" },
            "simulated_s": baked.report.simulated,
            "steps": baked.report.steps,
        });
        if baked.report.points != baked.end.len() {
            note["simulated_points"] = json!(baked.report.points);
        }
        note
    }
}

/// The files of a bake.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::cli) struct BakeOutputs {
    /// OUT.glb
    pub(in crate::cli) worn: PathBuf,
    /// OUT.crease.json
    pub(in crate::cli) sidecar: PathBuf,
    /// OUT.report.json
    pub(in crate::cli) report: PathBuf,
}

impl BakeOutputs {
    pub(in crate::cli) fn beside(worn: &Path) -> Self {
        Self {
            sidecar: worn.with_extension("crease.json"),
            report: worn.with_extension("report.json"),
            worn: worn.to_owned(),
        }
    }

    pub(in crate::cli) fn paths(&self) -> [&Path; 3] {
        [&self.worn, &self.sidecar, &self.report]
    }

    /// What worn meshes say of their sidecar: its name beside them.
    pub(in crate::cli) fn extras(&self) -> Value {
        let name = self.sidecar.file_name().map(|name| name.to_string_lossy().into_owned());
        json!({ "crease": { "sidecar": name } })
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    let began = Instant::now();
    let interrupt = Interrupt::listen()?;
    let mut progress = Progress::new(arguments.quiet, arguments.json);
    progress.stage("read");
    let mut outputs =
        Outputs::new([arguments.mesh.as_path(), arguments.wear.as_path(), Path::new(&arguments.fabric)]);
    let files = arguments.output.as_deref().map(BakeOutputs::beside);
    for path in files.iter().flat_map(BakeOutputs::paths) {
        outputs.check(path)?;
    }
    if let Some(files) = &files {
        arguments.export.check(&files.worn, &outputs)?;
        if arguments.preview {
            outputs.check(&files.worn.with_extension("png"))?;
        }
    }
    use_threads(arguments.threads)?;
    let mut job = Job::read(&arguments)?;
    if arguments.explain && !(arguments.json && files.is_some()) {
        explain(&job.plan(&arguments), arguments.json)?;
    }
    let Some(files) = files else { return Ok(()) };
    let extras = files.extras();
    let mut warnings = job.mesh.repairs();
    warnings.extend(job.refined.as_ref().map(|finer| finer.told.clone()));
    warnings.extend(job.mesh.embed_images(&arguments.mesh));
    job.try_to_write(&extras)?;
    let start = self_intersections(&job.mesh.garment.points, &job.mesh.garment.triangles);
    let read_s = began.elapsed().as_secs_f64();

    let every = Duration::from_secs_f64(arguments.checkpoint_every);
    let mut checkpoints = CheckpointFile::beside(&files.worn, every);
    outputs.check(checkpoints.path())?;
    let (baked, left_over) = job.bake(&arguments, &mut progress, &mut checkpoints, &interrupt)?;
    warnings.extend(left_over);

    progress.stage("write");
    let write_began = Instant::now();
    let garment = &job.mesh.garment;
    let counts = crossing_counts(garment, &baked.worn, &start);
    let mut report = Report::of_bake(garment, &baked, counts);
    report.method = arguments.method().name().to_owned();
    report.warnings.extend(warnings);
    let glb = write_worn_glb(&job.mesh.asset, garment, &baked.worn, &extras)?;
    let asset = &job.mesh.asset;
    let detail = job.refined.as_ref().and_then(|finer| finer.detail(garment, &baked.worn));
    let (glb, maps, notes) = arguments.finer.add(&files.worn, &mut outputs, asset, detail, glb)?;
    report.detail_maps = maps;
    report.warnings.extend(notes);
    outputs.add(&files.worn, &glb)?;
    let sidecar = job.sidecar(&baked.worn, arguments.run_note(&baked))?;
    outputs.add(&files.sidecar, &write_sidecar(&sidecar))?;
    if arguments.preview {
        let garment_view = GarmentView::of_sidecar(&input::name_of(&files.worn), &sidecar);
        let picture = garment_view.draw_before_after(ColorBy::Shape, &Camera::default(), PREVIEW)?;
        outputs.add(&files.worn.with_extension("png"), &encode_png(&picture)?)?;
    }
    report.exports =
        arguments.export.add(&files.worn, &mut outputs, asset, garment, &baked.worn, &job.fabric)?;
    report.stages.add("read", read_s);
    report.stages.add("write", write_began.elapsed().as_secs_f64());
    report.wall_s = began.elapsed().as_secs_f64();
    outputs.add(&files.report, report.to_json().as_bytes())?;
    outputs.commit()?;
    checkpoints.remove();
    progress.finish();
    tell(&arguments, &files, &report)?;
    match &baked.report.unconverged_reason {
        Some(what) => Err(Error::NotConverged(format!(
            "{what}; what was reached is in {}",
            input::name_of(&files.worn)
        ))),
        None => Ok(()),
    }
}

/// What a bake is made from, read and checked.
#[derive(Debug)]
struct Job {
    mesh: MeshFile,
    script: WearScript,
    script_file: String,
    fabric: Fabric,
    body: Option<Arc<AnimatedBody>>,
    /// What `--resolution` did.
    refined: Option<Finer>,
}

impl Job {
    /// Reads everything before anything long begins, and reports the faults of all files in one go.
    fn read(arguments: &Arguments) -> Result<Self> {
        let script_file = input::name_of(&arguments.wear);
        let script = script(&script_file, &arguments.wear, arguments.body.body.is_some());
        let fabric = input::fabric(&arguments.fabric);
        let mesh = MeshFile::read(&arguments.mesh, &arguments.reading);
        match (script, fabric, mesh) {
            (Ok(script), Ok(fabric), Ok(mut mesh)) => {
                let body = arguments.body.read(&arguments.mesh, &arguments.reading, &mesh)?;
                let options = arguments.options(body.as_ref());
                let stirred = |garment: &Garment| active_points(garment, &script, &options);
                let refined = arguments.finer.refine(&mut mesh.garment, stirred);
                Ok(Self { mesh, script, script_file, fabric, body, refined })
            }
            (script, fabric, mesh) => {
                Err(merged([script.err(), fabric.err(), mesh.err()].into_iter().flatten()))
            }
        }
    }

    fn plan(&self, arguments: &Arguments) -> ModelPlan {
        let options = arguments.options(self.body.as_ref());
        ModelPlan::for_simulated_mesh(&self.mesh.garment, &self.fabric, &self.script, &options)
    }

    /// Writes the garment without wear, to nowhere: what the writers refuse is told now and not after the bake.
    fn try_to_write(&self, extras: &Value) -> Result<()> {
        let garment = &self.mesh.garment;
        let unworn = WornGarment {
            displacement: vec![Vec3::zeros(); garment.points.len()],
            memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
        };
        write_worn_glb(&self.mesh.asset, garment, &unworn, extras)?;
        self.sidecar(&unworn, Value::Null).map(drop)
    }

    fn sidecar(&self, worn: &WornGarment, run: Value) -> Result<Sidecar> {
        let (fabric, wear) = (json!(self.fabric), json!(self.script));
        Sidecar::new(&self.mesh.asset, &self.mesh.garment, worn, fabric, wear, run)
    }

    /// The long part; also what to say about frames.
    fn bake(
        &self,
        arguments: &Arguments,
        progress: &mut Progress,
        checkpoints: &mut CheckpointFile,
        interrupt: &Interrupt,
    ) -> Result<(BakeResult, Option<String>)> {
        let resume_from = if arguments.resume { checkpoints.read()? } else { None };
        let frames_before = resume_from.as_ref().map_or(0, |(_, checkpoint)| checkpoint.counts.frames.shown);
        let frames = match &arguments.frames {
            Some(folder) => Some(FrameFolder::new(folder, &arguments.mesh, frames_before as usize)?),
            None => None,
        };
        let actions = self.script.flatten().count();
        let mut watcher = Watcher { progress, frames, checkpoints, interrupt, actions };
        let garment: &Garment = &self.mesh.garment;
        interrupt.ends_at_once(false);
        let mut bake = Bake::new(garment, &self.fabric, &self.script)
            .script_name(&self.script_file)
            .options(arguments.options(self.body.as_ref()));
        if let Some((file, checkpoint)) = &resume_from {
            bake = bake.resume(file, checkpoint.clone());
        }
        let baked = bake.run_with(&mut watcher)?;
        interrupt.ends_at_once(false);
        let old = watcher.frames.and_then(|frames| frames.left_over());
        let left_over = old.map(|path| {
            format!("{} and any after it are from an earlier run with more frames", path.display())
        });
        Ok((baked, left_over))
    }
}

fn script(file: &str, path: &Path, has_body: bool) -> Result<WearScript> {
    let script = WearScript::parse(file, &input::text(path)?)?;
    let faults = if has_body { Vec::new() } else { script.errors_without_body(file) };
    match faults {
        faults if faults.is_empty() => Ok(script),
        faults => Err(Error::Input(faults)),
    }
}

/// The faults of several errors as one; an error that is no list of faults goes first.
pub(in crate::cli) fn merged(errors: impl Iterator<Item = Error>) -> Error {
    let mut faults = Vec::new();
    for error in errors {
        match error {
            Error::Input(more) => faults.extend(more),
            other => return other,
        }
    }
    Error::Input(faults)
}

/// Passes on how the bake is doing.
struct Watcher<'a, 'b> {
    progress: &'a mut Progress,
    frames: Option<FrameFolder<'b>>,
    checkpoints: &'a mut CheckpointFile,
    interrupt: &'a Interrupt,
    /// Actions of the script in all.
    actions: usize,
}

impl Observer for Watcher<'_, '_> {
    fn progress(&mut self, now: &crease::bake::BakeProgress) {
        self.progress.step(
            now.stage,
            StepNews {
                simulated_s: now.time,
                total_s: now.total,
                step: now.steps,
                events: now.events.gradual + now.events.critical,
            },
        );
    }

    fn on_mesh(&mut self, mesh: &Garment) {
        if let Some(frames) = &mut self.frames {
            frames.show(&mesh.triangles);
        }
    }

    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        self.frames.as_mut().map_or(Ok(()), |frames| frames.write(x))
    }

    fn wants_checkpoints(&self) -> bool {
        true
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        let wear_is_over = now.position.action == self.actions;
        self.checkpoints.keep(now);
        if wear_is_over {
            // The way home is not interrupted step by step: what it starts from lies on the disk.
            self.checkpoints.flush();
            self.interrupt.ends_at_once(true);
        }
        Ok(())
    }

    fn should_stop(&mut self) -> bool {
        if !self.interrupt.asked() {
            return false;
        }
        self.checkpoints.flush();
        true
    }
}

/// The plan on stdout.
fn explain(plan: &ModelPlan, as_json: bool) -> Result<()> {
    if as_json {
        let list: Vec<Value> = plan
            .decisions
            .iter()
            .map(|choice| json!({"name": choice.name, "on": choice.on, "why": choice.why}))
            .collect();
        return console::data(&format!("{:#}\n", Value::Array(list)));
    }
    let line = |choice: &ModelDecision| {
        format!("{:<16}{:<5}{}\n", choice.name, if choice.on { "on" } else { "off" }, choice.why)
    };
    console::data(&plan.decisions.iter().map(line).collect::<String>())
}

/// What came out: for people, and for programs that asked.
fn tell(arguments: &Arguments, files: &BakeOutputs, report: &Report) -> Result<()> {
    if !arguments.quiet && !arguments.json {
        report.warnings.iter().for_each(|warning| console::say(&format!("warning: {warning}")));
        export::tell(&report.exports);
        console::say(&format!(
            "{}: {} points, {:.1} s of wear in {} steps and {:.1} s; {} crossings",
            files.worn.display(),
            report.points,
            report.simulated_s,
            report.steps,
            report.wall_s,
            report.crossings,
        ));
    }
    if arguments.json { console::data(&report.to_json()) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_files_go_beside_the_worn_garment() {
        let outputs = BakeOutputs::beside(Path::new("a/my.shirt.glb"));
        assert_eq!(outputs.sidecar, Path::new("a/my.shirt.crease.json"));
        assert_eq!(outputs.report, Path::new("a/my.shirt.report.json"));
        assert_eq!(outputs.extras(), json!({"crease": {"sidecar": "my.shirt.crease.json"}}));
    }
}
