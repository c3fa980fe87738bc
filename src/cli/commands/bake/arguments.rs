//! Command-line arguments of `crease bake`.

use crate::args::apply::ApplyArgs;
use crate::args::body::BodyArgs;
use crate::args::export::ExportArgs;
use crate::args::mesh::ClothArgs;
use crate::args::refine::RefineArgs;
use crate::args::run::RunArgs;
use crate::args::values::{Choice, choice, glb_path, not_negative, positive, seconds};
use crate::commands::worn_job::check_stream;
use crate::files::input::check_streams;
use clap::ArgAction;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crease::internal::bake::{BakeOptions, Quality};
use crease::internal::job::{
    BakeJobOptions, BakeSources, FrameOptions, GarmentSource, OutputOptions, WearSource,
};
use crease_model::error::Result;
use crease_model::fabric::DEFAULT_FABRIC;
use crease_solver::sim::{Method, Sewing, StepOptions};
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease bake shirt.glb --wear fold-thrice -o worn.glb --preview
  crease bake shirt.obj --unit cm --fabric denim --wear wear.json -o worn.glb --frames frames
  crease bake shirt.glb --wear wear.json -o worn.glb --resume    continue after Ctrl-C or a crash
  crease bake shirt.glb --wear wear.json --explain               which models would be used, and why")]
pub struct Arguments {
    /// Garment: .obj, .gltf, .glb or USD (.usda, .usdc, .usd, .usdz); - for the standard input
    mesh: PathBuf,
    /// Wear script, crease-wear/1: a file, the name of one that `crease example` lists, or - for the standard input
    #[arg(long, help_heading = "Input", value_name = "FILE|NAME")]
    wear: PathBuf,
    /// Fabric of the garment: a name of `crease fabric list`, a fabric file, or - for the standard input
    #[arg(long, help_heading = "Input", value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    #[command(flatten, next_help_heading = "Input")]
    reading: ClothArgs,
    /// Leave out the memory of an earlier run: by default a worn MESH whose sidecar is beside it begins with what it remembers
    #[arg(long, help_heading = "Input")]
    forget: bool,
    #[command(flatten, next_help_heading = "Body")]
    body: BodyArgs,
    /// Simulate the whole garment, including regions the body cannot reach
    #[arg(long, help_heading = "Body", alias = "no-sleep")]
    simulate_all: bool,
    /// Simulate the file's own triangles instead of a mesh with edges along the fold lines of the script
    #[arg(long, help_heading = "Wear")]
    no_grading: bool,
    /// Leave open borders single; by default they are hemmed, double over 20 mm
    #[arg(long, help_heading = "Wear")]
    no_hems: bool,
    /// Leave seams single; by default the cloth is double over 10 mm on either side of them
    #[arg(long, help_heading = "Wear")]
    no_seams: bool,
    /// Factor on what the garment comes to remember, in the result: 0 for nothing, 1 for what the wear left
    #[arg(long, help_heading = "Wear", value_name = "S", allow_negative_numbers = true, value_parser = not_negative, default_value_t = 1.0)]
    strength: f64,
    /// Memory law of the cloth
    #[arg(long, help_heading = "Wear", value_parser = choice(&MEMORY), action = ArgAction::Set, default_value = "on")]
    memory: bool,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb", value_parser = glb_path, required_unless_present = "explain")]
    pub output: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Output")]
    apply: ApplyArgs,
    #[command(flatten, next_help_heading = "Output")]
    export: ExportArgs,
    /// Also draw OUT.png: the garment before and after
    #[arg(long, help_heading = "Output", requires = "output")]
    preview: bool,
    /// Meshes whose memory OUT.crease.json holds: `crease transfer` takes folds from that of the simulated one
    #[arg(
        long,
        help_heading = "Output",
        value_name = "MESH",
        value_parser = choice(&SIDECAR_MESH),
        action = ArgAction::Set,
        default_value = "simulated",
        requires = "output"
    )]
    sidecar_mesh: bool,
    /// Folder for the garment over time: frame_0000.obj, ..., its vertices in the number and order of the file
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Mesh that the frames show
    #[arg(
        long,
        help_heading = "Output",
        value_name = "MESH",
        value_parser = choice(&FRAMES_OF),
        action = ArgAction::Set,
        default_value = "garment",
        requires = "frames"
    )]
    frames_of: bool,
    /// Frames per simulated second
    #[arg(long, help_heading = "Output", value_name = "N", allow_negative_numbers = true, value_parser = positive, default_value_t = 10.0, requires = "frames")]
    fps: f64,
    #[command(flatten)]
    refine: RefineArgs,
    /// Time integrator [default: the one of the quality]
    #[arg(long, help_heading = "Quality", value_name = "NAME", value_parser = method_parser())]
    method: Option<Method>,
    /// Trade-off between speed and accuracy: time steps and solver tolerances
    #[arg(long, help_heading = "Quality", value_name = "NAME", default_value = Quality::Standard.name(), value_parser = quality_parser())]
    quality: Quality,
    /// Validation run: every model on at full size, fixed short time steps; slow
    #[arg(long, help_heading = "Quality", alias = "everything")]
    full_fidelity: bool,
    /// Continue from OUT.checkpoint if an interrupted run left one; the result is bit-identical to an uninterrupted run
    #[arg(long, help_heading = "Run")]
    pub resume: bool,
    /// Interval at which OUT.checkpoint is written within actions of the script [s]
    #[arg(long, help_heading = "Run", value_name = "SECONDS", default_value_t = 30.0, allow_negative_numbers = true, value_parser = seconds)]
    checkpoint_every: f64,
    /// Print which models are on and why, with the number behind each decision; without -o, stop there
    #[arg(long, help_heading = "Run")]
    pub explain: bool,
    #[command(flatten, next_help_heading = "Run")]
    pub run: RunArgs,
}

