//! A strip folded in two between parallel plates, held, and let go: what the memory makes of it.
//!
//! Between plates a gap `d` apart (middle to middle of the two layers) the fold is an elastica whose shape does not
//! depend on its stiffness: `kappa = (J / d) sqrt(sin theta)`, `J = 2.396280`, arc length `2.18844 d`. The mesh is laid on
//! it line by line, its angles are handed to the memory stage as they would be by the solver, and the hold is one
//! long step. Let go without weight, a strip whose hinges are parallel lines comes to rest at its rest angles: so
//! the angle it opens to is read off them (a test compares with the solver's equilibrium).

use crate::chart::test_sheet::Sheet;
use crate::energy::Bending;
use crate::fabric::Fabric;
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::memory::{Memory, MemoryModel, Strains};
use std::f64::consts::PI;

/// J of the elastica between plates: the integral of sqrt(sin theta) from 0 to pi.
const ELASTICA: f64 = 2.396_280;
/// Force per width over `B / d²` with which the fold pushes the plates apart.
const FOLD_FORCE: f64 = 2.871_08;
/// Time for closing the plates, and for opening them [s].
const CLOSING: f64 = 1.0;
/// Lines of a mesh at most, whatever length and element say.
const MOST_LINES: f64 = 1e4;
/// Points of the tabulated fold.
const SAMPLES: usize = 4000;
/// Steps of the time after letting go, per decade.
const STEPS_PER_DECADE: f64 = 12.0;

/// A strip in the plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Length of the strip [m]; it is folded in its middle.
    pub length: f64,
    /// Its width [m].
    pub width: f64,
    /// Distance of the middle of one layer to that of the other [m].
    pub gap: f64,
    /// Distance of the mesh's lines [m].
    pub element: f64,
    /// Where between two lines the middle of the fold lies [-]: 0 on a line, 0.5 half way.
    pub offset: f64,
}

impl Press {
    /// The gap [m] at which the fold of `fabric` carries `force` per width [N/m]: not less than one thickness.
    pub fn gap_under(fabric: &Fabric, force: f64) -> f64 {
        (FOLD_FORCE * fabric.bend_warp() / force).sqrt().max(fabric.thickness())
    }

    /// Places of the lines along the strip, counted from the fold [m]. The ends may be narrower than an element.
    fn lines(&self) -> Vec<f64> {
        let half = 0.5 * self.length;
        let count = (self.length / self.element).ceil().clamp(1.0, MOST_LINES) as i64 + 1;
        let inner = (-count..=count).map(|k| (k as f64 + self.offset) * self.element);
        let mut lines = vec![-half];
        lines.extend(inner.filter(|x| x.abs() < half - 0.1 * self.element));
        lines.push(half);
        lines
    }

    fn sheet(&self) -> Sheet {
        let across = (self.width / self.element).round().max(1.0) as usize;
        Sheet::strip(&self.lines(), self.width, across)
    }

    /// The strip laid on the fold.
    fn folded(&self, sheet: &Sheet) -> Vec<Vec3> {
        let curve = fold_curve(self.gap);
        let half = 0.5 * curve.last().map_or(0.0, |p| p[0]);
        let place = |s: f64| -> (f64, f64) {
            // The limbs lead away from the fold in -x, the tip of the fold lies at x > 0.
            if s <= -half {
                return (s + half, 0.0);
            }
            if s >= half {
                return (half - s, self.gap);
            }
            let after = curve.partition_point(|p| p[0] < s + half).clamp(1, curve.len() - 1);
            let ([s0, x0, y0], [s1, x1, y1]) = (curve[after - 1], curve[after]);
            let share = (s + half - s0) / (s1 - s0);
            (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
        };
        sheet
            .flat
            .iter()
            .map(|p| place(p.x))
            .zip(&sheet.flat)
            .map(|((x, y), p)| Vec3::new(x, y, -p.y))
            .collect()
    }

    /// Presses the strip for `hold` [s] and lets it go.
    pub fn hold(&self, fabric: &Fabric, hold: f64) -> LetGo {
        let sheet = self.sheet();
        let garment = sheet.flat_garment();
        let bending = Bending::new(&garment, fabric);
        let law = MemoryModel::new(&garment, fabric, bending.width());
        let flat = bending.angles(&garment.points, &[]);
        let folded = bending.angles(&self.folded(&sheet), &flat);
        let mut memory = Memory::new(RestState::new(flat.clone(), garment.triangles.len()));
        let unstretched = vec![[1.0, 1.0, 0.0]; garment.triangles.len()];
        let mut pass = |from: &[f64], to: &[f64], duration| {
            let seen = |angle| Strains { angle, stretch: &unstretched };
            memory.commit(&law, &seen(from), &seen(to), duration);
            memory.rest.rest_angle.clone()
        };
        pass(&flat, &folded, CLOSING);
        let rest = pass(&folded, &folded, hold);
        let rest = pass(&folded, &rest, CLOSING);
        LetGo { garment, law, memory, angle: rest, unstretched, since: 0.0, width: self.width }
    }
}

/// Arc length, x and y [m] of the fold between plates `gap` apart, from one limb to the other.
fn fold_curve(gap: f64) -> Vec<[f64; 3]> {
    let mut curve = vec![[0.0; 3]];
    let mut at = [0.0; 3];
    for k in 0..SAMPLES {
        // The tangent angle is spaced so that arc length per sample stays finite where the curvature vanishes.
        let phi = (k as f64 + 0.5) * PI / SAMPLES as f64;
        let theta = 0.5 * PI * (1.0 - phi.cos());
        let turn = 0.5 * PI * phi.sin() * PI / SAMPLES as f64;
        let ds = turn * gap / (ELASTICA * theta.sin().sqrt());
        at = [at[0] + ds, at[1] + ds * theta.cos(), at[2] + ds * theta.sin()];
        curve.push(at);
    }
    curve
}

/// The strip after it was let go, at rest without weight.
pub struct LetGo {
    garment: Garment,
    law: MemoryModel,
    /// What it remembers.
    pub memory: Memory,
    angle: Vec<f64>,
    /// A fold between plates does not stretch.
    unstretched: Vec<[f64; 3]>,
    /// Time since it was let go [s].
    since: f64,
    width: f64,
}

impl LetGo {
    /// Lets it lie until `since` [s] after it was let go.
    pub fn wait_until(&mut self, since: f64) {
        while self.since < since - 1e-9 {
            let longest = (1.0 + self.since) * (10f64.powf(1.0 / STEPS_PER_DECADE) - 1.0);
            let step = longest.min(since - self.since);
            // It is at rest all the time: its angles follow its rest angles.
            let angle = std::mem::take(&mut self.angle);
            let seen = || Strains { angle: &angle, stretch: &self.unstretched };
            self.memory.commit(&self.law, &seen(), &seen(), step);
            self.angle = self.memory.rest.rest_angle.clone();
            self.since += step;
        }
    }

    /// Crease angle left [rad]: the sum of the rest angles across the fold, averaged over the width.
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

    /// The strip's mesh, flat.
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
