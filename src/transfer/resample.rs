//! The memory of one source, gathered per triangle of the target: the middle of the transfer.
//!
//! On the source every triangle has the change of curvature its hinges make, `sum_e d_e l_e / (2 A) t_e t_e^T` with
//! `d = rest - source angle`. Each target triangle is sampled on an even grid about as fine as the source; a
//! sample takes the three hinges of the triangle it lands on, with their edges carried over by the map of directions, so
//! that every crease keeps its angle and its direction while lengths and areas become those of the target. What a triangle
//! gets is the mean over its samples, which is the integral over its area: nothing is lost between samples, whichever
//! mesh is finer.
//!
//! Stiffness goes over as compliance (hinges across a crease bend one after another, as springs in a row), weighted
//! towards hinges of the same direction by cos^4; rest lengths as the tensor of their changes along warp and weft.
//! Samples without a source count as new cloth.

use crate::garment::RestState;
use crate::math::{Vec2, Vec3};
use crate::transfer::GarmentSurface;
use crate::transfer::correspondence::Landing;
use crate::transfer::correspondence::{Lands, Place, texture_gradient};
use crate::transfer::hinge_fit::{FaceFrame, PlaneTensor, across};
use rayon::prelude::*;

/// Samples along a target side per source side, so that no source triangle is stepped over.
const FINENESS: f64 = 2.0;
/// Fewest and most samples along a side of a target triangle.
const GRID: [f64; 2] = [3.0, 24.0];
/// Mean of cos^4 over all directions: weight of cloth without direction.
const ANY_DIRECTION: f64 = 0.375;

/// What one target triangle gets.
#[derive(Debug, Clone)]
pub(super) struct Gathered {
    /// Mean change of curvature [1/m].
    pub(super) curvature: PlaneTensor,
    /// Mean change of rest length along the triangle's own warp and weft [-].
    pub(super) stretch: [f64; 2],
    /// Per side: compliance summed, and its weight.
    pub(super) compliance: [[f64; 2]; 3],
    /// Share of the samples that found a source.
    pub(super) found: f64,
    /// Mean quality of all samples, 0 where none was found.
    pub(super) confidence: f64,
    /// TransferSource triangles the samples landed on, sorted.
    pub(super) landed: Vec<u32>,
}

/// Hinge numbers of one source triangle, by its sides.
struct SourceFace {
    edges: [Vec3; 3],
    angle: [f64; 3],
    /// `None` for an open side, which carries no stiffness.
    compliance: [Option<f64>; 3],
}

/// Gathers for every triangle of `target`, standing aligned with the source it lands on. `sign` is -1 where one of both
/// garments has its normals inside.
pub(super) fn gather(
    lands: &impl Lands,
    memory: &RestState,
    target: &GarmentSurface,
    sign: f64,
) -> Vec<Gathered> {
    let source = lands.source();
    let faces: Vec<SourceFace> =
        (0..source.triangles.len()).map(|f| source_face(source, memory, f)).collect();
    let source_area: f64 = (0..source.triangles.len()).map(|f| 0.5 * source.normal(f).norm()).sum();
    let source_side = (source_area / source.triangles.len().max(1) as f64).sqrt();
    let outward = target.outward();
    let one = |f: usize| {
        let corners = target.corners(f);
        let frame = FaceFrame::of(&corners);
        let area = 0.5 * target.normal(f).norm();
        let grid =
            (FINENESS * area.sqrt() / source_side.max(f64::MIN_POSITIVE)).ceil().clamp(GRID[0], GRID[1]);
        let uv = target.uvs.as_ref().map(|uvs| uvs[f]);
        let gradient = uv.and_then(|uv| texture_gradient(&corners, &uv));
        let sides = [0, 1, 2].map(|k| {
            let edge = frame.flat(&(corners[(k + 1) % 3] - corners[k]));
            edge.try_normalize(0.0).unwrap_or_else(Vec2::x)
        });
        let warp = target.warp.as_ref().map_or(Vec2::x(), |warp| frame.flat(&warp[f]));
        let mut sum = Gather::new(frame, sides, warp, sign);
        for weights in samples(grid as u32) {
            let mix = |x: &[Vec3; 3]| x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2];
            let place = Place {
                position: mix(&corners),
                uv: uv.map(|uv| uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2]),
                normal: outward * frame.normal,
                gradient,
            };
            match lands.land(f, &place) {
                Some(landing) => sum.add(&landing, &faces[landing.triangle], source, memory),
                None => sum.add_nothing(),
            }
        }
        sum.finish()
    };
    (0..target.triangles.len()).into_par_iter().map(one).collect()
}

fn source_face(source: &GarmentSurface, memory: &RestState, f: usize) -> SourceFace {
    let corners = source.corners(f);
    let hinge = |k: usize| source.topology.edge_hinge[source.topology.triangle_edges[f][k] as usize];
    let change = |h: u32| memory.rest_angle[h as usize] - memory.source_angle[h as usize];
    SourceFace {
        edges: [0, 1, 2].map(|k| corners[(k + 1) % 3] - corners[k]),
        angle: [0, 1, 2].map(|k| hinge(k).map_or(0.0, change)),
        compliance: [0, 1, 2].map(|k| hinge(k).map(|h| 1.0 / memory.stiffness_ratio[h as usize])),
    }
}

