//! Dressing: a garment that starts a little inside its body is brought outside before the wear begins.
//!
//! A few steps without weight and without friction, in which the body pushes the cloth out as it does in any step
//! (`contact::body_field`), and layers are kept apart as ever. Nothing is remembered of it. Clothes that lie deeper inside
//! do not fit: refused with the number. Does not do: moving a garment to another body, sizes, poses.

use crate::bake::Run;
use crate::bake::body_coupling::BodyPenetrationStats;
use crate::body::AnimatedBody;
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::intersections::intersections_between;
use crate::mesh::point_in_solid::Solid;
use crate::sim::Loads;
use crate::wear::ConstantLoads;
use std::sync::Arc;

/// Cloth that is deeper inside than this does not fit [m].
const DEEPEST: f64 = 0.030;
/// Up to here dressing is made for [m].
const USUAL: f64 = 0.015;
/// How far inside is looked [m].
const SEARCH: f64 = 0.3;
/// Steps in which it is pushed out, at least and at most, and their length [s].
const STEPS: [usize; 2] = [8, 60];
const STEP: f64 = 0.1;

/// What dressing found and did.
pub(super) struct DepenetrationReport {
    /// Points of the garment that lay inside, and how deep the deepest [m].
    pub inside: usize,
    pub deepest: f64,
    /// Triangles of the garment and the body that crossed before and after.
    pub crossed: [usize; 2],
    /// The farthest any point was pushed [m].
    pub pushed: f64,
}

impl DepenetrationReport {
    /// For the report, if there is anything to say.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.crossed[0] > 0 || self.inside > 0 {
            all.push(format!(
                "dressing: {} points of the garment lay up to {:.1} mm inside the body, {} pairs of triangles crossed it: pushed out by up \
                 to {:.1} mm",
                self.inside,
                1e3 * self.deepest,
                self.crossed[0],
                1e3 * self.pushed
            ));
        }
        if self.deepest > USUAL {
            all.push(format!(
                "dressing: {:.1} mm is more than the {:.0} mm that it is made for: check the fit",
                1e3 * self.deepest,
                1e3 * USUAL
            ));
        }
        if self.crossed[1] > 0 {
            all.push(format!(
                "dressing: {} pairs of triangles still cross the body; they are left alone until they come apart",
                self.crossed[1]
            ));
        }
        all
    }
}

/// Refuses a garment that does not fit the body.
pub(super) fn depths(garment_points: &[Vec3], wearer: &AnimatedBody) -> Result<Vec<f64>> {
    let depths = Solid::new(wearer.rest_points(), wearer.triangles()).depths(garment_points, SEARCH);
    let (deepest, at) =
        depths.iter().copied().zip(0..).fold((0.0, 0), |most, d| if d.0 > most.0 { d } else { most });
    if deepest <= DEEPEST {
        return Ok(depths);
    }
    let count = depths.iter().filter(|d| **d > DEEPEST).count();
    let place = garment_points.get(at).copied().unwrap_or_else(Vec3::zeros);
    let what = format!(
        "the garment lies up to {:.0} mm inside it, at ({:.3}, {:.3}, {:.3}) m; {count} points are deeper than {:.0} mm",
        1e3 * deepest,
        place.x,
        place.y,
        place.z,
        1e3 * DEEPEST
    );
    Err(Error::input(&wearer.file, "", what, "fit the garment to this body first, or check the unit of both"))
}

impl Run<'_> {
    /// Brings the garment outside of the body.
    pub(super) fn dress(&mut self, wearer: &Arc<AnimatedBody>, depths: &[f64]) -> DepenetrationReport {
        let (start, triangles) = (wearer.rest_points(), wearer.triangles());
        let count = |x: &[Vec3]| intersections_between(x, &self.garment.triangles, start, triangles).len();
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let inside = depths.iter().filter(|d| **d > 0.0).count();
        let crossed = count(&self.state.x);
        let mut dressed = DepenetrationReport { inside, deepest, crossed: [crossed, 0], pushed: 0.0 };
        if crossed == 0 && inside == 0 {
            return dressed;
        }
        let before = self.state.x.clone();
        let body: Arc<[Vec3]> = start.into();
        let drive = Loads {
            gravity: Vec3::zeros(),
            drag: 20.0,
            friction: 0.0,
            max_dt: STEP,
            body: Some(body),
            ..Loads::gravity_only(None)
        };
        for step in 0..STEPS[1] {
            if step >= STEPS[0] && count(&self.state.x) == 0 {
                break;
            }
            self.state.stop();
            let Some(field) = self.field.take() else { break };
            let step = self.step_on_body(
                field,
                &mut ConstantLoads { loads: drive.clone(), may_end_early: false },
                0.0,
                STEP,
            );
            self.report.solves += step.newton.global_iterations as u64;
            self.report.local_solves += step.newton.local_iterations as u64;
        }
        self.state.stop();
        self.state.time = 0.0;
        self.pinch = BodyPenetrationStats::default();
        dressed.crossed[1] = count(&self.state.x);
        dressed.pushed = before.iter().zip(&self.state.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        dressed
    }
}
