//! Distances over the surface of a mesh, measured along its edges.

use crate::math::Vec3;
use crate::mesh::Topology;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Per point: distance along edges from the nearest of the points flagged in `from` [m], by Dijkstra's algorithm. Distances up to
/// `reach` [m] are right; beyond it they are those over points within it, infinite elsewhere.
pub fn edge_distances(points: &[Vec3], topology: &Topology, from: &[bool], reach: f64) -> Vec<f64> {
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
        if so_far > distance[point as usize] || so_far > reach {
            continue;
        }
        for &(next, length) in &neighbours[point as usize] {
            let there = so_far + length;
            if there < distance[next as usize] {
                distance[next as usize] = there;
                open.push(OpenPoint { distance: there, point: next });
            }
        }
    }
    distance
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
