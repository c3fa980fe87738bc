//! The leash of a garment that is skinned in its file: every point stays within a distance of its skinned position.
//!
//! Held points ([`HeldPoints`]) stay where their skin is. The distance grows with that along the cloth from them,
//!
//! ```text
//! r(s) = g s / (1 - s/l)      (s: distance along the cloth to the nearest held point, g: growth)
//! ```
//!
//! as long as that is less than 2 s, which cloth on a rigid skin cannot leave: beyond it is free,
//! so that what hangs from a waistband swings freely and does not fall off. Points that begin inside the body have what
//! brings them out of it in addition. The energy is that of [`crease_solver::energy::Leash`]; held points are carried along at the
//! beginning of a step. Acts while the garment is on its body.

use crate::bake::body::held_points::HeldPoints;
use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, ModelDecision};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::edge_distances;
use crease_model::body::{AnimatedBody, BodyPose, GarmentSkin, PosedBody, SkinLocation};
use crease_model::error::{Message, Operation, Setting};
use crease_model::garment::Garment;
use crease_model::remesh::Refinement;
use crease_solver::energy::Leash;
use std::sync::Arc;

/// Leashes of all points of a garment.
pub(in crate::bake) struct GarmentLeash {
    skin: Arc<GarmentSkin>,
    body: Arc<AnimatedBody>,
    /// Per point: its location on the skin.
    locations: Vec<Option<SkinLocation>>,
    /// Per point: length of the leash [m]; infinite for free points.
    radius: Vec<f64>,
    /// Per point: stiffness [N/m].
    stiffness: Vec<f64>,
    held: HeldPoints,
}

impl GarmentLeash {
    /// The leash of `garment` by the skin and on the body of `options`, if it has both.
    pub fn new(garment: &Garment, options: &BakeOptions) -> Option<Self> {
        let (skin, body) = (options.skin.clone()?, options.body.clone()?);
        let tuning = &TUNING.leash;
        let locations = skin.locate(&garment.points);
        let main_node = skin.main_nodes(&locations);
        let held = match skin.held(&locations) {
            Some(values) => HeldPoints::marked(&values),
            None => HeldPoints::found(garment, &body, &main_node),
        };
        let distances = edge_distances(&garment.points, &garment.topology, &held.flags, tuning.free_distance);
        let radius = |(distance, at): (f64, &Option<SkinLocation>)| match at {
            Some(_) if distance < (1.0 - 0.5 * tuning.growth) * tuning.free_distance => {
                tuning.growth * distance / (1.0 - distance / tuning.free_distance)
            }
            _ => f64::INFINITY,
        };
        let radius = distances.into_iter().zip(&locations).map(radius).collect();
        Some(Self { skin, body, locations, radius, stiffness: vec![0.0; garment.points.len()], held })
    }

    /// The leash of the refined mesh of the same cloth, on which a new point has the mean of its neighbours.
    pub fn on_refined(&self, refinement: &Refinement) -> Self {
        let mean = |values: &[f64]| -> Vec<f64> {
            let wide: Vec<Vec3> = values.iter().map(|value| Vec3::repeat(*value)).collect();
            refinement.points(&wide).into_iter().map(|value| value.x).collect()
        };
        Self {
            skin: self.skin.clone(),
            body: self.body.clone(),
            locations: self.skin.locate(&refinement.mesh.garment.points),
            radius: mean(&self.radius),
            stiffness: mean(&self.stiffness),
            held: HeldPoints { flags: refinement.flags(&self.held.flags), ..self.held.clone() },
        }
    }

    /// Sets the stiffness of the points, which stand for `areas` [m²], from that of contact per area [N/m³], and lengthens
    /// the leash of each point by what brings it out of the body, where it lies `depths` [m] deep, to the gap `clearance` [m].
    pub fn prepare(&mut self, areas: &[f64], stiffness: f64, depths: &[f64], clearance: f64) {
        self.stiffness = areas.iter().map(|area| area * stiffness).collect();
        for (radius, depth) in self.radius.iter_mut().zip(depths).filter(|(_, depth)| **depth > 0.0) {
            *radius += depth + clearance;
        }
    }

