//! `--resolution`: a garment refined beyond its file. `--detail-map`: the wrinkles that only the refined mesh resolves, as
//! a normal map in the material of the garment.

use crate::args::values::positive;
use crate::files::output::{Outputs, is_stream};
use clap::ValueEnum;
use clap::builder::RangedU64ValueParser;
use crease::internal::report::DetailReport;
use crease_geometry::mesh::PointIndex;
use crease_io::gltf::{DETAIL_MAP_SIZES, DetailInput, FlatNormals, MapDepth, add_detail_map};
use crease_model::error::{Error, Result};
use crease_model::garment::{Garment, SourceAsset, WornGarment};
use std::path::{Path, PathBuf};

/// Resolution and detail maps.
#[derive(Debug, clap::Args)]
pub struct RefineArgs {
    /// Refine the mesh to about this edge length [mm] (on a body: where the body can move it); the vertices of the file
    /// keep their number and position
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    resolution: Option<f64>,
    /// Write wrinkles that only the refined mesh resolves into a normal map of TEXELS x TEXELS [2048 if no number is
    /// given] in the material of OUT.glb
    #[arg(
        long,
        value_name = "TEXELS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "2048",
        requires = "resolution",
        value_parser = side()
    )]
    detail_map: Option<u64>,
    /// Bits per channel of the normal map
    #[arg(long, value_name = "BITS", value_enum, default_value_t = MapBits::Eight, requires = "detail_map")]
    normal_map_bits: MapBits,
    /// Also write the height of these wrinkles over the triangles of the file, as OUT.height.png
    #[arg(long, requires = "detail_map")]
    height_map: bool,
}

/// Most points of a refined garment.
const MAX_REFINED_POINTS: f64 = 1e6;
/// Values of `--normal-map-bits`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MapBits {
    /// 8 bits, which every program reads
    #[value(name = "8")]
    Eight,
    /// 16 bits
    #[value(name = "16")]
    Sixteen,
}

fn side() -> RangedU64ValueParser {
    RangedU64ValueParser::new().range(*DETAIL_MAP_SIZES.start() as u64..=*DETAIL_MAP_SIZES.end() as u64)
}

/// Outcome of refining a garment.
#[derive(Debug)]
pub struct Refinement {
    /// Description for the report.
    pub note: String,
    /// Garment of the file; `None` where it was fine enough.
    pub coarse: Option<CoarseGarment>,
}

/// Garment as its file has it, before refining.
#[derive(Debug)]
pub struct CoarseGarment {
    /// The garment.
    pub garment: Garment,
    /// Per triangle of the refined garment: the triangle of the file that contains it.
    pub parent: Vec<u32>,
}

impl Refinement {
    /// Returns the wrinkles of the refined garment `fine` that its file cannot show; `None` if it was not refined.
    pub fn detail<'a>(
        &'a self,
        fine: &'a Garment,
        worn: &'a WornGarment,
        flat_normals: FlatNormals,
    ) -> Option<DetailInput<'a>> {
        let CoarseGarment { garment, parent } = self.coarse.as_ref()?;
        Some(DetailInput { coarse: garment, fine, parent, worn, flat_normals })
    }
}

/// A worn glTF with its detail maps.
#[derive(Debug, Default)]
pub struct DetailedGlb {
    /// Bytes of the glTF.
    pub glb: Vec<u8>,
    /// One report per map.
    pub reports: Vec<DetailReport>,
    /// Warnings.
    pub notes: Vec<String>,
}

impl RefineArgs {
    /// Whether pictures of heights are asked for, which go beside the garment.
    pub fn has_height_map(&self) -> bool {
        self.height_map
    }

    /// Returns the length of the finest edges that are simulated [m], if it was given.
    pub fn finest_edge(&self) -> Option<f64> {
        self.resolution.map(|mm| 1e-3 * mm)
    }

