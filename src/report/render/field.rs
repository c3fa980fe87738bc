//! Values on a garment, with what is needed to show them: name, unit, colour map, range.
//!
//! Memory lives on hinges; a picture colours points or triangles. Rest angle takes the largest magnitude of a point's
//! hinges (a crease must not be averaged away), stiffness their mean: the same rule as the attributes of the glTF.

use crate::math::Vec3;
use crate::mesh::{Hinge, PointIndex, Topology};
use crate::report::render::ColourMap;

/// One value per point or per triangle.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// One per point, blended across triangles.
    PerPoint(Vec<f64>),
    /// One per triangle.
    PerTriangle(Vec<f64>),
}

/// A field and how to show it.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// What it is, for the legend.
    pub title: String,
    /// Its unit, for the legend; empty for a ratio.
    pub unit: String,
    /// The values, in that unit.
    pub values: Values,
    /// The colours.
    pub map: ColourMap,
    /// Least value of a sequential range that is found by itself.
    pub floor: f64,
    /// Values at the two ends of the legend; found from the values when `None`.
    pub range: Option<[f64; 2]>,
}

/// Share of the values a range that is found by itself covers: a few outliers shall not wash out the rest.
const COVERED: f64 = 0.995;

impl Field {
    /// Change of rest angle, one per point (degrees).
    pub fn rest_angle(degrees: Vec<f64>) -> Self {
        Self::of("rest angle", "°", degrees, ColourMap::Diverging, 0.0)
    }

    /// Magnitude of curvature, one per point [1/m].
    pub fn curvature(per_metre: Vec<f64>) -> Self {
        Self::of("curvature", "1/m", per_metre, ColourMap::Sequential, 0.0)
    }

    /// Bending stiffness over that of new cloth, one per point [-].
    pub fn stiffness_ratio(ratio: Vec<f64>) -> Self {
        Self::of("stiffness ratio", "", ratio, ColourMap::Sequential, 1.0)
    }

    /// Length of the displacement from the garment's own pose, one per point (mm).
    pub fn displacement_mm(millimetres: Vec<f64>) -> Self {
        Self::of("displacement", "mm", millimetres, ColourMap::Sequential, 0.0)
    }

    /// Growth of rest lengths, one per triangle (%).
    pub fn stretch_percent(percent: Vec<f64>) -> Self {
        let field = Self::of("rest stretch", "%", Vec::new(), ColourMap::Diverging, 0.0);
        Self { values: Values::PerTriangle(percent), ..field }
    }

    /// How sure a transfer is, one per triangle, 0 to 1.
    pub fn confidence(share: Vec<f64>) -> Self {
        let range = Some([0.0, 1.0]);
        let values = Values::PerTriangle(share);
        Self { values, range, ..Self::of("confidence", "", Vec::new(), ColourMap::Sequential, 0.0) }
    }

    fn of(title: &str, unit: &str, values: Vec<f64>, map: ColourMap, floor: f64) -> Self {
        let values = Values::PerPoint(values);
        Self { title: title.into(), unit: unit.into(), values, map, floor, range: None }
    }

    fn raw(&self) -> &[f64] {
        match &self.values {
            Values::PerPoint(v) | Values::PerTriangle(v) => v,
        }
    }

    /// The values at the two ends of the legend: as given, or round numbers that cover nearly all values.
    pub fn limits(&self) -> [f64; 2] {
        if let Some([low, high]) = self.range
            && low.is_finite()
            && high > low
            && high.is_finite()
        {
            return [low, high];
        }
        let mut sizes: Vec<f64> = self.raw().iter().copied().filter(|v| v.is_finite()).collect();
        if self.map == ColourMap::Diverging {
            sizes.iter_mut().for_each(|v| *v = v.abs());
        }
        sizes.sort_unstable_by(f64::total_cmp);
        let top = ((sizes.len() as f64 * COVERED) as usize).min(sizes.len().saturating_sub(1));
        let top = sizes.get(top).copied().unwrap_or(0.0);
        match self.map {
            ColourMap::Diverging => [-round_up(top), round_up(top)],
            ColourMap::Sequential => [self.floor, self.floor + round_up(top - self.floor)],
        }
    }

    /// Whether values lie below or above `limits`.
    pub(super) fn clipped(&self, [low, high]: [f64; 2]) -> [bool; 2] {
        // A legend end is not "beyond" for rounding.
        let slack = 1e-6 * (high - low);
        [self.raw().iter().any(|&v| v < low - slack), self.raw().iter().any(|&v| v > high + slack)]
    }
}

