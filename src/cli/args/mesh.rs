//! Options that say how a mesh file is read.

use crate::args::values::{Metres, positive, unit};
use clap::Args;
use crease_io::ReadOptions;
use crease_model::garment::UpAxis;
use std::path::PathBuf;

/// Unit, up axis and garment of a mesh file.
#[derive(Debug, Clone, Args)]
pub struct MeshArgs {
    /// Unit of the mesh file: m, dm, cm, mm, in, or its length in metres [default: that of a USD file, otherwise derived from format and size]
    #[arg(long, value_name = "UNIT", allow_negative_numbers = true, value_parser = unit)]
    unit: Option<Metres>,
    /// Up axis of the mesh file: y or z [default: that of a USD file, otherwise derived from the format]
    #[arg(long, value_name = "AXIS", value_parser = up_axis)]
    up: Option<UpAxis>,
    /// Parts that are the garment: nodes, meshes, groups, materials (Body:Purple is the material Purple of Body) or numbers as
    /// in piece#3, with commas between them [default: the whole file]
    #[arg(long, value_name = "NAMES")]
    garment: Option<String>,
    /// Take a garment of any size, also smaller than 5 cm or larger than 5 m
    #[arg(long)]
    force_size: bool,
    /// Sew borders of the garment: join vertices on them up to this distance apart [mm] [default: only those in one place]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    weld: Option<f64>,
    #[command(flatten)]
    references: ReferenceArgs,
}

/// Where the files lie that a mesh file refers to.
#[derive(Debug, Clone, Args)]
pub struct ReferenceArgs {
    /// Folder besides that of a mesh file from which the file may read others: buffers, pictures, layers
    #[arg(long, value_name = "DIR")]
    pub allow_folder: Option<PathBuf>,
}

/// How the mesh file of a garment is read that becomes cloth.
#[derive(Debug, Clone, Args)]
pub struct ClothArgs {
    #[command(flatten)]
    mesh: MeshArgs,
    /// Vertex attribute that says how much of hems and seams there is, from 0 (single cloth) to 1: COLOR_0, COLOR_0.g, _SEWN, ...
    #[arg(long, value_name = "ATTRIBUTE")]
    sewing_mask: Option<String>,
}

impl ClothArgs {
    /// Returns the options of the mesh reader.
    pub fn options(&self) -> ReadOptions {
        ReadOptions { sewing_mask: self.sewing_mask.clone(), ..self.mesh.options() }
    }
}

impl MeshArgs {
    /// Returns the options of the mesh reader.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            unit_m: self.unit.map(|unit| unit.0),
            up: self.up,
            garment: self.garment.clone(),
            mask: None,
            sewing_mask: None,
            any_size: self.force_size,
            skip_damaged: false,
            weld_m: self.weld.map(|mm| 1e-3 * mm),
            allow_folder: self.references.allow_folder.clone(),
        }
    }
}

/// Parses an up axis.
pub(super) fn up_axis(text: &str) -> Result<UpAxis, String> {
    match text {
        "y" | "Y" => Ok(UpAxis::Y),
        "z" | "Z" => Ok(UpAxis::Z),
        _ => Err("expected y or z".to_owned()),
    }
}
