//! Bodies for tests, as triangles.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use std::f64::consts::{PI, TAU};

/// Points [m] and triangles.
#[derive(Debug, Clone, Default)]
pub struct Shape {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[PointIndex; 3]>,
}

impl Shape {
    /// Sphere of `radius` [m], of `rings` rings of twice as many points.
    pub fn sphere(centre: Vec3, radius: f64, rings: usize) -> Self {
        let (n, m) = (rings, 2 * rings);
        let mut points = Vec::new();
        for i in 1..n {
            let (sin, cos) = (PI * i as f64 / n as f64).sin_cos();
            for j in 0..m {
                let (s, c) = (TAU * j as f64 / m as f64).sin_cos();
                points.push(centre + Vec3::new(sin * c, cos, sin * s) * radius);
            }
        }
        points.push(centre + Vec3::y() * radius);
        points.push(centre - Vec3::y() * radius);
        let at = |i: usize, j: usize| match i {
            0 => PointIndex(((n - 1) * m) as u32),
            i if i == n => PointIndex(((n - 1) * m + 1) as u32),
            i => PointIndex(((i - 1) * m + j % m) as u32),
        };
        let mut triangles = Vec::new();
        for i in 0..n {
            for j in 0..m {
                if i > 0 {
                    triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
                }
                if i + 1 < n {
                    triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
                }
            }
        }
        Self { points, triangles }
    }
}
