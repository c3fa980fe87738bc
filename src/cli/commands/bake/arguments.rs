//! Command-line arguments of `crease bake`.

use crate::args::apply::ApplyArgs;
use crate::args::body::BodyArgs;
use crate::args::export::ExportArgs;
use crate::args::mesh::ClothArgs;
use crate::args::refine::RefineArgs;
use crate::args::run::RunArgs;
use crate::args::values::{glb_path, not_negative, positive, seconds};
use crate::files::earlier_memory::EarlierMemory;
use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crease::internal::bake::{BakeOptions, BakeResult, Quality};
use crease_model::body::{AnimatedBody, GarmentSkin};
use crease_model::fabric::DEFAULT_FABRIC;
use crease_solver::sim::{Method, Sewing, StepOptions};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease bake shirt.glb --wear fold-thrice -o worn.glb --preview
  crease bake shirt.obj --unit cm --fabric denim --wear wear.json -o worn.glb --frames frames
  crease bake shirt.glb --wear wear.json -o worn.glb --resume    continue after Ctrl-C or a crash
  crease bake shirt.glb --wear wear.json --explain               which models would be used, and why")]
pub struct Arguments {
    /// Garment: .obj, .gltf, .glb or USD (.usda, .usdc, .usd, .usdz); - for the standard input
    pub mesh: PathBuf,
    /// Wear script, crease-wear/1: a file, the name of one that `crease example` lists, or - for the standard input
    #[arg(long, value_name = "FILE|NAME")]
    pub wear: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path, required_unless_present = "explain")]
    pub output: Option<PathBuf>,
    /// Fabric of the garment: a name of `crease fabric list`, a fabric file, or - for the standard input
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    pub fabric: String,
    #[command(flatten)]
    pub reading: ClothArgs,
    #[command(flatten)]
    pub body: BodyArgs,
    #[command(flatten)]
    pub refine: RefineArgs,
    /// Simulate the whole garment, including regions the body cannot reach
    #[arg(long, alias = "no-sleep")]
    simulate_all: bool,
    /// Simulate the file's own triangles instead of a mesh with edges along the fold lines of the script
    #[arg(long)]
    no_grading: bool,
    /// Leave open borders single; by default they are hemmed, double over 20 mm
    #[arg(long)]
    no_hems: bool,
    /// Leave out the memory of an earlier run: by default a worn MESH whose sidecar is beside it begins with what it remembers
    #[arg(long)]
    pub forget: bool,
    /// Leave seams single; by default the cloth is double over 10 mm on either side of them
    #[arg(long)]
    no_seams: bool,
    /// Factor on what the garment comes to remember, in the result: 0 for nothing, 1 for what the wear left
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = not_negative, default_value_t = 1.0)]
    strength: f64,
    #[command(flatten)]
    pub apply: ApplyArgs,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Time integrator [default: the one of the quality]
    #[arg(long, value_name = "NAME", value_parser = method_parser())]
    method: Option<Method>,
    /// Trade-off between speed and accuracy: time steps and solver tolerances
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
    pub preview: bool,
    /// Meshes whose memory OUT.crease.json holds: `crease transfer` takes folds from that of the simulated one
    #[arg(long, value_name = "MESH", default_value = "simulated", requires = "output")]
    pub sidecar_mesh: SidecarMesh,
    /// Folder for the garment over time: frame_0000.obj, ..., its vertices in the number and order of the file
    #[arg(long, value_name = "DIR")]
    pub frames: Option<PathBuf>,
    /// Mesh that the frames show
    #[arg(long, value_name = "MESH", default_value = "garment", requires = "frames")]
    pub frames_of: FramesOf,
    /// Frames per simulated second
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = positive, default_value_t = 10.0, requires = "frames")]
    pub fps: f64,
    /// Continue from OUT.checkpoint if an interrupted run left one; the result is bit-identical to an uninterrupted run
    #[arg(long)]
    pub resume: bool,
    /// Interval at which OUT.checkpoint is written within actions of the script [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, allow_negative_numbers = true, value_parser = seconds)]
    pub checkpoint_every: f64,
    /// Print which models are on and why, with the number behind each decision; without -o, stop there
    #[arg(long)]
    pub explain: bool,
    #[command(flatten)]
    pub run: RunArgs,
}

