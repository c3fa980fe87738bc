//! The memory of the cloth: its rest angles, rest stretches and stiffness. Energies read it; only `memory` writes it.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Rest angles, stiffness ratios and rest stretches of one garment.
///
/// ```
/// // One hinge with the angle 0.3 rad as modelled, between two triangles.
/// let rest = crease_model::garment::RestState::new(vec![0.3], 2);
/// assert_eq!((rest.rest_angle[0], rest.stiffness_ratio[0], rest.rest_stretch_warp[1]), (0.3, 1.0, 1.0));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RestState {
    /// One per hinge: angle of the source shape [rad].
    pub source_angle: Vec<f64>,
    /// One per hinge: rest angle [rad].
    pub rest_angle: Vec<f64>,
    /// One per hinge: stiffness ratio [-], 1 when new.
    pub stiffness_ratio: Vec<f64>,
    /// One per triangle: rest stretch along warp [-], 1 when new.
    pub rest_stretch_warp: Vec<f64>,
    /// One per triangle: rest stretch along weft [-], 1 when new.
    pub rest_stretch_weft: Vec<f64>,
}

impl RestState {
    /// Smallest stiffness ratio and rest stretch [-] of cloth whose changes are scaled: those of a sidecar are positive.
    pub const MIN_RATIO: f64 = 1e-3;

    /// Creates the rest state of new, flat cloth.
    pub fn flat(hinge_count: usize, triangle_count: usize) -> Self {
        Self::new(vec![0.0; hinge_count], triangle_count)
    }

    /// Creates the rest state of new cloth whose source shape has the hinge angles `source_angle` [rad], one per hinge.
    pub fn new(source_angle: Vec<f64>, triangle_count: usize) -> Self {
        Self {
            rest_angle: source_angle.clone(),
            stiffness_ratio: vec![1.0; source_angle.len()],
            rest_stretch_warp: vec![1.0; triangle_count],
            rest_stretch_weft: vec![1.0; triangle_count],
            source_angle,
        }
    }

    /// Returns this rest state, which belongs to another reading of the same cloth, on the source angles `source_angle` [rad]:
    /// changes of rest angle are kept.
    pub fn on_source(&self, source_angle: Vec<f64>) -> Self {
        let changes = self.rest_angle.iter().zip(&self.source_angle);
        let rest_angle = source_angle.iter().zip(changes).map(|(s, (r, own))| s + (r - own)).collect();
        Self { source_angle, rest_angle, ..self.clone() }
    }

    /// Changes of the rest angles from the source shape [rad], one per hinge.
    pub fn angle_changes(&self) -> impl Iterator<Item = f64> {
        self.rest_angle.iter().zip(&self.source_angle).map(|(rest, source)| rest - source)
    }

    /// Returns this rest state with every change of an angle or a length times `factor` [-]; stiffness stays.
    pub fn with_changes_times(&self, factor: f64) -> Self {
        let towards = |from: f64, to: f64| from + factor * (to - from);
        Self {
            source_angle: self.source_angle.clone(),
            rest_angle: self
                .source_angle
                .iter()
                .zip(&self.rest_angle)
                .map(|(s, r)| towards(*s, *r))
                .collect(),
            stiffness_ratio: self.stiffness_ratio.clone(),
            rest_stretch_warp: self.rest_stretch_warp.iter().map(|r| towards(1.0, *r)).collect(),
            rest_stretch_weft: self.rest_stretch_weft.iter().map(|r| towards(1.0, *r)).collect(),
        }
    }

    /// Returns this rest state with every change times `factor` [-], from 0; it is itself for 1. Cloth turns no further than
    /// folded flat on itself; ratios stay positive.
    pub fn strengthened(&self, factor: f64) -> Self {
        if factor == 1.0 {
            return self.clone();
        }
        let mut all = self.with_changes_times(factor);
        all.rest_angle.iter_mut().for_each(|angle| *angle = angle.clamp(-PI, PI));
        all.stiffness_ratio.iter_mut().for_each(|ratio| *ratio = 1.0 + factor * (*ratio - 1.0));
        let ratios = [&mut all.stiffness_ratio, &mut all.rest_stretch_warp, &mut all.rest_stretch_weft];
        ratios.into_iter().flatten().for_each(|ratio| *ratio = ratio.max(Self::MIN_RATIO));
        all
    }