/// The next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten that is not below `x`; 1 for nothing.
fn round_up(x: f64) -> f64 {
    if !(x.is_finite() && x > 1e-12) {
        return 1.0;
    }
    let power = 10f64.powf(x.log10().floor());
    let step =
        [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].into_iter().find(|s| s * power >= x * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// Per point: of the values of the hinges whose edge ends there, the one of largest magnitude, with its sign; 0
/// where there is no hinge. `values` has one per hinge.
pub fn largest_of_hinges(point_count: usize, hinges: &[Hinge], values: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0f64; point_count];
    for (hinge, &value) in hinges.iter().zip(values) {
        for point in &hinge.points[..2] {
            if let Some(slot) = out.get_mut(point.at())
                && value.abs() > slot.abs()
            {
                *slot = value;
            }
        }
    }
    out
}

/// Per point: the mean over the hinges whose edge ends there; `empty` where there is none.
pub fn mean_of_hinges(point_count: usize, hinges: &[Hinge], values: &[f64], empty: f64) -> Vec<f64> {
    let mut sums = vec![(0.0, 0u32); point_count];
    for (hinge, &value) in hinges.iter().zip(values) {
        for point in &hinge.points[..2] {
            if let Some(slot) = sums.get_mut(point.at()) {
                *slot = (slot.0 + value, slot.1 + 1);
            }
        }
    }
    sums.into_iter().map(|(sum, count)| if count == 0 { empty } else { sum / f64::from(count) }).collect()
}

/// Magnitude of curvature per point [1/m]: the sum of both principal curvatures, which for cloth, nearly
/// developable, is the one it has. From Steiner's formula: sum of (angle x length) of the point's hinges, over twice
/// its share of area. 0 on open borders, where half of the surroundings is missing.
pub fn curvature(points: &[Vec3], triangles: &[[PointIndex; 3]], topology: &Topology) -> Vec<f64> {
    let corner = |t: &[PointIndex; 3]| -> Option<[Vec3; 3]> {
        let [a, b, c] = t.map(|p| points.get(p.at()).copied());
        Some([a?, b?, c?])
    };
    let normals: Vec<Vec3> = triangles
        .iter()
        .map(|t| corner(t).map_or_else(Vec3::zeros, |[a, b, c]| (b - a).cross(&(c - a))))
        .collect();
    let mut area = vec![0.0; points.len()];
    for (t, n) in triangles.iter().zip(&normals) {
        for p in t {
            if let Some(slot) = area.get_mut(p.at()) {
                *slot += n.norm() / 6.0;
            }
        }
    }
    let mut bend = vec![0.0; points.len()];
    for hinge in &topology.hinges {
        let [x0, x1] = [hinge.points[0].at(), hinge.points[1].at()];
        let sides = hinge.triangles.map(|f| normals.get(f as usize));
        let ([Some(m), Some(n)], Some(a), Some(b)) = (sides, points.get(x0), points.get(x1)) else {
            continue;
        };
        let edge = b - a;
        let length = edge.norm();
        // Signed, so that the small wobble of a triangulation cancels.
        let angle = (m.cross(n).dot(&edge) / length.max(f64::MIN_POSITIVE)).atan2(m.dot(n));
        bend[x0] += angle * length;
        bend[x1] += angle * length;
    }
    for (e, _) in topology.edge_valence.iter().enumerate().filter(|(_, v)| **v != 2) {
        for p in topology.edges.get(e).into_iter().flatten() {
            if let Some(slot) = bend.get_mut(p.at()) {
                *slot = 0.0;
            }
        }
    }
    bend.iter().zip(&area).map(|(b, a)| if *a > 0.0 { b.abs() / (2.0 * a) } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn ranges_are_round_and_cover_what_they_should() {
        assert_eq!(Field::rest_angle(vec![-27.0, 12.0]).limits(), [-30.0, 30.0]);
        assert_eq!(Field::stiffness_ratio(vec![1.0, 3.4]).limits(), [1.0, 4.0]);
        assert_eq!(Field::displacement_mm(vec![0.0; 5]).limits(), [0.0, 1.0]);
        assert_eq!(Field::curvature(vec![]).limits(), [0.0, 1.0]);
        let mut one_outlier = vec![0.9; 1000];
        one_outlier.push(500.0);
        let field = Field::curvature(one_outlier);
        assert_eq!(field.limits(), [0.0, 1.0]);
        assert_eq!(field.clipped(field.limits()), [false, true]);
        let given = Field { range: Some([2.0, 3.0]), ..field };
        assert_eq!(given.limits(), [2.0, 3.0]);
    }

    #[test]
    fn a_tube_has_the_curvature_of_its_radius() {
        let (radius, columns, rows) = (0.05, 60usize, 40usize);
        let height = TAU * radius / columns as f64 * 3f64.sqrt() / 2.0;
        let mut points = Vec::new();
        for i in 0..rows {
            for j in 0..columns {
                let turn = (j as f64 + 0.5 * (i % 2) as f64) / columns as f64;
                let (sin, cos) = (TAU * turn).sin_cos();
                points.push(Vec3::new(radius * sin, i as f64 * height, radius * cos));
            }
        }
        let at = |i: usize, j: usize| PointIndex((i * columns + j % columns) as u32);
        let mut triangles = Vec::new();
        for i in 0..rows - 1 {
            for j in 0..columns {
                let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
                triangles.extend(if i % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
            }
        }
        let topology = Topology::new(points.len(), &triangles);
        let curvature = curvature(&points, &triangles, &topology);
        let middle = curvature[20 * columns + 7];
        assert!((middle * radius - 1.0).abs() < 0.01, "{middle} 1/m for a radius of {radius} m");
        assert_eq!(curvature[0], 0.0, "open border");
    }

    #[test]
    fn hinges_give_points_their_largest_and_their_mean() {
        let hinge =
            |a: u32, b: u32| Hinge { points: [a, b, 8, 9].map(PointIndex), triangles: [0, 1], edge: 0 };
        let hinges = [hinge(0, 1), hinge(1, 2)];
        assert_eq!(largest_of_hinges(4, &hinges, &[2.0, -3.0]), [2.0, -3.0, -3.0, 0.0]);
        assert_eq!(mean_of_hinges(4, &hinges, &[2.0, 3.0], 1.0), [2.0, 2.5, 3.0, 1.0]);
    }
}
