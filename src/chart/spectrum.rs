//! Spectrum of the memory of a garment: how much of it bends over which width. Crumpled and fallen cloth and an elbow have their folds elsewhere in every
//! bake, so that fields differ throughout; how sharp the folds are and how many does not depend on where they are.

use crate::curvature_field::CurvatureField;
use crease_model::garment::{Garment, RestState};

/// Standard deviations of the bells between which bands lie [m].
const BELLS: [f64; 4] = [0.005, 0.01, 0.02, 0.04];

/// Root mean squares of the field of changed curvature in bands of width, from 5 to 10, 10 to 20, 20 to 40 and above 40 mm [1/m].
pub(super) struct Spectrum(pub [f64; 4]);

impl Spectrum {
    /// The spectrum of the memory `rest` on `garment`.
    pub fn new(garment: &Garment, rest: &RestState) -> Self {
        let fields = BELLS.map(|bell| CurvatureField::averaged(garment, rest, bell));
        Self(std::array::from_fn(|k| match fields.get(k + 1) {
            Some(wider) => fields[k].difference(wider),
            None => fields[k].rms(),
        }))
    }

    /// Square root of the sum of the squares of all bands [1/m].
    pub fn rms(&self) -> f64 {
        self.0.iter().map(|band| band * band).sum::<f64>().sqrt()
    }

    /// The same of the differences of all bands to those of `other` [1/m].
    pub fn difference(&self, other: &Self) -> f64 {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k])).rms()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_sheet::TestSheet;

    /// Spectrum of a strip with folds of `angle` [rad] across it, each shared by as many lines 5 mm apart as `width` says.
    fn of_folds(at: [usize; 2], width: usize, angle: f64) -> Spectrum {
        let lines: Vec<f64> = (0..=80).map(|k| 0.005 * f64::from(k)).collect();
        let garment = TestSheet::strip(&lines, 0.1, 20).flat_garment();
        let mut rest = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| garment.points[p.at()].x);
            let is_bent = at.iter().any(|at| (*at..at + width).any(|k| a == lines[k] && b == lines[k]));
            rest.rest_angle[h] = if is_bent { angle / width as f64 } else { 0.0 };
        }
        Spectrum::new(&garment, &rest)
    }

    #[test]
    fn folds_elsewhere_have_the_same_spectrum_and_wider_ones_another() {
        let [here, elsewhere] = [[20, 60], [26, 54]].map(|at| of_folds(at, 1, 1.0));
        assert!(here.difference(&elsewhere) < 0.02 * here.rms(), "{:?} {:?}", here.0, elsewhere.0);
        let wide = of_folds([20, 60], 6, 1.0);
        assert!(wide.0[0] < 0.4 * here.0[0] && wide.0[3] > 0.9 * here.0[3], "{:?} {:?}", here.0, wide.0);
        let weak = of_folds([20, 60], 1, 0.9);
        assert!((here.difference(&weak) / here.rms() - 0.1).abs() < 1e-6);
    }
}