    /// Returns what changed since `start`, as the rest state of cloth that was new then.
    pub fn change_since(&self, start: &Self) -> Self {
        let ratios = |now: &[f64], then: &[f64]| now.iter().zip(then).map(|(n, t)| n / t).collect();
        let angles = self.source_angle.iter().zip(self.rest_angle.iter().zip(&start.rest_angle));
        Self {
            source_angle: self.source_angle.clone(),
            rest_angle: angles.map(|(s, (now, then))| s + (now - then)).collect(),
            stiffness_ratio: ratios(&self.stiffness_ratio, &start.stiffness_ratio),
            rest_stretch_warp: ratios(&self.rest_stretch_warp, &start.rest_stretch_warp),
            rest_stretch_weft: ratios(&self.rest_stretch_weft, &start.rest_stretch_weft),
        }
    }

    /// Returns this rest state after a `change` of the same cloth: the inverse of [`RestState::change_since`]. Cloth turns no
    /// further than folded flat on itself.
    pub fn with_change(&self, change: &Self) -> Self {
        let products = |own: &[f64], other: &[f64]| own.iter().zip(other).map(|(a, b)| a * b).collect();
        let angles = self.rest_angle.iter().zip(change.rest_angle.iter().zip(&change.source_angle));
        Self {
            source_angle: self.source_angle.clone(),
            rest_angle: angles.map(|(own, (r, s))| (own + (r - s)).clamp(-PI, PI)).collect(),
            stiffness_ratio: products(&self.stiffness_ratio, &change.stiffness_ratio),
            rest_stretch_warp: products(&self.rest_stretch_warp, &change.rest_stretch_warp),
            rest_stretch_weft: products(&self.rest_stretch_weft, &change.rest_stretch_weft),
        }
    }

    /// Whether it belongs to cloth with so many hinges and triangles.
    pub fn fits(&self, hinge_count: usize, triangle_count: usize) -> bool {
        [&self.source_angle, &self.rest_angle, &self.stiffness_ratio].iter().all(|l| l.len() == hinge_count)
            && [&self.rest_stretch_warp, &self.rest_stretch_weft].iter().all(|l| l.len() == triangle_count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_leads_from_one_rest_state_to_the_other() {
        let mut start = RestState::new(vec![0.1, 0.2], 1);
        start.rest_angle[0] = 0.7;
        start.stiffness_ratio[1] = 2.0;
        let mut now = start.clone();
        now.rest_angle[1] = -0.5;
        now.stiffness_ratio[1] = 3.0;
        now.rest_stretch_weft[0] = 1.1;
        let change = now.change_since(&start);
        assert!((change.rest_angle[0] - change.source_angle[0]).abs() < 1e-15, "the first hinge stayed");
        assert!((change.rest_angle[1] - 0.2 + 0.7).abs() < 1e-15 && change.stiffness_ratio[1] == 1.5);
        let again = start.with_change(&change);
        assert!(again.rest_angle.iter().zip(&now.rest_angle).all(|(a, b)| (a - b).abs() < 1e-15));
        assert_eq!((again.stiffness_ratio[1], again.rest_stretch_weft[0]), (3.0, 1.1));
        let elsewhere = now.on_source(vec![0.3, 0.3]);
        assert!((elsewhere.rest_angle[0] - 0.9).abs() < 1e-15 && elsewhere.source_angle == [0.3, 0.3]);
        assert!(now.fits(2, 1) && !now.fits(1, 2));
    }

    #[test]
    fn changes_are_scaled_from_none_to_folded_flat() {
        let mut rest = RestState::new(vec![0.2, 0.2], 1);
        rest.rest_angle[0] = 1.2;
        rest.stiffness_ratio[1] = 3.0;
        rest.rest_stretch_warp[0] = 0.9;
        assert_eq!(rest.strengthened(1.0), rest);
        assert_eq!(rest.strengthened(0.0), RestState::new(vec![0.2, 0.2], 1));
        let half = rest.strengthened(0.5);
        assert!((half.rest_angle[0] - 0.7).abs() < 1e-15 && half.rest_angle[1] == 0.2);
        assert!(
            (half.stiffness_ratio[1] - 2.0).abs() < 1e-15 && (half.rest_stretch_warp[0] - 0.95).abs() < 1e-15
        );
        let flat = rest.strengthened(20.0);
        assert!(flat.rest_angle[0] == PI && flat.rest_stretch_warp[0] > 0.0);
    }
}
