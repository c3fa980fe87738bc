//! What of a garment a moving body can stir: the rest sleeps.
//!
//! Where only a body moves, cloth far from what moves of it has nothing to do: it stays where it is, with the body that
//! stands under it, and costs nothing in the solver. Awake is what lies near a moving part of the body in any of its
//! postures, and what is joined to it within a hand's breadth of cloth.

use crate::body::{AnimatedBody, BodyPose};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, Topology};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A part of a body that moves by less than this stands [m].
const STIRRED: f64 = 2e-4;
/// Cloth nearer than this to a moving part is awake [m].
const REACH: f64 = 0.03;
/// So is cloth that is joined to it over less than this [m].
const PULL: f64 = 0.10;

/// One flag per point of `garment`: whether the body stirs it on its way through `postures`.
pub(super) fn awake(garment: &Garment, wearer: &AnimatedBody, postures: &[BodyPose]) -> Vec<bool> {
    let start = wearer.rest_points();
    let places: Vec<Vec<Vec3>> = postures.iter().map(|pose| wearer.points(pose)).collect();
    let mut moves = vec![false; start.len()];
    for place in &places {
        for ((moves, a), b) in moves.iter_mut().zip(start).zip(place) {
            *moves |= (a - b).norm() > STIRRED;
        }
    }
    let moving: Vec<[PointIndex; 3]> =
        wearer.triangles().iter().filter(|t| t.iter().any(|p| moves[p.at()])).copied().collect();
    let mut near = vec![false; garment.points.len()];
    if moving.is_empty() {
        return near;
    }
    let mut tree = TriangleBvh::new(start, &moving, 0.0);
    for place in std::iter::once(start).chain(places.iter().map(Vec::as_slice)) {
        tree.refit(place, place, 0.0);
        for (near, x) in near.iter_mut().zip(&garment.points).filter(|(near, _)| !**near) {
            *near = tree.nearest(place, *x, REACH).is_some();
        }
    }
    within(&garment.points, &garment.topology, &near, PULL)
}

/// The points within `most` [m] of flagged ones along edges.
fn within(points: &[Vec3], topology: &Topology, from: &[bool], most: f64) -> Vec<bool> {
    let mut around: Vec<Vec<(u32, f64)>> = vec![Vec::new(); points.len()];
    for [a, b] in &topology.edges {
        let length = (points[a.at()] - points[b.at()]).norm();
        around[a.at()].push((b.0, length));
        around[b.at()].push((a.0, length));
    }
    let mut way = vec![f64::INFINITY; points.len()];
    let mut open = BinaryHeap::new();
    for (p, _) in from.iter().enumerate().filter(|(_, from)| **from) {
        way[p] = 0.0;
        open.push(Open { way: 0.0, point: p as u32 });
    }
    while let Some(Open { way: so_far, point }) = open.pop() {
        if so_far > way[point as usize] {
            continue;
        }
        for &(next, length) in &around[point as usize] {
            let there = so_far + length;
            if there <= most && there < way[next as usize] {
                way[next as usize] = there;
                open.push(Open { way: there, point: next });
            }
        }
    }
    way.iter().map(|way| way.is_finite()).collect()
}

/// A point still to go on from; the nearest first.
#[derive(PartialEq)]
struct Open {
    way: f64,
    point: u32,
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.way.total_cmp(&self.way).then(other.point.cmp(&self.point))
    }
}