/// Values of `--memory`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MemoryLaw {
    /// Law of Kim, Oh and Wohn
    #[value(alias = "paper")]
    On,
    /// No memory: a purely elastic simulation
    Off,
}

/// Mesh whose memory a sidecar holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SidecarMesh {
    /// The garment
    Garment,
    /// The garment and, as a sidecar in the sidecar, the simulated mesh
    Simulated,
}

/// Mesh that frames show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FramesOf {
    /// The garment, with the vertices of its file
    Garment,
    /// The simulated mesh
    Simulated,
}

/// Parser of the integrators of the library, by name. Those that exist only for validation are accepted but not listed.
fn method_parser() -> impl TypedValueParser<Value = Method> {
    let value = |method: &Method| {
        let is_hidden = matches!(method, Method::Bdf2Once | Method::VertexBlockDescent);
        PossibleValue::new(method.name()).help(method.description()).hide(is_hidden)
    };
    let names = PossibleValuesParser::new(Method::ALL.iter().map(value));
    names.try_map(|name| Method::from_name(&name).ok_or("no such method"))
}

/// Parser of the qualities of the library, by name.
fn quality_parser() -> impl TypedValueParser<Value = Quality> {
    let names = Quality::ALL.map(|quality| PossibleValue::new(quality.name()).help(quality.description()));
    PossibleValuesParser::new(names).try_map(|name| Quality::from_name(&name).ok_or("no such quality"))
}

impl Arguments {
    /// Returns the time integrator.
    pub fn method(&self) -> Method {
        self.method.unwrap_or(self.quality.step_options().method)
    }

    fn memory_on(&self) -> bool {
        self.memory == MemoryLaw::On
    }

    /// Returns the options of the bake.
    pub fn options(&self, body: Option<&Arc<AnimatedBody>>, skin: Option<&Arc<GarmentSkin>>) -> BakeOptions {
        let step = self.quality.step_options();
        BakeOptions {
            quality: self.quality,
            step: self.method.map(|method| StepOptions { method, ..step }),
            finest_edge: self.refine.finest_edge(),
            memory: self.memory_on(),
            body: body.cloned(),
            skin: skin.cloned(),
            deactivate_static: !self.simulate_all,
            own_triangles: self.no_grading,
            strength: self.strength,
            sewing: Sewing { hems: !self.no_hems, seams: !self.no_seams },
            frames_of_simulated: self.frames_of == FramesOf::Simulated,
            full_fidelity: self.full_fidelity,
            frames_per_second: if self.frames.is_some() { self.fps } else { 0.0 },
            ..BakeOptions::default()
        }
    }

    /// Returns the description of the run for the sidecar. It holds nothing that differs between repeated runs, whose
    /// sidecars are identical.
    pub fn run_description(&self, baked: &BakeResult, earlier: Option<&EarlierMemory>) -> Value {
        let mut description = json!({
            "tool": concat!("crease ", env!("CARGO_PKG_VERSION")),
            "method": self.method().name(),
            "quality": self.quality.name(),
            "memory": if self.memory_on() { "on" } else { "off" },
            "simulated_s": baked.report.simulated,
            "steps": baked.report.steps,
        });
        if self.strength != 1.0 {
            description["strength"] = json!(self.strength);
        }
        if baked.report.points != baked.end.len() {
            description["simulated_points"] = json!(baked.report.points);
        }
        if let Some(earlier) = earlier {
            description["earlier"] = earlier.origin.clone();
        }
        description
    }
}
