//! Resampling of one source's memory, per triangle of the target.
//!
//! On the source every triangle has the change of curvature its hinges make, `sum_e d_e l_e / (2 A) t_e t_e^T` with
//! `d = rest - source angle`. Each target triangle is sampled on an even grid about as fine as the source. A sample takes
//! the three hinges of the triangle it matches, with their edges mapped to the target, so that every crease keeps its angle
//! and its direction while lengths and areas become those of the target. A triangle receives the mean over its samples,
//! which is the integral over its area: nothing is lost between samples, whichever mesh is finer.
//!
//! Stiffness is averaged as compliance (hinges across a crease bend one after another, as springs in series), weighted
//! towards hinges of the same direction by cos^4; rest lengths as the tensor of their changes along warp and weft.
//! Samples without a match count as new cloth.

use crate::garment::RestState;
use crate::remesh::carry::correspondence::{Correspondence, Match, Query};
use crate::remesh::carry::hinge_fit::{FaceFrame, PlaneTensor, edge_tensor};
use crate::remesh::carry::surface::GarmentSurface;
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::triangle::sample_weights;
use rayon::prelude::*;

/// Mean of cos^4 over all directions: the weight of cloth without direction.
const MEAN_COS4: f64 = 0.375;

/// Changes of rest length, rest stretch minus 1 [-].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StretchDelta {
    /// Along the warp.
    pub warp: f64,
    /// Along the weft.
    pub weft: f64,
}

/// A weighted sum.
#[derive(Debug, Clone, Copy, Default)]
pub struct WeightedSum {
    sum: f64,
    weight: f64,
}

impl WeightedSum {
    fn add(&mut self, value: f64, weight: f64) {
        self.sum += weight * value;
        self.weight += weight;
    }

    /// The mean; `default` without any weight.
    pub fn mean_or(&self, default: f64) -> f64 {
        if self.weight > 0.0 { self.sum / self.weight } else { default }
    }
}

/// Memory resampled on one target triangle.
#[derive(Debug, Clone)]
pub struct ResampledFace {
    /// Mean change of curvature [1/m].
    pub curvature: PlaneTensor,
    /// Mean change of rest length along the triangle's own warp and weft.
    pub stretch: StretchDelta,
    /// Compliance per side.
    pub compliance: [WeightedSum; 3],
    /// Fraction of the samples that have a match.
    pub matched_fraction: f64,
    /// Mean quality of all samples, 0 where none has a match.
    pub confidence: f64,
    /// Matched source triangles, sorted.
    pub source_triangles: Vec<u32>,
}

/// Hinge values of one source triangle by its sides.
struct SourceFace {
    edges: [Vec3; 3],
    /// Change of rest angle [rad].
    angle: [f64; 3],
    /// `None` for an open side, which carries no stiffness.
    compliance: [Option<f64>; 3],
}