    /// The decision that the report shows.
    pub fn decision(&self) -> ModelDecision {
        let count = self.radius.len();
        let free = self.radius.iter().filter(|radius| radius.is_infinite()).count();
        let longest = self.radius.iter().copied().filter(|radius| radius.is_finite()).fold(0.0, f64::max);
        let why = format!(
            "{} of {count} points held to the skin of the file: {}; others up to {longest:.2} m from it, {free} free (",
            self.held.flags.iter().filter(|flag| **flag).count(),
            self.held.describe()
        );
        let why = Message::from(why)
            + Setting::Hold
            + " chooses what is held, "
            + Setting::Hold.to("none")
            + " nothing)";
        ModelDecision { name: "leash", on: true, why }
    }

    /// The decision that the memory of the animation is enough, where nearly all of the garment is held.
    pub fn memory_from_motion(&self) -> Option<ModelDecision> {
        let held =
            self.held.flags.iter().filter(|flag| **flag).count() as f64 / self.radius.len().max(1) as f64;
        let why = Message::from(format!("{:.0} % of the points follow their skin: `", 100.0 * held))
            + Operation::Remember
            + "` makes nearly the same of the clip without a simulation";
        (held >= TUNING.leash.min_remembered).then_some(ModelDecision {
            name: "remember instead",
            on: false,
            why,
        })
    }

    /// One flag per point: whether its leash moves with the body through `poses` by more than `min_motion` [m].
    pub fn moved_points(&self, poses: &[BodyPose], min_motion: f64) -> Vec<bool> {
        let start = self.positions(&self.body.rest());
        let mut moved = vec![false; start.len()];
        for pose in poses {
            for (moved, (a, b)) in moved.iter_mut().zip(start.iter().zip(self.positions(pose))) {
                *moved |= a.zip(b).is_some_and(|(a, b)| (a - b).norm() > min_motion);
            }
        }
        moved.iter().zip(&self.radius).map(|(moved, radius)| *moved && radius.is_finite()).collect()
    }

    fn positions(&self, pose: &BodyPose) -> Vec<Option<Vec3>> {
        self.skin.positions(&self.locations, &self.body, pose)
    }

    /// The leashes with the body as `posed`, of the points that are not `fixed` (empty for none).
    pub fn leashes(&self, posed: &PosedBody, fixed: &[bool]) -> Vec<Leash> {
        let is_fixed = |p: usize| fixed.get(p).copied().unwrap_or(false);
        let leash = |(p, anchor): (usize, Option<Vec3>)| {
            let radius = self.radius[p];
            let anchor = anchor.filter(|_| radius.is_finite() && !is_fixed(p))?;
            Some(Leash { point: p as u32, anchor, radius, stiffness: self.stiffness[p] })
        };
        self.positions(&posed.pose).into_iter().enumerate().filter_map(leash).collect()
    }
}

/// Adds to `displacement`, one per point [m], with which cloth follows the body from the leashes `before` a step to those
/// `after` it: all of it for held points and for points on short leashes, less on longer ones. Points of `carried` follow
/// the surface of the body instead, as far as their leashes let them.
pub(in crate::bake) fn follow_leashes(
    displacement: &mut [Vec3],
    before: &[Leash],
    after: &[Leash],
    is_carried: impl Fn(usize) -> bool,
) {
    // Both lists are in the order of the points, but each leaves out those that were fixed then.
    let mut before = before.iter().peekable();
    for to in after {
        while before.next_if(|from| from.point < to.point).is_some() {}
        let Some(from) = before.next_if(|from| from.point == to.point) else { continue };
        let p = from.point as usize;
        let length = if is_carried(p) { TUNING.leash.carried_length } else { TUNING.leash.following_length };
        let fraction = (1.0 - from.radius / length).max(0.0);
        displacement[p] += (to.anchor - from.anchor - displacement[p]) * fraction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 0 and 3 are fixed before the step, point 1 after it.
    #[test]
    fn points_with_a_leash_before_and_after_a_step_follow_it() {
        let leash =
            |point: u32, x: f64| Leash { point, anchor: Vec3::new(x, 0.0, 0.0), radius: 0.0, stiffness: 1.0 };
        let before = [1, 2, 4].map(|p| leash(p, 0.0));
        let after = [0, 2, 3, 4].map(|p| leash(p, f64::from(p)));
        let mut displacement = vec![Vec3::zeros(); 5];
        follow_leashes(&mut displacement, &before, &after, |_| false);
        assert_eq!(displacement.iter().map(|d| d.x).collect::<Vec<_>>(), [0.0, 0.0, 2.0, 0.0, 4.0]);
    }
}
