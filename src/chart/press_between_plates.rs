//! A strip folded in half between parallel plates, held, and released: its crease.
//!
//! Between plates a gap `d` apart (middle to middle of the two layers) the fold is an elastica whose shape does not
//! depend on its stiffness: `kappa = (J / d) sqrt(sin theta)`, `J = 2.396280`, arc length `2.18844 d`. The mesh is
//! placed on it line by line, its angles are committed to memory as the solver would do, and the hold is one long
//! step. Released without gravity, a strip whose hinges are parallel lines is in equilibrium at its rest angles: they
//! give the angle it opens to (a test compares it with the solver's equilibrium).

use crate::test_sheet::TestSheet;
use crease_geometry::math::Vec3;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::energy::Bending;
use crease_solver::memory::{Memory, MemoryModel, Strains};
use std::f64::consts::PI;

/// J of the elastica between plates: the integral of sqrt(sin theta) from 0 to pi.
const ELASTICA: f64 = 2.396_280;
/// Force per width by which the fold pushes the plates apart, over `B / d²` [-].
const FOLD_FORCE: f64 = 2.871_08;
/// Duration of closing and of opening the plates [s].
const CLOSING_TIME: f64 = 1.0;
/// Limit of the lines on each side of the fold.
const MAX_LINES: f64 = 1e4;
/// Points of the tabulated fold.
const SAMPLES: usize = 4000;
/// Steps per decade of the time after release.
const STEPS_PER_DECADE: f64 = 12.0;

/// A strip between the plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatePress {
    /// Length of the strip [m]; it is folded in its middle.
    pub length: f64,
    /// Its width [m].
    pub width: f64,
    /// Distance between the middle surfaces of the two layers [m].
    pub gap: f64,
    /// Spacing of the mesh's lines [m].
    pub element: f64,
    /// Position of the middle of the fold between two lines [-]: 0 on a line, 0.5 halfway.
    pub offset: f64,
}

impl PlatePress {
    /// Gap [m] at which the fold of `fabric` balances `force` per width [N/m]: at least one thickness.
    pub fn gap_under(fabric: &Fabric, force: f64) -> f64 {
        (FOLD_FORCE * fabric.bend_warp() / force).sqrt().max(fabric.thickness())
    }

    /// Positions of the lines along the strip, from the fold [m]. The elements at the ends may be narrower.
    fn lines(&self) -> Vec<f64> {
        let half = 0.5 * self.length;
        let count = (self.length / self.element).ceil().clamp(1.0, MAX_LINES) as i64 + 1;
        let inner = (-count..=count).map(|k| (k as f64 + self.offset) * self.element);
        let mut lines = vec![-half];
        lines.extend(inner.filter(|x| x.abs() < half - 0.1 * self.element));
        lines.push(half);
        lines
    }

    fn sheet(&self) -> TestSheet {
        let across = (self.width / self.element).round().max(1.0) as usize;
        TestSheet::strip(&self.lines(), self.width, across)
    }

