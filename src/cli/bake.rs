//! `crease bake`: the main job. Reads a mesh, a wear script and a fabric; writes the worn garment, its sidecar and the
//! report, all three or none.

use super::arguments::{MeshReading, glb_path, positive};
use super::input;
use super::output::Outputs;
use super::progress::Progress;
use clap::ValueEnum;
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::wear::WearScript;
use crease::{Error, Result};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Garment: .obj, .gltf or .glb
    mesh: PathBuf,
    /// What is done to it: a wear script, crease-wear/1
    #[arg(long, value_name = "SCRIPT")]
    wear: PathBuf,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    /// What it is made of: a name of `crease fabric list`, or a fabric file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    /// Body that wears it: a skinned or animated .glb
    #[arg(long, value_name = "BODY.glb")]
    body: Option<PathBuf>,
    #[command(flatten)]
    reading: MeshReading,
    /// Edge length of the simulated mesh [mm; default: from the bending length and the quality]
    #[arg(long, value_name = "MM", value_parser = positive)]
    resolution: Option<f64>,
    /// How much accuracy to pay for
    #[arg(long, value_enum, default_value_t = Quality::Standard)]
    quality: Quality,
    /// Time integration [default: from the quality]
    #[arg(long, value_enum, value_name = "NAME")]
    method: Option<Method>,
    /// How the cloth remembers
    #[arg(long, value_enum, default_value_t = MemoryLaw::Paper)]
    memory: MemoryLaw,
    /// Folder for the simulated mesh over time: frame_0000.obj ...
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Frames per second of wear
    #[arg(long, value_name = "N", value_parser = positive, default_value_t = 25.0, requires = "frames")]
    fps: f64,
    /// Go on from the checkpoint that an interrupted run left
    #[arg(long)]
    resume: bool,
    /// Threads [default: as many as are of use]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Say which models are on and why, with the number behind each
    #[arg(long)]
    explain: bool,
    /// The report on standard output
    #[arg(long)]
    json: bool,
    /// No progress, errors only
    #[arg(long)]
    quiet: bool,
}

/// How much accuracy to pay for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// A quick look
    Draft,
    /// For use
    Standard,
    /// For comparisons
    Reference,
}

/// Time integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// First order, robust
    BackwardEuler,
    /// Second order
    Bdf2,
}

/// How the cloth remembers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MemoryLaw {
    /// The law of Kim, Oh and Wohn
    Paper,
    /// Not at all: a plain elastic run
    Off,
}

/// What `crease bake` was asked for.
#[derive(Debug)]
pub struct BakeOptions {
    /// The garment's file.
    pub mesh: PathBuf,
    /// The wear script's file.
    pub wear: PathBuf,
    /// The three files to write.
    pub outputs: BakeOutputs,
    /// Name or file of the fabric.
    pub fabric: String,
    /// The body's file.
    pub body: Option<PathBuf>,
    /// How coordinates are to be read, and what is the garment.
    pub reading: MeshReading,
    /// Wanted edge length [m].
    pub resolution_m: Option<f64>,
    /// Quality.
    pub quality: Quality,
    /// Time integration; `None` leaves it to the quality.
    pub method: Option<Method>,
    /// Memory.
    pub memory: MemoryLaw,
    /// Frames to write.
    pub frames: Option<Frames>,
    /// Go on from a checkpoint.
    pub resume: bool,
    /// Threads.
    pub threads: Option<NonZeroUsize>,
    /// Say which models are on and why.
    pub explain: bool,
    /// Report on stdout.
    pub json: bool,
    /// No progress.
    pub quiet: bool,
}

/// Frames of a run.
#[derive(Debug)]
pub struct Frames {
    /// Where to.
    pub folder: PathBuf,
    /// How many per second of wear.
    pub per_second: f64,
}

/// The files of a bake.
#[derive(Debug, PartialEq, Eq)]
pub struct BakeOutputs {
    /// OUT.glb
    pub worn: PathBuf,
    /// OUT.crease.json
    pub sidecar: PathBuf,
    /// OUT.report.json
    pub report: PathBuf,
}

impl BakeOutputs {
    fn beside(worn: PathBuf) -> Self {
        Self { sidecar: worn.with_extension("crease.json"), report: worn.with_extension("report.json"), worn }
    }

    fn paths(&self) -> [&Path; 3] {
        [&self.worn, &self.sidecar, &self.report]
    }
}

impl From<Arguments> for BakeOptions {
    fn from(arguments: Arguments) -> Self {
        let Arguments {
            mesh, wear, output, fabric, body, reading, resolution, quality, method, memory, ..
        } = arguments;
        let Arguments { frames, fps, resume, threads, explain, json, quiet, .. } = arguments;
        Self {
            mesh,
            wear,
            outputs: BakeOutputs::beside(output),
            fabric,
            body,
            reading,
            resolution_m: resolution.map(|mm| mm * 1e-3),
            quality,
            method,
            memory,
            frames: frames.map(|folder| Frames { folder, per_second: fps }),
            resume,
            threads,
            explain,
            json,
            quiet,
        }
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    bake(BakeOptions::from(arguments))
}

/// What a bake is made from, read and checked.
#[derive(Debug)]
struct Ingredients {
    script: WearScript,
    fabric: Fabric,
    mesh: Vec<u8>,
}

/// Reads everything before anything long begins, and reports the faults of all files in one go.
fn ingredients(options: &BakeOptions) -> Result<Ingredients> {
    let script = script(options);
    let fabric = input::fabric(&options.fabric);
    let mesh = input::bytes(&options.mesh);
    match (script, fabric, mesh) {
        (Ok(script), Ok(fabric), Ok(mesh)) => Ok(Ingredients { script, fabric, mesh }),
        (script, fabric, mesh) => {
            let errors = [script.err(), fabric.err(), mesh.err()].into_iter().flatten();
            Err(merged(errors))
        }
    }
}

fn script(options: &BakeOptions) -> Result<WearScript> {
    let file = input::name_of(&options.wear);
    let script = WearScript::parse(&file, &input::text(&options.wear)?)?;
    match options.body {
        Some(_) => Ok(script),
        None => match script.faults_without_body(&file) {
            faults if faults.is_empty() => Ok(script),
            faults => Err(Error::Input(faults)),
        },
    }
}

/// The faults of several errors as one; an error that is no list of faults goes first.
fn merged(errors: impl Iterator<Item = Error>) -> Error {
    let mut faults = Vec::new();
    for error in errors {
        match error {
            Error::Input(more) => faults.extend(more),
            other => return other,
        }
    }
    Error::Input(faults)
}

/// The boundary to the library.
fn bake(options: BakeOptions) -> Result<()> {
    let mut progress = Progress::new(options.quiet);
    progress.stage("read");
    let outputs = Outputs::new([options.mesh.as_path(), options.wear.as_path(), Path::new(&options.fabric)]);
    for path in options.outputs.paths() {
        outputs.check(path)?;
    }
    let _ingredients = ingredients(&options)?;
    progress.finish();
    Err(super::not_wired("bake"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_files_go_beside_the_worn_garment() {
        let outputs = BakeOutputs::beside(PathBuf::from("a/my.shirt.glb"));
        assert_eq!(outputs.sidecar, Path::new("a/my.shirt.crease.json"));
        assert_eq!(outputs.report, Path::new("a/my.shirt.report.json"));
    }
}