    /// Refines `garment` if `--resolution` was given, around the points that `selected` flags: one flag per point, or none
    /// for the whole garment.
    ///
    /// # Errors
    /// A resolution that would make more points than any machine bakes.
    pub fn refine(
        &self,
        file: &Path,
        garment: &mut Garment,
        selected: impl FnOnce(&Garment) -> Vec<bool>,
    ) -> Result<Option<Refinement>> {
        let Some(mm) = self.resolution else { return Ok(None) };
        let edge = garment.mean_edge();
        let selected = selected(garment);
        let count = expected_points(garment, &selected, 1e-3 * mm);
        if count > MAX_REFINED_POINTS {
            let message = format!("--resolution {mm} would make about {:.1} million points", 1e-6 * count);
            let finest = mm * (count / MAX_REFINED_POINTS).sqrt();
            let help = format!(
                "at most a million can be simulated: --resolution {:.1} or coarser",
                (10.0 * finest).ceil() / 10.0
            );
            return Err(Error::input(file.display().to_string(), "", message, help));
        }
        let refined = garment.refine(1e-3 * mm, &selected);
        let (before, after) = (garment.points.len(), refined.garment.points.len());
        if after == before {
            let note = format!(
                "resolution: the edges of the file are not longer than {mm} mm ({:.1} mm on average)",
                1e3 * edge
            );
            return Ok(Some(Refinement { note, coarse: None }));
        }
        let region = if selected.is_empty() { "" } else { " where the body can move it" };
        let note = format!("resolution: {after} points instead of {before}, edges of about {mm} mm{region}");
        let coarse = std::mem::replace(garment, refined.garment);
        Ok(Some(Refinement { note, coarse: Some(CoarseGarment { garment: coarse, parent: refined.parent }) }))
    }

    /// Adds detail maps to the worn glTF `glb`, and the pictures that go beside it to `outputs`. `detail` is `None` where the
    /// garment was not refined.
    pub fn add(
        &self,
        worn: &Path,
        outputs: &mut Outputs,
        asset: &SourceAsset,
        detail: Option<DetailInput>,
        glb: Vec<u8>,
    ) -> Result<DetailedGlb> {
        let Some(side) = self.detail_map else { return Ok(DetailedGlb { glb, ..DetailedGlb::default() }) };
        let Some(detail) = detail else {
            let notes = vec!["no detail map: the garment was not refined".to_owned()];
            return Ok(DetailedGlb { glb, notes, ..DetailedGlb::default() });
        };
        let depth = match self.normal_map_bits {
            MapBits::Eight => MapDepth::Eight,
            MapBits::Sixteen => MapDepth::Sixteen,
        };
        let detailed = add_detail_map(&glb, asset, &detail, side as usize, depth)?;
        let (mut reports, mut notes) = (Vec::new(), detailed.notes);
        for (k, map) in detailed.maps.iter().enumerate() {
            let beside = |kind: &str| map_path(worn, kind, k, detailed.maps.len());
            let mut report = DetailReport::new(map, side);
            if !map.in_material && is_stream(worn) {
                let left_out = "a normal map that fits no material is left out: the standard output has no place beside it";
                notes.push(left_out.to_owned());
            } else if !map.in_material {
                let path = beside("normal");
                outputs.add(&path, &map.normal_png)?;
                report.normal_map = name_of(&path);
            }
            if self.height_map {
                let path = beside("height");
                outputs.add(&path, &map.height_png)?;
                report.height_map = name_of(&path);
            }
            reports.push(report);
        }
        Ok(DetailedGlb { glb: detailed.glb, reports, notes })
    }
}

/// Number of points of `garment` with edges of `edge` [m] where `selected` flags a corner, or everywhere without flags.
fn expected_points(garment: &Garment, selected: &[bool], edge: f64) -> f64 {
    let is_refined =
        |t: &[PointIndex; 3]| selected.is_empty() || t.iter().any(|p| selected.get(p.at()) == Some(&true));
    let refined = garment.triangles.iter().zip(&garment.material).filter(|(t, _)| is_refined(t));
    let area: f64 = refined.map(|(_, m)| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs()).sum();
    // Equilateral triangles, two per point.
    garment.points.len() as f64 + area / (0.75f64.sqrt() * edge * edge)
}

/// Returns OUT.normal.png for the only map, OUT.normal.2.png for the second of several.
fn map_path(worn: &Path, kind: &str, k: usize, count: usize) -> PathBuf {
    let extension = if count > 1 { format!("{kind}.{}.png", k + 1) } else { format!("{kind}.png") };
    worn.with_extension(extension)
}

fn name_of(path: &Path) -> Option<String> {
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}
