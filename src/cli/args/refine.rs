//! `--resolution`, `--detail-map` and `--fine`: a garment refined beyond its file, normal maps and a finer mesh of the worn surface.

use crate::args::values::{Choice, choice, positive};
use clap::builder::RangedU64ValueParser;
use crease::internal::job::DetailOptions;
use crease_io::gltf::{DETAIL_MAP_SIZES, DetailOf, MapDepth};

/// Resolution, detail maps, and the finer mesh.
#[derive(Debug, Clone, clap::Args)]
pub struct RefineArgs {
    /// Refine the mesh to about this edge length [mm] (on a body: where the body can move it); the vertices of the file
    /// keep their number and position
    #[arg(long, help_heading = "Quality", value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    resolution: Option<f64>,
    /// Write what the triangles of the file cannot show of the worn surface, creases first of all, into a normal map of TEXELS x TEXELS
    /// [2048 if no number is given] in the material of OUT.glb
    #[arg(
        long,
        help_heading = "Output",
        value_name = "TEXELS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "2048",
        value_parser = side()
    )]
    detail_map: Option<u64>,
    /// Also write OUT.fine.glb: the garment with vertices added along creases and in wrinkles, edges of about 4 mm there, which shows the
    /// worn surface without a map; the vertices of the file come first and stay as they are
    #[arg(long, help_heading = "Output")]
    pub fine: bool,
    /// Bits per channel of the normal map
    #[arg(long, help_heading = "Output", value_name = "BITS", value_parser = choice(&DEPTHS), default_value = "8", requires = "detail_map")]
    normal_map_bits: MapDepth,
    /// What the map shows
    #[arg(long, help_heading = "Output", value_name = "WEAR", value_parser = choice(&DETAIL_OF), default_value = "rest", requires = "detail_map")]
    detail_map_of: DetailOf,
    /// Also write the maps as files: OUT.normal.png, OUT.height.png (16 bits; the report has the heights of black and white) and
    /// OUT.creases.png (angles of creases, white for 180 degrees)
    #[arg(long, help_heading = "Output", alias = "height-map", requires = "detail_map")]
    map_files: bool,
}

/// Values of `--normal-map-bits`.
const DEPTHS: [Choice<MapDepth>; 2] =
    [("8", MapDepth::Eight, "8 bits, which every program reads"), ("16", MapDepth::Sixteen, "16 bits")];

/// Values of `--detail-map-of`.
const DETAIL_OF: [Choice<DetailOf>; 2] = [
    ("rest", DetailOf::Rest, "What the worn vertices of the file do not show"),
    (
        "all",
        DetailOf::All,
        "All of the wear, for the mesh without it: the map is a file, not in the material",
    ),
];

fn side() -> RangedU64ValueParser {
    RangedU64ValueParser::new().range(*DETAIL_MAP_SIZES.start() as u64..=*DETAIL_MAP_SIZES.end() as u64)
}

impl RefineArgs {
    /// Returns the length of the edges of the refined mesh [mm], if it was given.
    pub fn resolution_mm(&self) -> Option<f64> {
        self.resolution
    }

    /// Returns the options of the detail maps, if they are asked for.
    pub fn detail(&self) -> Option<DetailOptions> {
        let (depth, of, files) = (self.normal_map_bits, self.detail_map_of, self.map_files);
        self.detail_map.map(|texels| DetailOptions { texels, depth, of, files })
    }
}