/// Resamples `memory` of the source of `correspondence` on every triangle of `target`, in canonical coordinates.
/// `orientation` is -1 where one of both garments has its normals inside, else 1.
pub fn resample(
    correspondence: &impl Correspondence,
    memory: &RestState,
    target: &GarmentSurface,
    orientation: f64,
) -> Vec<ResampledFace> {
    let source = correspondence.source();
    let faces: Vec<SourceFace> =
        (0..source.triangles.len()).map(|f| source_face(source, memory, f)).collect();
    let source_area: f64 = (0..source.triangles.len()).map(|f| 0.5 * source.normal(f).norm()).sum();
    let source_side = (source_area / source.triangles.len().max(1) as f64).sqrt();
    let outward = target.orientation_sign();
    let one = |f: usize| {
        let corners = target.corners(f);
        let frame = FaceFrame::new(&corners);
        let area = 0.5 * target.normal(f).norm();
        let per_side =
            (TUNING.samples_per_source_side * area.sqrt() / source_side.max(f64::MIN_POSITIVE)).ceil();
        let grid = per_side.clamp(TUNING.min_samples_per_side, TUNING.max_samples_per_side);
        let uv = target.uvs.as_ref().map(|uvs| uvs[f]);
        let gradient = target.texture_gradient(f);
        let sides = [0, 1, 2].map(|k| {
            let edge = frame.project(&(corners[(k + 1) % 3] - corners[k]));
            edge.try_normalize(0.0).unwrap_or_else(Vec2::x)
        });
        let warp = target.warp.as_ref().map_or(Vec2::x(), |warp| frame.project(&warp[f]));
        let mut sum = FaceAccumulator::new(frame, sides, warp, orientation);
        for weights in sample_weights(grid as u32) {
            let query = Query {
                position: corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2],
                uv: uv.map(|uv| uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2]),
                normal: outward * frame.normal,
                gradient,
            };
            match correspondence.find(f, &query) {
                Some(found) => sum.add(&found, &faces[found.triangle], source, memory),
                None => sum.add_unmatched(),
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

/// Sums over the samples of one target triangle.
struct FaceAccumulator {
    frame: FaceFrame,
    /// Unit directions of the sides.
    sides: [Vec2; 3],
    /// Unit direction of the warp.
    warp: Vec2,
    orientation: f64,
    count: f64,
    matched: f64,
    quality: f64,
    curvature: PlaneTensor,
    stretch: StretchDelta,
    compliance: [WeightedSum; 3],
    source_triangles: Vec<u32>,
}

impl FaceAccumulator {
    fn new(frame: FaceFrame, sides: [Vec2; 3], warp: Vec2, orientation: f64) -> Self {
        Self {
            frame,
            sides,
            warp: warp.try_normalize(0.0).unwrap_or_else(Vec2::x),
            orientation,
            count: 0.0,
            matched: 0.0,
            quality: 0.0,
            curvature: PlaneTensor::zeros(),
            stretch: StretchDelta::default(),
            compliance: [WeightedSum::default(); 3],
            source_triangles: Vec::new(),
        }
    }

    /// Adds a sample without a match: three hinges of new cloth.
    fn add_unmatched(&mut self) {
        self.count += 1.0;
        for total in &mut self.compliance {
            total.add(1.0, 3.0 * MEAN_COS4);
        }
    }

    fn add(&mut self, found: &Match, face: &SourceFace, source: &GarmentSurface, memory: &RestState) {
        let edges = face.edges.map(|e| self.frame.project(&(found.map * e)));
        let area = 0.5 * edges[0].perp(&edges[1]).abs();
        if area.is_nan() || area <= 0.0 {
            return self.add_unmatched();
        }
        self.count += 1.0;
        self.matched += 1.0;
        self.quality += found.quality;
        self.source_triangles.push(found.triangle as u32);
        for (edge, (angle, compliance)) in edges.iter().zip(face.angle.iter().zip(face.compliance)) {
            if *angle != 0.0 {
                let density = self.orientation * angle * edge.norm() / (2.0 * area);
                self.curvature += edge_tensor(edge) * density;
            }
            let Some(compliance) = compliance else { continue };
            let direction = edge.try_normalize(0.0).unwrap_or_else(Vec2::x);
            for (side, total) in self.sides.iter().zip(&mut self.compliance) {
                total.add(compliance, side.dot(&direction).powi(4));
            }
        }
        let f = found.triangle;
        let change =
            StretchDelta { warp: memory.rest_stretch_warp[f] - 1.0, weft: memory.rest_stretch_weft[f] - 1.0 };
        if change != StretchDelta::default() {
            let warp = source.warp.as_ref().map(|warp| self.frame.project(&(found.map * warp[f])));
            self.add_stretch(warp.and_then(|u| u.try_normalize(0.0)), change);
        }
    }

    /// Adds (r_u - 1) u u^T + (r_v - 1) v v^T, read along the target's warp and weft; `source_warp` is u.
    fn add_stretch(&mut self, source_warp: Option<Vec2>, change: StretchDelta) {
        let Some(u) = source_warp else {
            // Without directions only the isotropic part can be transferred.
            let mean = 0.5 * (change.warp + change.weft);
            self.stretch.warp += mean;
            self.stretch.weft += mean;
            return;
        };
        let cosine = u.dot(&self.warp).powi(2);
        self.stretch.warp += change.warp * cosine + change.weft * (1.0 - cosine);
        self.stretch.weft += change.warp * (1.0 - cosine) + change.weft * cosine;
    }

    fn finish(mut self) -> ResampledFace {
        self.source_triangles.sort_unstable();
        self.source_triangles.dedup();
        let mean = 1.0 / self.count.max(1.0);
        ResampledFace {
            curvature: self.curvature * mean,
            stretch: StretchDelta { warp: self.stretch.warp * mean, weft: self.stretch.weft * mean },
            compliance: self.compliance,
            matched_fraction: self.matched * mean,
            confidence: self.quality * mean,
            source_triangles: self.source_triangles,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_even_and_centred() {
        for n in [1, 2, 3, 7] {
            let all: Vec<[f64; 3]> = sample_weights(n).collect();
            assert_eq!(all.len(), (n * n) as usize);
            for k in 0..3 {
                let mean: f64 = all.iter().map(|w| w[k]).sum::<f64>() / all.len() as f64;
                assert!((mean - 1.0 / 3.0).abs() < 1e-12);
                assert!(all.iter().all(|w| w[k] > 0.0));
            }
        }
    }
}