    /// Points of the folded strip [m].
    fn folded(&self, sheet: &TestSheet) -> Vec<Vec3> {
        let curve = fold_curve(self.gap);
        let half = 0.5 * curve.last().map_or(0.0, |p| p[0]);
        let position = |s: f64| -> (f64, f64) {
            // The limbs extend from the fold in -x, the tip of the fold lies at x > 0.
            if s <= -half {
                return (s + half, 0.0);
            }
            if s >= half {
                return (half - s, self.gap);
            }
            let after = curve.partition_point(|p| p[0] < s + half).clamp(1, curve.len() - 1);
            let ([s0, x0, y0], [s1, x1, y1]) = (curve[after - 1], curve[after]);
            let fraction = (s + half - s0) / (s1 - s0);
            (x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0))
        };
        sheet
            .flat
            .iter()
            .map(|p| position(p.x))
            .zip(&sheet.flat)
            .map(|((x, y), p)| Vec3::new(x, y, -p.y))
            .collect()
    }

    /// Presses the strip for `hold` [s] and releases it.
    pub fn hold(&self, fabric: &Fabric, hold: f64) -> ReleasedStrip {
        let sheet = self.sheet();
        let garment = sheet.flat_garment();
        let bending = Bending::new(&garment, fabric);
        let law = MemoryModel::new(&garment, fabric, bending.width(), fabric.memory.reference_length());
        let flat = bending.angles(&garment.points, &[]);
        let folded = bending.angles(&self.folded(&sheet), &flat);
        let mut memory = Memory::new(RestState::new(flat.clone(), garment.triangles.len()));
        let unstretched = vec![[1.0, 1.0, 0.0]; garment.triangles.len()];
        let mut commit = |from: &[f64], to: &[f64], duration| {
            let strains = |angle| Strains { angle, stretch: &unstretched };
            memory.commit(&law, &strains(from), &strains(to), duration);
            memory.rest.rest_angle.clone()
        };
        commit(&flat, &folded, CLOSING_TIME);
        let rest = commit(&folded, &folded, hold);
        let rest = commit(&folded, &rest, CLOSING_TIME);
        ReleasedStrip { garment, law, memory, angle: rest, unstretched, since: 0.0, width: self.width }
    }
}

/// Arc length, x and y of the fold between plates `gap` apart, from one limb to the other [m].
fn fold_curve(gap: f64) -> Vec<[f64; 3]> {
    let mut curve = vec![[0.0; 3]];
    let mut at = [0.0; 3];
    for k in 0..SAMPLES {
        // Tangent angles are spaced such that the arc length per sample is finite where the curvature vanishes.
        let phi = (k as f64 + 0.5) * PI / SAMPLES as f64;
        let theta = 0.5 * PI * (1.0 - phi.cos());
        let turn = 0.5 * PI * phi.sin() * PI / SAMPLES as f64;
        let ds = turn * gap / (ELASTICA * theta.sin().sqrt());
        at = [at[0] + ds, at[1] + ds * theta.cos(), at[2] + ds * theta.sin()];
        curve.push(at);
    }
    curve
}

/// The strip after its release, in equilibrium without gravity.
pub struct ReleasedStrip {
    garment: Garment,
    law: MemoryModel,
    /// Its memory.
    pub memory: Memory,
    angle: Vec<f64>,
    /// One per triangle: stretch of warp, weft and shear; a fold between plates causes none.
    unstretched: Vec<[f64; 3]>,
    /// Time since the release [s].
    since: f64,
    width: f64,
}

impl ReleasedStrip {
    /// Advances its memory until `since` [s] after the release.
    pub fn wait_until(&mut self, since: f64) {
        while self.since < since - 1e-9 {
            let longest = (1.0 + self.since) * (10f64.powf(1.0 / STEPS_PER_DECADE) - 1.0);
            let step = longest.min(since - self.since);
            // Quasi-static: the angles follow the rest angles.
            let angle = std::mem::take(&mut self.angle);
            let strains = || Strains { angle: &angle, stretch: &self.unstretched };
            self.memory.commit(&self.law, &strains(), &strains(), step);
            self.angle = self.memory.rest.rest_angle.clone();
            self.since += step;
        }
    }

    /// Remaining crease angle [rad]: sum of the rest angles across the fold, averaged over the width.
    pub fn crease_angle(&self) -> f64 {
        let hinges = &self.garment.topology.hinges;
        let sum: f64 = hinges
            .iter()
            .zip(&self.memory.rest.rest_angle)
            .map(|(hinge, rest)| {
                let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| self.garment.points[p.at()]);
                rest * (a.z - b.z).abs()
            })
            .sum();
        sum.abs() / self.width
    }

    /// The flat mesh of the strip.
    pub fn garment(&self) -> &Garment {
        &self.garment
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fold_has_the_height_and_the_length_of_the_elastica() {
        let [length, _, height] = *fold_curve(1e-3).last().expect("has points");
        assert!((height / 1e-3 - 1.0).abs() < 1e-5, "{height}");
        assert!((length / 2.188_44e-3 - 1.0).abs() < 1e-5, "{length}");
    }
}
