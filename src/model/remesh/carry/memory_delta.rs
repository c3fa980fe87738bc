//! Changes of memory against new cloth: what is added up over sources, scaled and applied to a target.

use crate::garment::RestState;
use crate::remesh::carry::hinge_fit::{PlaneTensor, fit_hinge_angles};
use crate::remesh::carry::resample::{ResampledFace, StretchDelta};
use crate::remesh::carry::surface::GarmentSurface;
use crease_geometry::mesh::{Hinge, PointIndex, hinge_angle};
use std::f64::consts::PI;

/// Parts of a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channels {
    /// Rest angles and stiffness.
    pub creases: bool,
    /// Rest lengths.
    pub bagging: bool,
}

impl Channels {
    /// Both channels.
    pub const ALL: Self = Self { creases: true, bagging: true };
}

/// How much of a change is applied.
#[derive(Debug, Clone, Copy)]
pub struct DeltaScale<'a> {
    /// Factor on every change [-], at least 0.
    pub strength: f64,
    /// Factor on every change, one per point, 0..1; 1 everywhere without.
    pub mask: Option<&'a [f64]>,
    /// Parts that are applied.
    pub channels: Channels,
}

impl DeltaScale<'_> {
    /// The whole change.
    pub const FULL: Self = Self { strength: 1.0, mask: None, channels: Channels::ALL };
}

/// Changes against new cloth on one mesh.
#[derive(Debug, Clone)]
pub struct MemoryDelta {
    /// Change of rest angle [rad], one per hinge.
    pub angle: Vec<f64>,
    /// Stiffness ratio minus 1 [-], one per hinge.
    pub stiffness: Vec<f64>,
    /// Change of rest length, one per triangle.
    pub stretch: Vec<StretchDelta>,
}

impl MemoryDelta {
    /// No change on `target`.
    pub fn zero(target: &GarmentSurface) -> Self {
        let hinges = target.topology.hinges.len();
        Self {
            angle: vec![0.0; hinges],
            stiffness: vec![0.0; hinges],
            stretch: vec![StretchDelta::default(); target.triangles.len()],
        }
    }

    /// The changes that `memory` holds on its own mesh.
    pub fn from_memory(memory: &RestState) -> Self {
        let stretches = memory.rest_stretch_warp.iter().zip(&memory.rest_stretch_weft);
        Self {
            angle: memory.angle_changes().collect(),
            stiffness: memory.stiffness_ratio.iter().map(|s| s - 1.0).collect(),
            stretch: stretches.map(|(u, v)| StretchDelta { warp: u - 1.0, weft: v - 1.0 }).collect(),
        }
    }

    /// The changes that `faces`, one per triangle of `target`, make on its hinges and triangles.
    pub fn from_faces(target: &GarmentSurface, faces: &[ResampledFace]) -> Self {
        let requested: Vec<PlaneTensor> = faces.iter().map(|face| face.curvature).collect();
        Self {
            angle: fit_hinge_angles(target, &requested),
            stiffness: stiffness_changes(target, faces),
            stretch: faces.iter().map(|face| face.stretch).collect(),
        }
    }

    /// Adds `other`: angles and rest lengths add up, of stiffness the larger change counts.
    pub fn add(&mut self, other: &Self) {
        self.angle.iter_mut().zip(&other.angle).for_each(|(a, b)| *a += b);
        self.stiffness.iter_mut().zip(&other.stiffness).for_each(|(a, b)| {
            if b.abs() > a.abs() {
                *a = *b;
            }
        });
        for (a, b) in self.stretch.iter_mut().zip(&other.stretch) {
            *a = StretchDelta { warp: a.warp + b.warp, weft: a.weft + b.weft };
        }
    }

    /// Memory of new cloth on `target` with this change, scaled by `scale`.
    pub fn apply(&self, target: &GarmentSurface, scale: &DeltaScale) -> RestState {
        let mut memory = new_memory(target);
        // The smallest mask value of the points counts, as it does while cloth is worn.
        let masked = |mask: &[f64], points: &[PointIndex]| {
            points.iter().map(|p| mask[p.at()]).fold(1.0, f64::min).max(0.0)
        };
        let factor =
            |points: &[PointIndex]| scale.strength * scale.mask.map_or(1.0, |mask| masked(mask, points));
        if scale.channels.creases {
            for (h, hinge) in target.topology.hinges.iter().enumerate() {
                let factor = factor(&hinge.points[..2]);
                // Cloth cannot turn further than folded flat on itself, whatever the strength.
                memory.rest_angle[h] = (memory.rest_angle[h] + factor * self.angle[h]).clamp(-PI, PI);
                memory.stiffness_ratio[h] = (1.0 + factor * self.stiffness[h]).max(RestState::MIN_RATIO);
            }
        }
        if scale.channels.bagging {
            for (f, t) in target.triangles.iter().enumerate() {
                let factor = factor(t);
                memory.rest_stretch_warp[f] = (1.0 + factor * self.stretch[f].warp).max(RestState::MIN_RATIO);
                memory.rest_stretch_weft[f] = (1.0 + factor * self.stretch[f].weft).max(RestState::MIN_RATIO);
            }
        }
        memory
    }
}

/// Memory of `surface` as new cloth: its rest angles are its own.
fn new_memory(surface: &GarmentSurface) -> RestState {
    let angle = |h: &Hinge| hinge_angle(&h.points.map(|p| surface.points[p.at()]));
    RestState::new(surface.topology.hinges.iter().map(angle).collect(), surface.triangles.len())
}

/// Stiffness ratio minus 1, one per hinge of `target`, from the compliance of the faces on both sides.
fn stiffness_changes(target: &GarmentSurface, faces: &[ResampledFace]) -> Vec<f64> {
    let side = |f: u32, edge: u32| {
        let k = target.topology.triangle_edges[f as usize].iter().position(|&e| e == edge).unwrap_or(0);
        faces[f as usize].compliance[k]
    };
    let change = |h: &Hinge| {
        // Both triangles have the same weight, however finely they were sampled.
        let [a, b] = h.triangles.map(|f| side(f, h.edge)).map(|compliance| compliance.mean_or(1.0));
        2.0 / (a + b) - 1.0
    };
    target.topology.hinges.iter().map(change).collect()
}
