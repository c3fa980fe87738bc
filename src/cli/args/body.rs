//! `--body` and its options: the body that a garment is worn on.

use crate::args::mesh::up_axis;
use crate::args::values::{Metres, positive, unit};
use clap::Args;
use crease::internal::job::{BodyHold, BodyOptions};
use crease_model::garment::UpAxis;
use std::path::{Path, PathBuf};

/// Body that a garment is worn on.
#[derive(Debug, Clone, Args)]
pub struct BodyArgs {
    /// Body that the garment is worn on: .glb, .gltf, .obj or USD, which does not move (may be the file of the garment), a folder of numbered .obj frames, or - for the standard input
    #[arg(long, value_name = "BODY")]
    body: Option<PathBuf>,
    /// Node, mesh or group that is the body [default: the whole file except the garment]
    #[arg(long, value_name = "NODE|GROUP", requires = "body")]
    body_node: Option<String>,
    /// Joints or parts that the garment does not rest on, with commas between them, such as hair or hands: of a joint what it and those
    /// below it move
    #[arg(long, value_name = "NAMES", requires = "body")]
    body_without: Option<String>,
    /// Unit of the body file: m, dm, cm, mm, in or metres [default: --unit; metres for a glTF beside an OBJ, its own for a USD file]
    #[arg(long, value_name = "UNIT", allow_negative_numbers = true, value_parser = unit, requires = "body")]
    body_unit: Option<Metres>,
    /// Up axis of the body file: y or z [default: --up; y for a glTF beside an OBJ, its own for a USD file]
    #[arg(long, value_name = "AXIS", value_parser = up_axis, requires = "body")]
    body_up: Option<UpAxis>,
    /// Frames per second of a folder of frames
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = positive, requires = "body")]
    body_fps: Option<f64>,
    /// What of a garment that is skinned in its file stays where its joints carry it, the rest within a distance that grows from there:
    /// upper (upper borders, and cloth without a body under it), none, or the vertex attribute that is 1 there, as in COLOR_0.r
    /// or _PIN
    #[arg(long, value_name = "WHAT", default_value = "upper", requires = "body")]
    hold: String,
}

impl BodyArgs {
    /// Path of the body file.
    pub fn path(&self) -> Option<&Path> {
        self.body.as_deref()
    }

    /// Returns the body, if one was given.
    pub fn options(self) -> Option<BodyOptions> {
        let without = self.body_without.iter().flat_map(|names| names.split(',')).map(str::trim);
        Some(BodyOptions {
            path: self.body?,
            node: self.body_node,
            without: without.filter(|name| !name.is_empty()).map(str::to_owned).collect(),
            unit_m: self.body_unit.map(|unit| unit.0),
            up: self.body_up,
            frames_per_second: self.body_fps,
            hold: match self.hold.as_str() {
                "upper" => BodyHold::Upper,
                "none" => BodyHold::Nothing,
                _ => BodyHold::Attribute(self.hold),
            },
        })
    }
}