/// Middles of the n² equal triangles a triangle is cut into, as weights of its corners.
fn samples(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let at = move |i: u32, j: u32, shift: f64| {
        let (a, b) = ((f64::from(i) + shift) / f64::from(n), (f64::from(j) + shift) / f64::from(n));
        [1.0 - a - b, a, b]
    };
    let upright = move |i: u32| (0..n - i).map(move |j| at(i, j, 1.0 / 3.0));
    let inverted = move |i: u32| (0..n - i - 1).map(move |j| at(i, j, 2.0 / 3.0));
    (0..n).flat_map(move |i| upright(i).chain(inverted(i)))
}

/// Sums over the samples of one target triangle.
struct Gather {
    frame: FaceFrame,
    sides: [Vec2; 3],
    warp: Vec2,
    sign: f64,
    count: f64,
    found: f64,
    quality: f64,
    curvature: PlaneTensor,
    stretch: [f64; 2],
    compliance: [[f64; 2]; 3],
    landed: Vec<u32>,
}

impl Gather {
    fn new(frame: FaceFrame, sides: [Vec2; 3], warp: Vec2, sign: f64) -> Self {
        Self {
            frame,
            sides,
            warp: warp.try_normalize(0.0).unwrap_or_else(Vec2::x),
            sign,
            count: 0.0,
            found: 0.0,
            quality: 0.0,
            curvature: PlaneTensor::zeros(),
            stretch: [0.0; 2],
            compliance: [[0.0; 2]; 3],
            landed: Vec::new(),
        }
    }

    fn add_nothing(&mut self) {
        self.count += 1.0;
        for sum in &mut self.compliance {
            // Three hinges of new cloth.
            *sum = [sum[0] + 3.0 * ANY_DIRECTION, sum[1] + 3.0 * ANY_DIRECTION];
        }
    }

    fn add(&mut self, landing: &Landing, face: &SourceFace, source: &GarmentSurface, memory: &RestState) {
        let edges = face.edges.map(|e| self.frame.flat(&(landing.map * e)));
        let area = 0.5 * edges[0].perp(&edges[1]).abs();
        if area.is_nan() || area <= 0.0 {
            return self.add_nothing();
        }
        self.count += 1.0;
        self.found += 1.0;
        self.quality += landing.quality;
        self.landed.push(landing.triangle as u32);
        for (edge, (angle, compliance)) in edges.iter().zip(face.angle.iter().zip(face.compliance)) {
            if *angle != 0.0 {
                let density = self.sign * angle * edge.norm() / (2.0 * area);
                self.curvature += across(edge) * density;
            }
            let Some(compliance) = compliance else { continue };
            let direction = edge.try_normalize(0.0).unwrap_or_else(Vec2::x);
            for (side, sum) in self.sides.iter().zip(&mut self.compliance) {
                let weight = side.dot(&direction).powi(4);
                *sum = [sum[0] + weight * compliance, sum[1] + weight];
            }
        }
        let f = landing.triangle;
        let change = [memory.rest_stretch_warp[f] - 1.0, memory.rest_stretch_weft[f] - 1.0];
        if change != [0.0; 2] {
            self.add_stretch(landing, source, f, change);
        }
    }

    /// (r_u - 1) u u^T + (r_v - 1) v v^T, read along the target's warp and weft.
    fn add_stretch(&mut self, landing: &Landing, source: &GarmentSurface, f: usize, change: [f64; 2]) {
        let own = source.warp.as_ref().map(|warp| self.frame.flat(&(landing.map * warp[f])));
        let Some(u) = own.and_then(|u| u.try_normalize(0.0)) else {
            // Without directions only what both have in common can be carried.
            let mean = 0.5 * (change[0] + change[1]);
            self.stretch = self.stretch.map(|s| s + mean);
            return;
        };
        let cosine = u.dot(&self.warp).powi(2);
        self.stretch[0] += change[0] * cosine + change[1] * (1.0 - cosine);
        self.stretch[1] += change[0] * (1.0 - cosine) + change[1] * cosine;
    }

    fn finish(mut self) -> Gathered {
        self.landed.sort_unstable();
        self.landed.dedup();
        let mean = 1.0 / self.count.max(1.0);
        Gathered {
            curvature: self.curvature * mean,
            stretch: self.stretch.map(|s| s * mean),
            compliance: self.compliance,
            found: self.found * mean,
            confidence: self.quality * mean,
            landed: self.landed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_even_and_centred() {
        for n in [1, 2, 3, 7] {
            let all: Vec<[f64; 3]> = samples(n).collect();
            assert_eq!(all.len(), (n * n) as usize);
            for k in 0..3 {
                let mean: f64 = all.iter().map(|w| w[k]).sum::<f64>() / all.len() as f64;
                assert!((mean - 1.0 / 3.0).abs() < 1e-12);
                assert!(all.iter().all(|w| w[k] > 0.0));
            }
        }
    }
}
