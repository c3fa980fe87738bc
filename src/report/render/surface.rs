//! Normals and colours of a surface.

use crate::report::render::camera::Projection;
use crate::report::render::field::{Colouring, Values};
use crate::report::render::lights::Lights;
use crate::report::render::raster::weights;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, triangle};

/// Colour of the outer side of cloth in a picture of the shape, linear light.
const OUTSIDE: [f64; 3] = [0.40, 0.46, 0.54];
/// Colour of the inner side of cloth in a picture of the shape, linear light.
const INSIDE: [f64; 3] = [0.50, 0.40, 0.32];
/// Maximum angle between triangles whose corners have a common normal; sharper creases stay sharp [degrees].
const MAX_SMOOTH_DEG: f64 = 80.0;
/// Weight of light in the colour of a field: enough to show the shape without distorting the values [-].
const FIELD_LIGHT_WEIGHT: f64 = 0.55;

/// A surface to be drawn.
#[derive(Clone, Copy)]
pub(super) struct DrawnSurface<'a> {
    /// Positions [m].
    pub points: &'a [Vec3],
    /// All triangles, in the order of values per triangle.
    pub triangles: &'a [[PointIndex; 3]],
    /// Triangles that are drawn.
    pub drawn: &'a [[usize; 3]],
    /// Unit normals per drawn triangle and corner; smooth ones without them.
    pub normals: Option<&'a [[Vec3; 3]]>,
    /// Colours.
    pub colouring: &'a Colouring,
}

/// Normals and colours of a surface.
pub(super) struct ShadedSurface<'a> {
    drawn: &'a [[usize; 3]],
    /// Unit normal per drawn triangle.
    pub normals: Vec<Vec3>,
    /// Unit normals per drawn triangle and corner.
    corner_normals: Vec<[Vec3; 3]>,
    /// Values per drawn triangle and corner as fractions of the range of the legend; empty for the shape.
    fractions: Vec<[f64; 3]>,
    colouring: &'a Colouring,
}

impl<'a> ShadedSurface<'a> {
    /// Computes normals and colours.
    pub fn new(surface: &DrawnSurface<'a>) -> Self {
        let DrawnSurface { points, drawn, colouring, .. } = *surface;
        let (areas, normals) = areas_and_normals(points, drawn);
        let corner_normals = match surface.normals {
            Some(given) => given.to_vec(),
            None => corner_normals(points.len(), drawn, &areas, &normals),
        };
        let fractions = legend_fractions(surface);
        Self { drawn, normals, corner_normals, fractions, colouring }
    }

    /// Returns the colour of triangle `f` at `pixel`, in linear light.
    pub fn colour(
        &self,
        f: usize,
        pixel: Vec2,
        projection: &Projection,
        projected: &[Vec3],
        lights: &Lights,
    ) -> Vec3 {
        let corners = self.drawn[f].map(|i| projected[i]);
        let flat = weights(&corners, pixel).unwrap_or([1.0, 0.0, 0.0]);
        let mut w: [f64; 3] = std::array::from_fn(|k| flat[k] * projection.perspective_weight(corners[k].z));
        let sum: f64 = w.iter().sum();
        w.iter_mut().for_each(|x| *x /= sum);
        let [a, b, c] = self.corner_normals[f];
        let is_outside = self.normals[f].dot(&projection.toward) >= 0.0;
        let side = if is_outside { 1.0 } else { -1.0 };
        let normal = side * (w[0] * a + w[1] * b + w[2] * c).try_normalize(0.0).unwrap_or(self.normals[f]);
        let light = lights.on(normal);
        match self.colouring {
            Colouring::Shape => Vec3::from(if is_outside { OUTSIDE } else { INSIDE }) * light,
            Colouring::Field(field) => {
                let fraction: f64 = (0..3).map(|k| w[k] * self.fractions[f][k]).sum();
                Vec3::from(field.map.linear(fraction))
                    * (1.0 - FIELD_LIGHT_WEIGHT + FIELD_LIGHT_WEIGHT * light)
            }
        }
    }
}

/// Returns unit normals per triangle and corner: smooth, but for sharp edges.
pub fn smooth_corner_normals(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<[Vec3; 3]> {
    let all: Vec<[usize; 3]> = triangles.iter().map(|t| t.map(PointIndex::at)).collect();
    let (areas, normals) = areas_and_normals(points, &all);
    corner_normals(points.len(), &all, &areas, &normals)
}

/// Returns per triangle its area vector [m²] and its unit normal.
fn areas_and_normals(points: &[Vec3], triangles: &[[usize; 3]]) -> (Vec<Vec3>, Vec<Vec3>) {
    let areas: Vec<Vec3> = triangles.iter().map(|t| triangle::area_vector(&t.map(|i| points[i]))).collect();
    let normals = areas.iter().map(|n| n.try_normalize(0.0).unwrap_or_else(Vec3::y)).collect();
    (areas, normals)
}

/// Returns the normals per corner: the mean over the triangles of the point whose normals differ by less than
/// [`MAX_SMOOTH_DEG`].
fn corner_normals(
    point_count: usize,
    drawn: &[[usize; 3]],
    areas: &[Vec3],
    normals: &[Vec3],
) -> Vec<[Vec3; 3]> {
    let mut first = vec![0usize; point_count + 1];
    for &i in drawn.iter().flatten() {
        first[i + 1] += 1;
    }
    for i in 0..point_count {
        first[i + 1] += first[i];
    }
    let mut of_point = vec![0u32; first[point_count]];
    let mut next = first.clone();
    for (f, t) in drawn.iter().enumerate() {
        for &i in t {
            of_point[next[i]] = f as u32;
            next[i] += 1;
        }
    }
    let limit = MAX_SMOOTH_DEG.to_radians().cos();
    drawn
        .iter()
        .enumerate()
        .map(|(f, t)| {
            t.map(|i| {
                let triangles = of_point[first[i]..first[i + 1]].iter().map(|&g| g as usize);
                let sum: Vec3 =
                    triangles.filter(|&g| normals[g].dot(&normals[f]) > limit).map(|g| areas[g]).sum();
                sum.try_normalize(0.0).unwrap_or(normals[f])
            })
        })
        .collect()
}

/// Returns the values of the corners of drawn triangles as fractions of the range of the legend; NaN where there is none.
fn legend_fractions(surface: &DrawnSurface) -> Vec<[f64; 3]> {
    let DrawnSurface { points, triangles, drawn, colouring, .. } = *surface;
    let point_count = points.len();
    let Colouring::Field(field) = colouring else { return Vec::new() };
    let [low, high] = field.limits();
    let fraction =
        |value: Option<&f64>| value.map_or(f64::NAN, |v| ((v - low) / (high - low)).clamp(0.0, 1.0));
    match &field.values {
        Values::PerPoint(values) => drawn.iter().map(|t| t.map(|i| fraction(values.get(i)))).collect(),
        Values::PerTriangle(values) if drawn.len() == triangles.len() => {
            (0..drawn.len()).map(|f| [fraction(values.get(f)); 3]).collect()
        }
        // Some triangles are not drawn; both lists have the same order.
        Values::PerTriangle(values) => {
            let mut all = triangles.iter().zip(values.iter().map(Some).chain(std::iter::repeat(None)));
            drawn
                .iter()
                .map(|t| {
                    let same = |s: &[PointIndex; 3]| {
                        s.map(PointIndex::at) == *t && t.iter().all(|&i| i < point_count)
                    };
                    [fraction(all.find(|(s, _)| same(s)).and_then(|(_, v)| v)); 3]
                })
                .collect()
        }
    }
}
