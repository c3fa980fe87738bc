//! `--resolution`: a garment made finer than its file. `--detail-map`: what only the finer mesh shows, as a normal map in its
//! material.

use crate::cli::args::common::positive;
use crate::cli::files::output::Outputs;
use clap::builder::RangedU64ValueParser;
use crease::Result;
use crease::garment::{Garment, SourceAsset, WornGarment};
use crease::io::gltf::{DETAIL_MAP_SIZES, DetailInput, add_detail_map};
use crease::report::DetailReport;
use std::path::{Path, PathBuf};

/// What is wanted of finer meshes.
#[derive(Debug, clap::Args)]
pub struct RefineArgs {
    /// Work at about this edge length, finer than the file (on a body: where it moves) [mm]; the file's own vertices keep
    /// number and place
    #[arg(long, value_name = "MM", value_parser = positive)]
    resolution: Option<f64>,
    /// Put what only the finer mesh of --resolution shows into a normal map of so many texels a side [2048 if no number is
    /// given], in the material of OUT.glb
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
    /// Also write the height of the fine wrinkles over the file's own triangles, as OUT.height.png
    #[arg(long, requires = "detail_map")]
    height_map: bool,
}

fn side() -> RangedU64ValueParser {
    RangedU64ValueParser::new().range(*DETAIL_MAP_SIZES.start() as u64..=*DETAIL_MAP_SIZES.end() as u64)
}

/// A garment that was made finer than its file.
#[derive(Debug)]
pub struct Finer {
    /// In words.
    pub told: String,
    /// The garment as the file has it, and the triangle of it that each of the finer ones lies on; none where the file was fine
    /// enough.
    pub coarse: Option<(Garment, Vec<u32>)>,
}

impl Finer {
    /// What the wear of the finer garment has beyond the file.
    pub fn detail<'a>(&'a self, fine: &'a Garment, worn: &'a WornGarment) -> Option<DetailInput<'a>> {
        let (coarse, parent) = self.coarse.as_ref()?;
        Some(DetailInput { coarse, fine, parent, worn })
    }
}

impl RefineArgs {
    /// Makes `garment` finer, if that is wanted: around the points that `wanted` flags, one flag per point; empty for all.
    pub fn refine(&self, garment: &mut Garment, wanted: impl FnOnce(&Garment) -> Vec<bool>) -> Option<Finer> {
        let mm = self.resolution?;
        let edge = garment.mean_edge();
        let wanted = wanted(garment);
        let finer = garment.refine(1e-3 * mm, &wanted);
        let (before, after) = (garment.points.len(), finer.garment.points.len());
        if after == before {
            let told = format!(
                "resolution: the file is as fine as {mm} mm already ({:.1} mm on average)",
                1e3 * edge
            );
            return Some(Finer { told, coarse: None });
        }
        let place = if wanted.is_empty() { "" } else { " where the body stirs it" };
        let told = format!("resolution: {after} points instead of {before}, edges of about {mm} mm{place}");
        let coarse = std::mem::replace(garment, finer.garment);
        Some(Finer { told, coarse: Some((coarse, finer.parent)) })
    }

    /// The worn file with its maps, pictures that go beside it, and what there is to tell; `detail` is none where the file
    /// was fine enough.
    pub fn add(
        &self,
        worn: &Path,
        outputs: &mut Outputs,
        asset: &SourceAsset,
        detail: Option<DetailInput>,
        glb: Vec<u8>,
    ) -> Result<(Vec<u8>, Vec<DetailReport>, Vec<String>)> {
        let Some(side) = self.detail_map else { return Ok((glb, Vec::new(), Vec::new())) };
        let Some(detail) = detail else {
            return Ok((
                glb,
                Vec::new(),
                vec!["no detail map: the garment was not made finer than its file".into()],
            ));
        };
        let detailed = add_detail_map(&glb, asset, &detail, side as usize)?;
        let mut told = Vec::new();
        for (k, map) in detailed.maps.iter().enumerate() {
            let beside = |what: &str| numbered(worn, what, k, detailed.maps.len());
            let mut report = DetailReport::of(map, side);
            if !map.in_material {
                let path = beside("normal");
                outputs.add(&path, &map.normal_png)?;
                report.normal_map = name_of(&path);
            }
            if self.height_map {
                let path = beside("height");
                outputs.add(&path, &map.height_png)?;
                report.height_map = name_of(&path);
            }
            told.push(report);
        }
        Ok((detailed.glb, told, detailed.notes))
    }
}

/// OUT.normal.png, or OUT.normal.2.png where there are several.
fn numbered(worn: &Path, what: &str, k: usize, count: usize) -> PathBuf {
    let ending = if count > 1 { format!("{what}.{}.png", k + 1) } else { format!("{what}.png") };
    worn.with_extension(ending)
}

fn name_of(path: &Path) -> Option<String> {
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}
