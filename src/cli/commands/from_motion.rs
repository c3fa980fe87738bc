//! `crease remember`: memory from an existing motion, without simulation. Reads an animated glTF or a folder of OBJ frames;
//! writes the worn garment, its sidecar and the report, as `crease bake` does.

use crate::args::apply::ApplyArgs;
use crate::args::mesh::ClothArgs;
use crate::args::run::RunArgs;
use crate::args::values::{Metres, glb_path, positive, unit};
use crate::commands::worn_job::{Terminal, check_stream, crossings_text, finish};
use crate::files::input::check_streams;
use crate::runtime::console;
use crate::runtime::threads::on_threads;
use crease::internal::job::{MotionJob, OutputOptions};
use crease::internal::report::Report;
use crease_model::error::Result;
use crease_model::fabric::DEFAULT_FABRIC;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease remember walk.glb --garment shirt --repeat 20 -o worn.glb
  crease remember capture/ --fps 60 -o worn.glb
  crease remember frames/ --fps 30 --mesh shirt.glb -o worn.glb    frames of a run, memory into the file it came from")]
pub struct Arguments {
    /// Motion of the garment: an animated .glb or .gltf (skin, nodes, morph targets), or a folder of numbered .obj frames
    motion: PathBuf,
    /// Source pose of the garment that the frames show in motion [default: the first frame]
    #[arg(long, help_heading = "Input", value_name = "MESH")]
    mesh: Option<PathBuf>,
    /// Frames per second: of a folder (required), or at which a clip is sampled [default: 30]
    #[arg(long, help_heading = "Input", value_name = "N", allow_negative_numbers = true, value_parser = positive)]
    fps: Option<f64>,
    /// Unit of the frames beside --mesh: m, dm, cm, mm, in or metres [default: metres, as frames of a bake]
    #[arg(long, help_heading = "Input", value_name = "UNIT", value_parser = unit, requires = "mesh")]
    frames_unit: Option<Metres>,
    /// Clip of an animated file: its name, or its number as in clip#2 [default: the first that moves the garment]
    #[arg(long, help_heading = "Input", value_name = "NAME")]
    clip: Option<String>,
    /// Fabric of the garment: a name of `crease fabric list`, or a fabric file
    #[arg(long, help_heading = "Input", value_name = "NAME|FILE", default_value = DEFAULT_FABRIC)]
    fabric: String,
    #[command(flatten, next_help_heading = "Input")]
    reading: ClothArgs,
    /// Repetitions of the motion
    #[arg(long, help_heading = "Wear", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Output")]
    apply: ApplyArgs,
    #[command(flatten, next_help_heading = "Run")]
    run: RunArgs,
}

impl Arguments {
    /// Returns the job.
    fn job(self) -> Result<MotionJob> {
        check_streams(&[
            ("MOTION", Some(&self.motion)),
            ("--mesh", self.mesh.as_deref()),
            ("--fabric", Some(Path::new(&self.fabric))),
        ])?;
        let output =
            OutputOptions { path: Some(self.output), shape: self.apply.shape(), ..OutputOptions::default() };
        check_stream(&output, self.run.json)?;
        Ok(MotionJob {
            motion: self.motion,
            mesh: self.mesh,
            reading: self.reading.options(),
            frames_per_second: self.fps,
            frames_unit_m: self.frames_unit.map(|unit| unit.0),
            clip: self.clip,
            fabric: self.fabric,
            repetitions: self.repeat,
            output,
        })
    }
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    on_threads(arguments.run.threads, || {
        let run = arguments.run.clone();
        let mut terminal = Terminal { is_verbose: run.is_verbose(), bake: None };
        let outputs = arguments.job()?.run(&mut terminal)?;
        finish(outputs, &run, terminal, print_summary)
    })
}

fn print_summary(worn: &str, report: &Report) {
    console::message(&format!(
        "{worn}: {} points, memory of {:.1} s of motion in {:.1} s; {} events; {}; {}",
        report.points,
        report.simulated_s,
        report.wall_s,
        report.events.gradual + report.events.critical,
        report.shown,
        crossings_text([report.crossings, report.crossings_at_start, report.crossings_in_result])
    ));
}
