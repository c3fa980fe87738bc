//! The memory of a garment as a field of changed curvature, averaged over a bell: what two bakes of one garment are compared by.
//!
//! Hinge by hinge two equally accurate bakes differ, because a crease is divided between neighbouring hinges; over the width of a
//! crease they agree.

use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::triangle;
use crease_model::garment::{Garment, RestState, changed_curvature};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Standard deviation of the bell over which curvature is averaged where fields are compared [m].
const BELL: f64 = 0.01;
/// Distance up to which the bell is summed, in standard deviations.
const REACH: f64 = 3.0;
/// Smallest cosine between the normals of triangles of one layer [-].
const MIN_NORMAL_COSINE: f64 = 0.3;

/// Changed curvature at every triangle of a garment [1/m], averaged over a bell on its surface.
pub(super) struct CurvatureField {
    curvature: Vec<Mat3>,
    area: Vec<f64>,
}

/// Triangles of a garment for averages over a neighbourhood.
struct Triangles {
    centre: Vec<Vec3>,
    normal: Vec<Vec3>,
    area: Vec<f64>,
    /// Standard deviation of the bell [m].
    bell: f64,
    /// Triangles by cells as wide as the reach.
    cells: FxHashMap<[i32; 3], Vec<u32>>,
}

/// Differences between neighbours of `fields`, over the first of the two, both root mean squares [-].
pub(super) fn scatter(fields: &[CurvatureField]) -> Vec<f64> {
    fields.windows(2).map(|pair| pair[0].difference(&pair[1]) / pair[0].rms()).collect()
}

impl CurvatureField {
    /// The field of the memory `rest` on `garment`, averaged over 10 mm.
    pub fn new(garment: &Garment, rest: &RestState) -> Self {
        Self::averaged(garment, rest, BELL)
    }

    /// The field averaged over a bell with the standard deviation `bell` [m].
    pub fn averaged(garment: &Garment, rest: &RestState, bell: f64) -> Self {
        let triangles = Triangles::of(garment, bell);
        let tensor = changed_curvature(garment, rest);
        let curvature =
            (0..triangles.area.len()).into_par_iter().map(|f| triangles.average(f, &tensor)).collect();
        Self { curvature, area: triangles.area }
    }

    /// Root mean square of the field, weighted by area [1/m].
    pub fn rms(&self) -> f64 {
        self.mean_square(|f| self.curvature[f].norm_squared()).sqrt()
    }

    /// Root mean square difference to another field of the same garment [1/m].
    pub fn difference(&self, other: &Self) -> f64 {
        self.mean_square(|f| (self.curvature[f] - other.curvature[f]).norm_squared()).sqrt()
    }

    fn mean_square(&self, of: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 = self.area.iter().enumerate().map(|(f, area)| area * of(f)).sum();
        sum / self.area.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    }
}

impl Triangles {
    fn of(garment: &Garment, bell: f64) -> Self {
        let corners = garment.triangles.iter().map(|t| triangle::corners(&garment.points, t));
        let corners: Vec<[Vec3; 3]> = corners.collect();
        let centre: Vec<Vec3> = corners.iter().map(|x| x.iter().sum::<Vec3>() / 3.0).collect();
        let mut cells: FxHashMap<[i32; 3], Vec<u32>> = FxHashMap::default();
        for (f, centre) in centre.iter().enumerate() {
            cells.entry(cell_of(centre, bell)).or_default().push(f as u32);
        }
        Self {
            centre,
            normal: corners.iter().map(|x| triangle::normal(x).unwrap_or_else(Vec3::zeros)).collect(),
            area: corners.iter().map(triangle::area).collect(),
            bell,
            cells,
        }
    }

    /// Returns the mean of `tensor`, one per triangle, over the bell around triangle `f`.
    fn average(&self, f: usize, tensor: &[Mat3]) -> Mat3 {
        let at = self.centre[f];
        let [x, y, z] = cell_of(&at, self.bell);
        let (mut sum, mut weights) = (Mat3::zeros(), 0.0);
        for cell in (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]) {
            for &g in self.cells.get(&cell).into_iter().flatten() {
                let g = g as usize;
                let squared = (self.centre[g] - at).norm_squared();
                let same_layer = self.normal[g].dot(&self.normal[f]) > MIN_NORMAL_COSINE;
                if same_layer && squared <= (REACH * self.bell).powi(2) {
                    let weight = self.area[g] * (-squared / (2.0 * self.bell * self.bell)).exp();
                    sum += tensor[g] * weight;
                    weights += weight;
                }
            }
        }
        sum / f64::max(weights, f64::MIN_POSITIVE)
    }
}

fn cell_of(position: &Vec3, bell: f64) -> [i32; 3] {
    [position.x, position.y, position.z].map(|x| (x / (REACH * bell)).floor() as i32)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::test_sheet::TestSheet;

    /// The field of a strip, 0.3 m long, with creases across at `creases`: position [m] and angle [rad] of each.
    pub(crate) fn creased_strip(creases: &[(f64, f64)]) -> CurvatureField {
        let lines: Vec<f64> = (0..=60).map(|k| 0.005 * f64::from(k)).collect();
        let garment = TestSheet::strip(&lines, 0.1, 20).flat_garment();
        let mut rest = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| garment.points[p.at()].x);
            for (at, angle) in creases {
                if (a - at).abs() < 1e-9 && (b - at).abs() < 1e-9 {
                    rest.rest_angle[h] = *angle;
                }
            }
        }
        CurvatureField::new(&garment, &rest)
    }

    /// A crease of 1 rad across a strip, put on one line or shared by two lines 5 mm apart.
    #[test]
    fn a_crease_on_one_line_and_shared_by_two_near_lines_differ_little_and_one_elsewhere_much() {
        let [one, shared, away] =
            [&[(0.15, 1.0)][..], &[(0.145, 0.5), (0.15, 0.5)], &[(0.2, 1.0)]].map(creased_strip);
        assert!(one.difference(&one) == 0.0 && one.rms() > 1.0, "{}", one.rms());
        assert!(one.difference(&shared) < 0.25 * one.rms(), "{} of {}", one.difference(&shared), one.rms());
        assert!(one.difference(&away) > 1.2 * one.rms(), "{} of {}", one.difference(&away), one.rms());
    }
}
