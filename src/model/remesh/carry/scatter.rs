//! Curvature spread from the triangles of one mesh over those of another on the same surface, so that none of it is lost.
//!
//! Every source triangle is cut into equal parts; each part gives its curvature, with its area, to the target triangle that holds
//! its centre. The integral over the surface is kept exactly, however coarse or fine the target is.

use crate::garment::RestState;
use crate::remesh::carry::correspondence::smallest_rotation;
use crate::remesh::carry::hinge_fit::{FaceFrame, PlaneTensor, edge_tensor};
use crate::remesh::carry::surface::GarmentSurface;
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle::sample_weights;
use crease_geometry::mesh::{INVALID, SurfaceWalk};
use std::collections::VecDeque;

/// Mean change of curvature [1/m] of every triangle of `target`, from `memory` of `source`. `containing` has the triangle of `source`
/// that every point of `target` lies in.
pub fn scatter_curvature(
    source: &GarmentSurface,
    memory: &RestState,
    target: &GarmentSurface,
    containing: &[u32],
) -> Vec<PlaneTensor> {
    let walk = SurfaceWalk::new(target.points.len(), &target.triangles);
    let start = start_triangles(source, &walk, target, containing);
    let mut sum = vec![PlaneTensor::zeros(); target.triangles.len()];
    let frames: Vec<FaceFrame> = (0..sum.len()).map(|f| FaceFrame::new(&target.corners(f))).collect();
    for (f, &start) in start.iter().enumerate() {
        let angle = [0, 1, 2].map(|k| {
            let edge = source.topology.triangle_edges[f][k] as usize;
            let hinge = source.topology.edge_hinge[edge];
            hinge.map_or(0.0, |h| memory.rest_angle[h as usize] - memory.source_angle[h as usize])
        });
        if start == INVALID || angle.iter().all(|angle| *angle == 0.0) {
            continue;
        }
        let corners = source.corners(f);
        let normal = FaceFrame::new(&corners).normal;
        let parts = f64::from(TUNING.scatter_parts * TUNING.scatter_parts);
        for weights in sample_weights(TUNING.scatter_parts) {
            let x = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
            let there = closest(target, &walk, start, &x) as usize;
            let turn = smallest_rotation(&normal, &frames[there].normal);
            for k in 0..3 {
                let edge = turn * (corners[(k + 1) % 3] - corners[k]);
                // The curvature of a hinge times the area of its triangle is half its angle times its length.
                let integral = 0.5 * angle[k] * edge.norm() / parts;
                sum[there] += edge_tensor(&frames[there].project(&edge)) * integral;
            }
        }
    }
    for (f, tensor) in sum.iter_mut().enumerate() {
        let area = 0.5 * target.normal(f).norm();
        *tensor *= if area > 0.0 { 1.0 / area } else { 0.0 };
    }
    sum
}

/// Per triangle of `source`: a triangle of `target` near it on the surface; [`INVALID`] on parts without a point of `target`.
fn start_triangles(
    source: &GarmentSurface,
    walk: &SurfaceWalk,
    target: &GarmentSurface,
    containing: &[u32],
) -> Vec<u32> {
    let mut start = vec![INVALID; source.triangles.len()];
    for (g, t) in target.triangles.iter().enumerate() {
        for p in t {
            let f = containing[p.at()] as usize;
            start[f] = start[f].min(g as u32);
        }
    }
    let mut queue: VecDeque<usize> = (0..start.len()).filter(|&f| start[f] != INVALID).collect();
    while let Some(f) = queue.pop_front() {
        for &e in &source.topology.triangle_edges[f] {
            for &g in &source.topology.edge_triangles[e as usize] {
                if g != INVALID && start[g as usize] == INVALID {
                    let [a, b, c] = source.corners(g as usize);
                    start[g as usize] = closest(target, walk, start[f], &((a + b + c) / 3.0));
                    queue.push_back(g as usize);
                }
            }
        }
    }
    start
}

/// The triangle of `surface` closest to `x` [m] that is reached from `start`.
fn closest(surface: &GarmentSurface, walk: &SurfaceWalk, start: u32, x: &Vec3) -> u32 {
    walk.closest(&surface.points, &surface.triangles, start, x)
}
