//! Selects the points that a moving body can affect; all others are fixed.
//!
//! Where only the body moves, cloth far from its moving parts stays where it is, on the static part of the body under it,
//! and is left out of the solve. Active are the points near a moving part of the body in any of its poses, those whose
//! leash moves, and those joined to them within a hand's breadth of cloth.

use crate::bake::BakeOptions;
use crate::bake::leash::GarmentLeash;
use crate::bake::tuning::TUNING;
use crate::body::{AnimatedBody, BodyPose};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, edge_distances};
use crate::wear::WearScript;

/// Points of `garment` that the body of `options` can affect during `script`, one flag per point. Empty when all points are
/// to be simulated: without a body, with a body that does not move, or with [`BakeOptions::deactivate_static`] off.
pub fn active_points(garment: &Garment, script: &WearScript, options: &BakeOptions) -> Vec<bool> {
    active_points_on(garment, GarmentLeash::new(garment, options).as_ref(), script, options)
}

/// The same for `garment` on its `leash`, if it has one.
pub(super) fn active_points_on(
    garment: &Garment,
    leash: Option<&GarmentLeash>,
    script: &WearScript,
    options: &BakeOptions,
) -> Vec<bool> {
    let Some(animated) = options.body.as_ref().filter(|_| options.deactivate_static) else {
        return Vec::new();
    };
    let poses = script.body_poses(animated);
    let mut near = points_near_motion(garment, animated, &poses);
    if let Some(leash) = leash {
        let moved = leash.moved_points(&poses, TUNING.active_region.min_body_motion);
        near.iter_mut().zip(moved).for_each(|(near, moved)| *near |= moved);
    }
    let margin = TUNING.active_region.geodesic_margin;
    let distance = edge_distances(&garment.points, &garment.topology, &near, margin);
    let active: Vec<bool> = distance.into_iter().map(|distance| distance <= margin).collect();
    if active.contains(&true) { active } else { Vec::new() }
}

/// One flag per point of `garment`: whether it is near a part of the body that moves through `poses`.
fn points_near_motion(garment: &Garment, animated: &AnimatedBody, poses: &[BodyPose]) -> Vec<bool> {
    let tuning = &TUNING.active_region;
    let start = animated.rest_points();
    let posed: Vec<Vec<Vec3>> = poses.iter().map(|pose| animated.points(pose)).collect();
    let mut moves = vec![false; start.len()];
    for positions in &posed {
        for ((moves, a), b) in moves.iter_mut().zip(start).zip(positions) {
            *moves |= (a - b).norm() > tuning.min_body_motion;
        }
    }
    let moving: Vec<[PointIndex; 3]> =
        animated.triangles().iter().filter(|t| t.iter().any(|p| moves[p.at()])).copied().collect();
    let mut near = vec![false; garment.points.len()];
    if moving.is_empty() {
        return near;
    }
    let mut tree = TriangleBvh::new(start, &moving, 0.0);
    for positions in std::iter::once(start).chain(posed.iter().map(Vec::as_slice)) {
        tree.refit(positions, positions, 0.0);
        for (near, x) in near.iter_mut().zip(&garment.points).filter(|(near, _)| !**near) {
            *near = tree.nearest(positions, *x, tuning.max_body_distance).is_some();
        }
    }
    near
}
