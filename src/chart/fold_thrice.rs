//! The T-shirt that is folded thrice: the garment and script that several charts bake.
//!
//! Folds that begin in contact are sensitive to their initial condition, so that one bake says little: charts that
//! compare results bake several perturbed initial conditions.

use crate::bake::{Bake, BakeOptions, BakeResult};
use crate::chart::curvature_field::CurvatureField;
use crate::chart::included_mesh::{IncludedMesh, TSHIRT, TSHIRT_DRAFT};
use crate::error::Result;
use crate::fabric::{Fabric, PAPER_FABRIC};
use crate::garment::Garment;
use crate::io::ReadOptions;
use crate::math::Rng;
use crate::mesh::intersections::self_intersections;
use crate::wear::WearScript;
use std::time::Instant;

/// Name of the scene in tables.
pub(super) const FOLD_THRICE: &str = "fold-thrice";

const SCRIPT_FILE: &str = "fold-thrice.json";
const SCRIPT: &str = include_str!("../../garments/wear/fold-thrice.json");

/// Largest displacement of a point by a perturbation, per axis, over the mean edge [-].
const PERTURBATION_FRACTION: f64 = 0.02;

/// T-shirt, fabric and wear script.
pub(super) struct FoldThrice {
    garment: Garment,
    fabric: Fabric,
    script: WearScript,
}

/// Result and cost of one bake.
pub(super) struct BakeRun {
    /// Wall time [s].
    pub(super) wall: f64,
    /// Linear systems solved, global and local.
    pub(super) linear_solves: u64,
    /// The result.
    pub(super) baked: BakeResult,
}

impl FoldThrice {
    /// The T-shirt of 2,000 points, in the paper's fabric.
    pub(super) fn tshirt_draft() -> Result<Self> {
        Self::of(&TSHIRT_DRAFT)
    }

    /// The T-shirt of 13,863 points, in the paper's fabric.
    pub(super) fn tshirt() -> Result<Self> {
        Self::of(&TSHIRT)
    }

    fn of(mesh: &IncludedMesh) -> Result<Self> {
        let asset = mesh.read(&ReadOptions::default())?;
        Ok(Self {
            garment: Garment::from_asset(&asset)?.0,
            fabric: Fabric::preset(PAPER_FABRIC)?,
            script: WearScript::parse(SCRIPT_FILE, SCRIPT)?,
        })
    }

    /// The same garment and script in another fabric.
    #[must_use]
    pub(super) fn in_fabric(self, fabric: Fabric) -> Self {
        Self { fabric, ..self }
    }

    /// The memory that a bake left, as a field on the garment.
    pub(super) fn field(&self, baked: &BakeResult) -> CurvatureField {
        CurvatureField::new(&self.garment, &baked.worn.memory)
    }

    /// Number of points.
    pub(super) fn points(&self) -> usize {
        self.garment.points.len()
    }

    /// The same garment, refined by edge bisection to edges of at most `edge` [m].
    #[must_use]
    pub(super) fn refine(&self, edge: f64) -> Self {
        let garment = self.garment.refine(edge, &[]).garment;
        Self { garment, fabric: self.fabric.clone(), script: self.script.clone() }
    }

    /// The same garment with a perturbed initial condition: points moved at random by up to a fiftieth of the mean
    /// edge along every axis, reproducibly for each `seed`.
    #[must_use]
    pub(super) fn perturbed(&self, seed: u64) -> Self {
        let mut garment = self.garment.clone();
        let mut rng = Rng::from_seed(seed);
        let amplitude = PERTURBATION_FRACTION * garment.mean_edge();
        garment.points.iter_mut().for_each(|x| *x += rng.in_cube() * amplitude);
        Self { garment, fabric: self.fabric.clone(), script: self.script.clone() }
    }

    /// Bakes the script.
    pub(super) fn run(&self, options: &BakeOptions) -> Result<BakeRun> {
        let clock = Instant::now();
        let bake = Bake::new(&self.garment, &self.fabric, &self.script).script_name(SCRIPT_FILE);
        let baked = bake.options(options.clone()).run()?;
        let linear_solves = baked.report.solves + baked.report.local_solves;
        Ok(BakeRun { wall: clock.elapsed().as_secs_f64(), linear_solves, baked })
    }

    /// Whether layers of the result intersect.
    pub(super) fn has_intersections(&self, baked: &BakeResult) -> bool {
        let worn: Vec<_> =
            self.garment.points.iter().zip(&baked.worn.displacement).map(|(x, d)| x + d).collect();
        !self_intersections(&worn, &self.garment.triangles).is_empty()
    }
}
