//! Shapes for the tests of pictures and pages.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use std::f64::consts::{PI, TAU};

/// Returns the points and triangles of a sphere around the origin.
pub fn sphere(radius: f64, rows: usize) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
    let columns = 2 * rows;
    let mut points = Vec::new();
    for i in 0..=rows {
        for j in 0..columns {
            let (a, b) = (PI * i as f64 / rows as f64, TAU * j as f64 / columns as f64);
            points.push(radius * Vec3::new(a.sin() * b.sin(), a.cos(), a.sin() * b.cos()));
        }
    }
    let at = |i: usize, j: usize| PointIndex((i * columns + j % columns) as u32);
    let mut triangles = Vec::new();
    for i in 0..rows {
        for j in 0..columns {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    (points, triangles)
}
