//! Selects the points that a moving body can affect; all others are fixed.
//!
//! Where only the body moves, cloth far from its moving parts stays where it is, on the static part of the body under it,
//! and is left out of the solve. Active are the points near a moving part of the body in any of its poses, and those joined
//! to them within a hand's breadth of cloth.

use crate::bake::BakeOptions;
use crate::bake::tuning::TUNING;
use crate::body::{AnimatedBody, BodyPose};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, Topology};
use crate::wear::WearScript;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Points of `garment` that the body of `options` can affect during `script`, one flag per point. Empty when all points are
/// to be simulated: without a body, with a body that does not move, or with [`BakeOptions::deactivate_static`] off.
pub fn active_points(garment: &Garment, script: &WearScript, options: &BakeOptions) -> Vec<bool> {
    let Some(animated) = options.body.as_ref().filter(|_| options.deactivate_static) else {
        return Vec::new();
    };
    let active = points_near_motion(garment, animated, &script.body_poses(animated));
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
    within_distance(&garment.points, &garment.topology, &near, tuning.geodesic_margin)
}

/// Points within `max_distance` [m] of flagged ones along edges, by Dijkstra's algorithm.
fn within_distance(points: &[Vec3], topology: &Topology, from: &[bool], max_distance: f64) -> Vec<bool> {
    let mut neighbours: Vec<Vec<(u32, f64)>> = vec![Vec::new(); points.len()];
    for [a, b] in &topology.edges {
        let length = (points[a.at()] - points[b.at()]).norm();
        neighbours[a.at()].push((b.0, length));
        neighbours[b.at()].push((a.0, length));
    }
    let mut distance = vec![f64::INFINITY; points.len()];
    let mut open = BinaryHeap::new();
    for (p, _) in from.iter().enumerate().filter(|(_, from)| **from) {
        distance[p] = 0.0;
        open.push(OpenPoint { distance: 0.0, point: p as u32 });
    }
    while let Some(OpenPoint { distance: so_far, point }) = open.pop() {
        if so_far > distance[point as usize] {
            continue;
        }
        for &(next, length) in &neighbours[point as usize] {
            let there = so_far + length;
            if there <= max_distance && there < distance[next as usize] {
                distance[next as usize] = there;
                open.push(OpenPoint { distance: there, point: next });
            }
        }
    }
    distance.iter().map(|distance| distance.is_finite()).collect()
}

/// A point whose neighbours are still to be visited; the smallest distance comes first.
#[derive(PartialEq)]
struct OpenPoint {
    distance: f64,
    point: u32,
}

impl Eq for OpenPoint {}

impl PartialOrd for OpenPoint {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OpenPoint {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.point.cmp(&self.point))
    }
}