/// Values of `--memory`: whether the cloth has memory.
const MEMORY: [Choice<bool>; 2] =
    [("on|paper", true, "Law of Kim, Oh and Wohn"), ("off", false, "No memory: a purely elastic simulation")];

/// Values of `--sidecar-mesh`: whether the sidecar holds the simulated mesh.
const SIDECAR_MESH: [Choice<bool>; 2] = [
    ("garment", false, "The garment"),
    ("simulated", true, "The garment and, as a sidecar in the sidecar, the simulated mesh"),
];

/// Values of `--frames-of`: whether frames show the simulated mesh.
const FRAMES_OF: [Choice<bool>; 2] = [
    ("garment", false, "The garment, with the vertices of its file"),
    ("simulated", true, "The simulated mesh"),
];

/// Parser of the integrators of the library, by name.
fn method_parser() -> impl TypedValueParser<Value = Method> {
    let value = |method: &Method| PossibleValue::new(method.name()).help(method.description());
    let names = PossibleValuesParser::new(Method::ALL.iter().map(value));
    names.try_map(|name| Method::from_name(&name).ok_or("no such method"))
}

/// Parser of the qualities of the library, by name.
fn quality_parser() -> impl TypedValueParser<Value = Quality> {
    let names = Quality::ALL.map(|quality| PossibleValue::new(quality.name()).help(quality.description()));
    PossibleValuesParser::new(names).try_map(|name| Quality::from_name(&name).ok_or("no such quality"))
}

impl Arguments {
    /// Returns the options of the job.
    pub fn job_options(self) -> Result<BakeJobOptions> {
        let body = self.body.path().filter(|body| *body != self.mesh);
        check_streams(&[
            ("MESH", Some(&self.mesh)),
            ("--wear", Some(&self.wear)),
            ("--fabric", Some(Path::new(&self.fabric))),
            ("--body", body),
        ])?;
        let step = self.quality.step_options();
        let bake = BakeOptions {
            quality: self.quality,
            step: self.method.map(|method| StepOptions { method, ..step }),
            memory: self.memory,
            deactivate_static: !self.simulate_all,
            own_triangles: self.no_grading,
            strength: self.strength,
            sewing: Sewing { hems: !self.no_hems, seams: !self.no_seams },
            frames_of_simulated: self.frames_of,
            full_fidelity: self.full_fidelity,
            ..BakeOptions::default()
        };
        let output = OutputOptions {
            path: self.output,
            shape: self.apply.shape(),
            detail: self.refine.detail(),
            fine: self.refine.fine,
            exports: self.export.export,
            preview: self.preview,
        };
        check_stream(&output, self.run.json)?;
        let rate = self.fps;
        Ok(BakeJobOptions {
            sources: BakeSources {
                garment: GarmentSource::File { path: self.mesh, reading: self.reading.options() },
                wear: WearSource::File(self.wear),
                fabric: self.fabric,
                body: self.body.options(),
                resolution_mm: self.refine.resolution_mm(),
                forget: self.forget,
            },
            bake,
            frames: self.frames.map(|folder| FrameOptions { folder, rate }),
            resume: self.resume,
            checkpoint_interval: Duration::from_secs_f64(self.checkpoint_every),
            sidecar_of_simulated: self.sidecar_mesh,
            output,
        })
    }
}
