//! Fields: values on a garment with name, unit, colour map and range.
//!
//! Memory belongs to hinges, while pictures colour points or triangles. A point has the rest angle change of largest
//! magnitude among its hinges (averaging would hide creases) and their mean stiffness ratio, as in the attributes of the
//! glTF.

use crate::report::render::colour::ColourMap;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{Hinge, PointIndex, Topology, triangle};

/// Values of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// One value per point, interpolated across triangles.
    PerPoint(Vec<f64>),
    /// One value per triangle.
    PerTriangle(Vec<f64>),
}

/// A field and its display.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Title of the legend.
    pub title: String,
    /// Unit in the legend; empty for a ratio.
    pub unit: String,
    /// Values in this unit.
    pub values: Values,
    /// Colour map.
    pub map: ColourMap,
    /// Lower end of an automatic sequential range.
    pub minimum: f64,
    /// Values at both ends of the legend; derived from the values if `None`.
    pub range: Option<[f64; 2]>,
}

/// Colours of a picture.
#[derive(Debug, Clone)]
pub enum Colouring {
    /// Shape only: one colour outside, another inside.
    Shape,
    /// Values on the surface, with a legend.
    Field(Field),
}

/// Fraction of the values that count within an automatic range, so that seams and hems, whose angles are large everywhere,
/// do not flatten the rest [-].
const COVERED_FRACTION: f64 = 0.97;
/// Fraction of the largest values that do not decide which values count [-].
const OUTLIER_FRACTION: f64 = 0.005;
/// Values below this fraction of the large ones do not count: where memory is sparse, most cloth has none [-].
const MIN_COUNTED_FRACTION: f64 = 0.02;

impl Field {
    /// Creates the field of the change of rest angle, one value per point [degrees].
    pub fn rest_angle_change(degrees: Vec<f64>) -> Self {
        Self::per_point("rest angle change", "°", degrees, ColourMap::Diverging, 0.0)
    }

    /// Creates the field of the magnitude of curvature, one value per point [1/m].
    pub fn curvature(per_metre: Vec<f64>) -> Self {
        Self::per_point("curvature", "1/m", per_metre, ColourMap::Sequential, 0.0)
    }

    /// Creates the field of the bending stiffness relative to new cloth, one value per point [-].
    pub fn stiffness_ratio(ratio: Vec<f64>) -> Self {
        Self::per_point("stiffness ratio", "", ratio, ColourMap::Sequential, 1.0)
    }

    /// Creates the field of the distance from the source shape, one value per point [mm].
    pub fn displacement_mm(millimetres: Vec<f64>) -> Self {
        Self::per_point("displacement", "mm", millimetres, ColourMap::Sequential, 0.0)
    }

    /// Creates the field of the change of rest lengths, one value per triangle [%].
    pub fn stretch_percent(percent: Vec<f64>) -> Self {
        let field = Self::per_point("rest stretch", "%", Vec::new(), ColourMap::Diverging, 0.0);
        Self { values: Values::PerTriangle(percent), ..field }
    }

    /// Creates the field of the confidence of a transfer, one value per triangle, 0 to 1.
    pub fn confidence(confidence: Vec<f64>) -> Self {
        let range = Some([0.0, 1.0]);
        let values = Values::PerTriangle(confidence);
        Self { values, range, ..Self::per_point("confidence", "", Vec::new(), ColourMap::Sequential, 0.0) }
    }

    fn per_point(title: &str, unit: &str, values: Vec<f64>, map: ColourMap, minimum: f64) -> Self {
        let values = Values::PerPoint(values);
        Self { title: title.into(), unit: unit.into(), values, map, minimum, range: None }
    }

    fn raw(&self) -> &[f64] {
        match &self.values {
            Values::PerPoint(v) | Values::PerTriangle(v) => v,
        }
    }

    /// Returns the values at both ends of the legend: as set, or round numbers that cover nearly all values.
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
        let base = if self.map == ColourMap::Diverging { 0.0 } else { self.minimum };
        let large = quantile(&sizes, 1.0 - OUTLIER_FRACTION);
        let counted = sizes.partition_point(|v| *v < base + MIN_COUNTED_FRACTION * (large - base));
        let top = quantile(&sizes[counted..], COVERED_FRACTION);
        match self.map {
            ColourMap::Diverging => [-round_up(top), round_up(top)],
            ColourMap::Sequential => [self.minimum, self.minimum + round_up(top - self.minimum)],
        }
    }

    /// Whether there are values below or above the legend with these limits.
    pub(super) fn clipped(&self, [low, high]: [f64; 2]) -> Clipped {
        // Rounding errors are not beyond the legend.
        let tolerance = 1e-6 * (high - low);
        Clipped {
            below: self.raw().iter().any(|&v| v < low - tolerance),
            above: self.raw().iter().any(|&v| v > high + tolerance),
        }
    }
}

/// Whether values lie beyond the ends of a legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Clipped {
    /// Whether values lie below its lower end.
    pub below: bool,
    /// Whether values lie above its upper end.
    pub above: bool,
}

/// Returns the value below which `fraction` of the sorted `values` lie; 0 without any.
fn quantile(values: &[f64], fraction: f64) -> f64 {
    let index = ((values.len() as f64 * fraction) as usize).min(values.len().saturating_sub(1));
    values.get(index).copied().unwrap_or(0.0)
}

/// Returns the smallest of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten that is at least `x`; 1 for zero and below.
fn round_up(x: f64) -> f64 {
    if !(x.is_finite() && x > 1e-12) {
        return 1.0;
    }
    let power = 10f64.powf(x.log10().floor());
    let step =
        [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0].into_iter().find(|s| s * power >= x * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// Returns per point the value of largest magnitude, with its sign, among the hinges whose edge ends there; 0 without
/// hinges. `values` has one entry per hinge.
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

/// Returns per point the mean over the hinges whose edge ends there; `empty` without hinges.
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

/// Returns the magnitude of curvature per point [1/m]: the sum of both principal curvatures, one of which is nearly zero for
/// cloth. By Steiner's formula it is the sum of angle times length over the hinges of the point, divided by twice its
/// area (a third of its triangles). 0 on open boundaries, where half of the neighbourhood is missing.
pub fn curvature(points: &[Vec3], triangles: &[[PointIndex; 3]], topology: &Topology) -> Vec<f64> {
    let corner = |t: &[PointIndex; 3]| -> Option<[Vec3; 3]> {
        let [a, b, c] = t.map(|p| points.get(p.at()).copied());
        Some([a?, b?, c?])
    };
    let normals: Vec<Vec3> = triangles
        .iter()
        .map(|t| corner(t).map_or_else(Vec3::zeros, |corners| triangle::area_vector(&corners)))
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
        // Signed, so that small alternating angles of a triangulation cancel.
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
    fn ranges_are_round_and_cover_nearly_all_values() {
        assert_eq!(Field::rest_angle_change(vec![-27.0, 12.0]).limits(), [-30.0, 30.0]);
        assert_eq!(Field::stiffness_ratio(vec![1.0, 3.4]).limits(), [1.0, 4.0]);
        assert_eq!(Field::displacement_mm(vec![0.0; 5]).limits(), [0.0, 1.0]);
        assert_eq!(Field::curvature(vec![]).limits(), [0.0, 1.0]);
        let mut one_outlier = vec![0.9; 1000];
        one_outlier.push(500.0);
        let field = Field::curvature(one_outlier);
        assert_eq!(field.limits(), [0.0, 1.0]);
        assert_eq!(field.clipped(field.limits()), Clipped { below: false, above: true });
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
