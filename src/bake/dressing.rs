//! Dressing: a garment that starts a little inside its body is brought outside before the wear begins.
//!
//! The body is drawn in where cloth lies inside it until nothing crosses, then grows back to its own shape while the
//! cloth gives way: the same contact and the same bound as in any step, so that no layer crosses another and none is left
//! behind. Nothing is remembered of it. Clothes that lie deeper than a body can be drawn in do not fit: refused with the
//! number. Does not do: moving a garment to another body, sizes, poses.

use super::Run;
use crate::body::Wearer;
use crate::contact::Body;
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::PointIndex;
use crate::mesh::crossings::crossings_between;
use crate::mesh::inside::Solid;
use crate::wear::Drive;
use std::sync::Arc;

/// Cloth that is deeper inside than this does not fit [m].
const DEEPEST: f64 = 0.030;
/// Up to here dressing is made for [m].
const USUAL: f64 = 0.015;
/// How far inside is looked [m].
const SEARCH: f64 = 0.3;
/// The body is drawn in so much farther than cloth lies inside [m].
const MARGIN: f64 = 0.002;
/// Around cloth that lies inside, the body is drawn in within this many depths, and at least this far [m].
const AROUND: f64 = 2.0;
const AROUND_LEAST: f64 = 0.02;
/// Rounds in which the body is drawn in farther where cloth still crosses it.
const ROUNDS: usize = 12;
/// Steps in which it grows back, and their length [s].
const STEPS: usize = 10;
const STEP: f64 = 0.1;

/// What dressing found and did.
pub(super) struct Dressed {
    /// Points of the garment that lay inside, and how deep the deepest [m].
    pub inside: usize,
    pub deepest: f64,
    /// Triangles of the garment and the body that crossed before and after.
    pub crossed: [usize; 2],
    /// The farthest any point was pushed [m].
    pub pushed: f64,
}

impl Dressed {
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
pub(super) fn depths(garment_points: &[Vec3], wearer: &Wearer) -> Result<Vec<f64>> {
    let depths = Solid::new(wearer.start(), wearer.triangles()).depths(garment_points, SEARCH);
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
    Err(Error::fault(&wearer.file, "", what, "fit the garment to this body first, or check the unit of both"))
}

impl Run<'_> {
    /// Brings the body in, and the garment outside of it.
    pub(super) fn dress(&mut self, wearer: &Arc<Wearer>, depths: &[f64]) -> Result<Dressed> {
        let (start, triangles) = (wearer.start(), wearer.triangles());
        let crossed = crossings_between(&self.state.x, &self.garment.triangles, start, triangles).len();
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let inside = depths.iter().filter(|d| **d > 0.0).count();
        let mut dressed = Dressed { inside, deepest, crossed: [crossed, 0], pushed: 0.0 };
        if crossed == 0 && inside == 0 {
            self.stepper.contact.set_body(Some(Body::new(start.to_vec(), triangles.to_vec())?));
            return Ok(dressed);
        }
        let drawn_in = self.drawn_in(wearer, depths);
        self.stepper.contact.set_body(Some(Body::new(drawn_in.clone(), triangles.to_vec())?));
        let before = self.state.clone();
        let still = Drive {
            gravity: Vec3::zeros(),
            drag: 20.0,
            friction: 0.0,
            longest_step: STEP,
            ..Drive::at_rest(None)
        };
        for k in 1..=STEPS + 2 {
            let share = (k as f64 / STEPS as f64).min(1.0);
            let goal: Arc<[Vec3]> = drawn_in.iter().zip(start).map(|(a, b)| a + (b - a) * share).collect();
            let mut drive = |_: f64, _: &_| Drive { body: Some(goal.clone()), ..still.clone() };
            self.state.stop();
            let step = self.stepper.advance(&mut self.state, &self.memory.felt, &mut drive, STEP);
            self.report.solves += step.newton.iterations as u64;
            self.report.local_solves += step.newton.local_iterations as u64;
            if k > STEPS && !self.stepper.contact.body_lags() {
                break;
            }
        }
        self.state.stop();
        self.state.time = 0.0;
        let there = self.stepper.contact.body().map(|body| body.points().to_vec()).unwrap_or_default();
        dressed.crossed[1] =
            crossings_between(&self.state.x, &self.garment.triangles, &there, triangles).len();
        dressed.pushed =
            before.x.iter().zip(&self.state.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        Ok(dressed)
    }

    /// The body drawn in until the cloth is outside.
    fn drawn_in(&self, wearer: &Wearer, depths: &[f64]) -> Vec<Vec3> {
        let (start, triangles) = (wearer.start(), wearer.triangles());
        let normals = crate::mesh::inside::point_normals(start, triangles);
        let mut depth = vec![0.0f64; start.len()];
        for (x, own) in self.state.x.iter().zip(depths).filter(|(_, d)| **d > 0.0) {
            let reach = (AROUND * own).max(AROUND_LEAST);
            for (depth, at) in depth.iter_mut().zip(start) {
                let far = (at - x).norm() / reach;
                if far < 1.0 {
                    // Full nearby, then falling off.
                    *depth = depth.max((own + MARGIN) * (2.0 - 2.0 * far).min(1.0));
                }
            }
        }
        let mut places = Vec::new();
        for _ in 0..ROUNDS {
            places = start.iter().zip(&normals).zip(&depth).map(|((x, n), d)| x - n * *d).collect();
            let crossing = crossings_between(&self.state.x, &self.garment.triangles, &places, triangles);
            if crossing.is_empty() {
                break;
            }
            let mut more = vec![false; start.len()];
            let corners = |f: u32| triangles.get(f as usize).copied().unwrap_or([PointIndex(0); 3]);
            crossing.iter().flat_map(|pair| corners(pair[1])).for_each(|p| more[p.at()] = true);
            // Their neighbours, too: a single point drawn in makes a pit, and its rim still crosses.
            let ring: Vec<[PointIndex; 3]> =
                triangles.iter().filter(|t| t.iter().any(|p| more[p.at()])).copied().collect();
            ring.iter().flatten().for_each(|p| more[p.at()] = true);
            for (depth, _) in depth.iter_mut().zip(&more).filter(|(_, more)| **more) {
                *depth = (*depth + 0.5 * MARGIN).min(DEEPEST);
            }
        }
        places
    }
}
