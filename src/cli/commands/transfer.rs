//! `crease transfer`: transfer of memory to another garment. Reads sidecars and a mesh, relaxes the mesh with the
//! transferred memory; writes the worn garment, its sidecar and the report, all or none.

use crate::args::apply::ApplyArgs;
use crate::args::export::{ExportArgs, print_checks};
use crate::args::mesh::ClothArgs;
use crate::args::refine::RefineArgs;
use crate::args::run::RunArgs;
use crate::args::values::{Choice, choice, glb_path, not_negative};
use crate::commands::worn_job::{Terminal, check_stream, crossings_text, finish, print_files};
use crate::files::input::check_streams;
use crate::runtime::console;
use crate::runtime::threads::on_threads;
use crease::internal::job::{GarmentSource, MemorySource, OutputOptions, TransferJob};
use crease::internal::report::TransferReport;
use crease::internal::transfer::{Align, MatchBy, TransferOptions};
use crease_io::ReadOptions;
use crease_model::error::Result;
use crease_model::remesh::Channels;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Sidecars of the memory to transfer, as written by `crease bake` or compressed with gzip, worn .glb files that name theirs, or
    /// names of memories that `crease example` lists; several are added up
    #[arg(required = true, value_name = "SIDECAR")]
    sidecars: Vec<PathBuf>,
    /// Target garment: .obj, .gltf, .glb or USD
    #[arg(long, help_heading = "Input", value_name = "MESH")]
    to: PathBuf,
    /// Fabric of MESH: a name of `crease fabric list`, or a fabric file [default: the fabric of the first sidecar]
    #[arg(long, help_heading = "Input", value_name = "NAME|FILE")]
    fabric: Option<String>,
    /// File of corresponding points of both garments (`crease schema landmarks`), by which the source is aligned
    #[arg(long, help_heading = "Input", value_name = "FILE", conflicts_with = "align")]
    landmarks: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Input")]
    reading: ClothArgs,
    /// Matching of points of both garments
    #[arg(long = "match", help_heading = "Transfer", alias = "by", value_name = "MODE", value_parser = choice(&MATCH_BY), default_value = "auto")]
    match_by: MatchBy,
    /// Alignment of the source with the target before points are matched by surface
    #[arg(long, help_heading = "Transfer", value_name = "MODE", value_parser = choice(&ALIGN), default_value = "auto")]
    align: Align,
    /// Factor on every change of the rest state: 0 for none, 1 for the full change
    #[arg(long, help_heading = "Transfer", value_name = "S", allow_negative_numbers = true, value_parser = not_negative, default_value_t = 1.0)]
    strength: f64,
    /// Vertex attribute of MESH that scales the transferred memory, 0 to 1: COLOR_0, COLOR_0.g, _MASK, ...
    #[arg(long, help_heading = "Transfer", value_name = "ATTRIBUTE")]
    mask: Option<String>,
    /// Transfer only creases (rest angles, stiffness) or only bagging (rest lengths) [default: both]
    #[arg(long, help_heading = "Transfer", value_parser = choice(&CHANNELS))]
    only: Option<Channels>,
    /// Mirror the memory left to right
    #[arg(long, help_heading = "Transfer", value_name = "AXIS", value_parser = choice(&[("x", (), "Left to right")]))]
    mirror: Option<()>,
    /// Worn garment to write; OUT.crease.json and OUT.report.json go beside it. - is the standard output, for the garment alone
    #[arg(short, long, help_heading = "Output", value_name = "OUT.glb", value_parser = glb_path)]
    output: PathBuf,
    #[command(flatten, next_help_heading = "Output")]
    apply: ApplyArgs,
    #[command(flatten, next_help_heading = "Output")]
    export: ExportArgs,
    #[command(flatten)]
    refine: RefineArgs,
    #[command(flatten, next_help_heading = "Run")]
    run: RunArgs,
}

/// Values of `--match`.
const MATCH_BY: [Choice<MatchBy>; 4] = [
    (
        "auto",
        MatchBy::Auto,
        "By texture coordinates where both textures agree, else by surface; by vertex number for the same mesh",
    ),
    ("uv", MatchBy::Uv, "By texture coordinates"),
    ("surface", MatchBy::Surface, "By position on the surface, after alignment"),
    ("same", MatchBy::Same, "By vertex number; refused unless the mesh is the same"),
];

/// Values of `--align`.
const ALIGN: [Choice<Align>; 4] = [
    (
        "auto",
        Align::Auto,
        "None if most of MESH is close to the source, else by joints, else by bounding boxes",
    ),
    ("joints", Align::Joints, "By the joints of a skeleton that both garments are bound to"),
    ("box", Align::Box, "Map the bounding box of the source to that of MESH"),
    (
        "none|place",
        Align::InPlace,
        "No alignment: both garments keep the coordinates of their files, as garments of one body do",
    ),
];

/// Values of `--only`.
const CHANNELS: [Choice<Channels>; 2] = [
    ("creases", Channels { creases: true, bagging: false }, "Rest angles and stiffness"),
    ("bagging", Channels { creases: false, bagging: true }, "Rest lengths"),
];

impl Arguments {
    /// Returns the job.
    fn job(self) -> Result<TransferJob> {
        let named = self.sidecars.iter().map(|path| ("SIDECAR", Some(path.as_path())));
        let others = [
            ("--to", Some(self.to.as_path())),
            ("--landmarks", self.landmarks.as_deref()),
            ("--fabric", self.fabric.as_deref().map(Path::new)),
        ];
        check_streams(&named.chain(others).collect::<Vec<_>>())?;
        let output = OutputOptions {
            path: Some(self.output),
            shape: self.apply.shape(),
            detail: self.refine.detail(),
            fine: self.refine.fine,
            exports: self.export.export,
            preview: false,
        };
        check_stream(&output, self.run.json)?;
        let reading = ReadOptions { mask: self.mask, ..self.reading.options() };
        Ok(TransferJob {
            sources: self.sidecars.into_iter().map(MemorySource::File).collect(),
            target: GarmentSource::File { path: self.to, reading },
            resolution_mm: self.refine.resolution_mm(),
            fabric: self.fabric,
            landmarks: self.landmarks,
            transfer: TransferOptions {
                match_by: self.match_by,
                align: self.align,
                strength: self.strength,
                channels: self.only.unwrap_or(Channels::ALL),
                mirror_x: self.mirror.is_some(),
                ..TransferOptions::full(0)
            },
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
    print_files(&report.files, report.fine.as_ref());
    console::message(&format!(
        "{worn}: {} points, confidence {:.2}, {:.1} s; {}; {}",
        report.points,
        report.confidence,
        report.wall_s,
        report.shown,
        crossings_text([report.crossings, report.crossings_at_start, report.crossings_in_result]),
    ));
}
