//! Garments and scripts that several charts bake: T-shirts that are folded thrice, an elbow that bends, a crumpled handkerchief, a strip
//! that falls.
//!
//! What begins in contact is sensitive to its initial condition, so that one bake says little: charts that compare results bake several
//! perturbed initial conditions.

use crate::curvature_field::CurvatureField;
use crate::falling_strip::{FALLING_STRIP_POINTS, FIRST_TILT, tilted_strip};
use crate::included_mesh::{HANDKERCHIEF, IncludedMesh, TSHIRT, TSHIRT_DRAFT, sleeve_on_arm};
use crease::internal::bake::{Bake, BakeOptions, BakeResult};
use crease::internal::wear::WearScript;
use crease_geometry::math::Rng;
use crease_geometry::mesh::intersections::self_intersections;

use crease_model::body::AnimatedBody;
use crease_model::error::Result;
use crease_model::fabric::{Fabric, PAPER_FABRIC};
use crease_model::garment::Garment;
use std::sync::Arc;
use std::time::Instant;

/// Name of the scene in tables.
pub(super) const FOLD_THRICE: &str = "fold-thrice";

/// The first of the ten bends of `garments/wear/elbow-ten-bends.json`.
const BEND_SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [
    {"bend": {"joint": "elbow", "axis": "z", "angle": 95, "over": 1.0, "hold": 0.5}}]}"#;
/// `garments/wear/crumple.json`, less tight and held for a second.
const CRUMPLE_SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [
    {"lay": {"facing": "up"}}, {"crumple": {"to": 0.35, "over": 2.0, "hold": 1.0}}, {"release": {}}, {"settle": {"for": 1.0}}]}"#;

/// A strip stands upright, falls and lies for a while.
const FALL_SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [
    {"hang": {"by": [[0.0, 1.0], [0.5, 1.0], [1.0, 1.0]], "for": 0.5}}, {"release": {}}, {"settle": {"for": 2.0}}]}"#;

/// Largest displacement of a point by a perturbation, per axis, over the mean edge [-].
const PERTURBATION_FRACTION: f64 = 0.02;

/// Garment, fabric and wear script, and the body that wears the garment if there is one.
pub(super) struct BakeScene {
    garment: Garment,
    fabric: Fabric,
    script_file: &'static str,
    script: WearScript,
    body: Option<Arc<AnimatedBody>>,
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

impl BakeScene {
    /// The T-shirt of 2,000 points folded thrice, in the paper's fabric.
    pub(super) fn tshirt_draft() -> Result<Self> {
        Self::folded_thrice(&TSHIRT_DRAFT)
    }

    /// The T-shirt of 13,863 points folded thrice, in the paper's fabric.
    pub(super) fn tshirt() -> Result<Self> {
        Self::folded_thrice(&TSHIRT)
    }

    /// A handkerchief that is crumpled, in the paper's fabric.
    pub(super) fn crumpled() -> Result<Self> {
        let script = WearScript::parse("crumple.json", CRUMPLE_SCRIPT)?;
        Self::with_script(HANDKERCHIEF.garment()?, None, "crumple.json", script)
    }

    /// A sleeve on an arm that bends once, in the paper's fabric.
    pub(super) fn elbow() -> Result<Self> {
        let (garment, body) = sleeve_on_arm()?;
        let script = WearScript::parse("elbow.json", BEND_SCRIPT)?;
        Self::with_script(garment, Some(body), "elbow.json", script)
    }

    /// A strip of 32 x 44 cm that falls, in the paper's fabric.
    pub(super) fn falling_strip() -> Result<Self> {
        let [_, _, points] = FALLING_STRIP_POINTS;
        let script = WearScript::parse("fall.json", FALL_SCRIPT)?;
        Self::with_script(tilted_strip(points, FIRST_TILT)?, None, "fall.json", script)
    }

    fn folded_thrice(mesh: &IncludedMesh) -> Result<Self> {
        Self::with_script(mesh.garment()?, None, "fold-thrice.json", WearScript::preset(FOLD_THRICE)?)
    }

    fn with_script(
        garment: Garment,
        body: Option<Arc<AnimatedBody>>,
        script_file: &'static str,
        script: WearScript,
    ) -> Result<Self> {
        Ok(Self { garment, fabric: Fabric::preset(PAPER_FABRIC)?, script_file, script, body })
    }

    /// The same scene with another garment.
    fn with_garment(&self, garment: Garment) -> Self {
        let Self { fabric, script_file, script, body, .. } = self;
        let (fabric, script, body) = (fabric.clone(), script.clone(), body.clone());
        Self { garment, fabric, script_file, script, body }
    }

    /// The garment.
    pub(super) fn garment(&self) -> &Garment {
        &self.garment
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
        self.with_garment(self.garment.refine(edge, &[]).garment)
    }

    /// The same garment with a perturbed initial condition: points moved at random by up to a fiftieth of the mean
    /// edge along every axis, reproducibly for each `seed`.
    #[must_use]
    pub(super) fn perturbed(&self, seed: u64) -> Self {
        let mut garment = self.garment.clone();
        let mut rng = Rng::from_seed(seed);
        let amplitude = PERTURBATION_FRACTION * garment.mean_edge();
        garment.points.iter_mut().for_each(|x| *x += rng.in_cube() * amplitude);
        self.with_garment(garment)
    }

    /// Bakes the script.
    pub(super) fn run(&self, options: &BakeOptions) -> Result<BakeRun> {
        let clock = Instant::now();
        let mut options = options.clone();
        options.body = self.body.clone();
        let bake = Bake::new(&self.garment, &self.fabric, &self.script).script_name(self.script_file);
        let baked = bake.options(options).run()?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elbow_bends_once_as_it_does_ten_times() {
        let ten = WearScript::preset_text("elbow-ten-bends").unwrap();
        let read = |text| serde_json::from_str::<serde_json::Value>(text).unwrap();
        let [mut ten, one] = [ten, BEND_SCRIPT].map(read);
        let bend = ten["actions"][0]["bend"].as_object_mut().unwrap();
        assert_eq!(bend.remove("repeat"), Some(10.into()));
        assert_eq!(ten["actions"], one["actions"]);
    }

    #[test]
    fn every_scene_can_be_read() {
        for scene in [BakeScene::tshirt_draft(), BakeScene::crumpled(), BakeScene::elbow()] {
            let scene = scene.expect("is included");
            assert!(scene.points() > 1000 && scene.perturbed(1).garment().points != scene.garment().points);
        }
    }
}
