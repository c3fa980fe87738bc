//! Depenetration: a garment that starts a little inside its body is pushed out before the script begins.
//!
//! A few steps without gravity and without friction, in which the contact planes of the body push the cloth out as in any
//! step (`contact::body_planes`) and self-contact keeps layers apart. The memory law is not applied. A garment that lies
//! deeper inside does not fit and is refused with the depth. Does not do: fitting a garment to another body, size or pose.

use crate::bake::body_coupling::{BodyCoupling, SteppedCloth};
use crate::bake::body_penetration::BodyPenetrationStats;
use crate::bake::tuning::TUNING;
use crate::body::AnimatedBody;
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::intersections::intersections_between;
use crate::mesh::point_in_solid::Solid;
use crate::sim::Loads;
use crate::wear::ConstantLoads;
use std::sync::Arc;

/// Outcome of the depenetration.
pub(super) struct DepenetrationReport {
    /// Points of the garment that lay inside.
    inside: usize,
    /// Largest depth of a point inside [m].
    max_depth: f64,
    /// Intersecting pairs of triangles of garment and body before.
    crossing_before: usize,
    /// The same after.
    crossing_after: usize,
    /// Largest displacement of a point [m].
    max_displacement: f64,
    /// Linear solves of global Newton iterations.
    pub solves: u64,
    /// Linear solves of local Newton iterations.
    pub local_solves: u64,
}

impl DepenetrationReport {
    /// Warnings, if anything lay inside.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.crossing_before > 0 || self.inside > 0 {
            all.push(format!(
                "depenetration: {} points of the garment lay up to {:.1} mm inside the body, {} pairs of triangles crossed it: pushed out by \
                 up to {:.1} mm",
                self.inside,
                1e3 * self.max_depth,
                self.crossing_before,
                1e3 * self.max_displacement
            ));
        }
        if self.max_depth > TUNING.body.max_usual_depth {
            all.push(format!(
                "depenetration: {:.1} mm is more than the {:.0} mm that it is made for: check the fit",
                1e3 * self.max_depth,
                1e3 * TUNING.body.max_usual_depth
            ));
        }
        if self.crossing_after > 0 {
            all.push(format!(
                "depenetration: {} pairs of triangles still cross the body; they are left alone until they come apart",
                self.crossing_after
            ));
        }
        all
    }
}

/// Depth of every point inside the body [m], 0 outside. Fails if the garment does not fit the body.
pub(super) fn penetration_depths(garment_points: &[Vec3], animated: &AnimatedBody) -> Result<Vec<f64>> {
    let limit = TUNING.body.max_fit_depth;
    let depths = Solid::new(animated.rest_points(), animated.triangles())
        .depths(garment_points, TUNING.body.depth_search);
    let (deepest, at) =
        depths.iter().copied().zip(0..).fold((0.0, 0), |max, d| if d.0 > max.0 { d } else { max });
    if deepest <= limit {
        return Ok(depths);
    }
    let count = depths.iter().filter(|d| **d > limit).count();
    let position = garment_points.get(at).copied().unwrap_or_else(Vec3::zeros);
    let what = format!(
        "the garment lies up to {:.0} mm inside it, at ({:.3}, {:.3}, {:.3}) m; {count} points are deeper than {:.0} mm",
        1e3 * deepest,
        position.x,
        position.y,
        position.z,
        1e3 * limit
    );
    Err(Error::input(
        &animated.file,
        "",
        what,
        "fit the garment to this body first, or check the unit of both",
    ))
}

/// Pushes the cloth, whose points lie `depths` [m] inside, out of `animated`.
pub(super) fn depenetrate(
    body: &mut BodyCoupling,
    cloth: SteppedCloth,
    animated: &AnimatedBody,
    depths: &[f64],
) -> DepenetrationReport {
    let SteppedCloth { garment, stepper, state, rest } = cloth;
    let tuning = &TUNING.body;
    let (start, triangles) = (animated.rest_points(), animated.triangles());
    let count = |x: &[Vec3]| intersections_between(x, &garment.triangles, start, triangles).len();
    let crossing = count(&state.x);
    let mut report = DepenetrationReport {
        inside: depths.iter().filter(|d| **d > 0.0).count(),
        max_depth: depths.iter().copied().fold(0.0, f64::max),
        crossing_before: crossing,
        crossing_after: 0,
        max_displacement: 0.0,
        solves: 0,
        local_solves: 0,
    };
    if crossing == 0 && report.inside == 0 {
        return report;
    }
    let before = state.x.clone();
    let positions: Arc<[Vec3]> = start.into();
    let loads = Loads {
        gravity: Vec3::zeros(),
        drag: tuning.depenetration_drag,
        friction: 0.0,
        max_dt: tuning.depenetration_dt,
        body: Some(positions),
        ..Loads::gravity_only(None)
    };
    for step in 0..tuning.max_depenetration_steps {
        if step >= tuning.min_depenetration_steps && count(&state.x) == 0 {
            break;
        }
        state.stop();
        let mut still = ConstantLoads { loads: loads.clone(), may_end_early: false };
        let cloth = SteppedCloth { garment, stepper, state, rest };
        let step = body.step(cloth, &mut still, 0.0, tuning.depenetration_dt);
        report.solves += step.newton.global_iterations as u64;
        report.local_solves += step.newton.local_iterations as u64;
    }
    state.stop();
    state.time = 0.0;
    body.penetration = BodyPenetrationStats::default();
    report.crossing_after = count(&state.x);
    report.max_displacement = before.iter().zip(&state.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    report
}
