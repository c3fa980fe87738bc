//! Bodies for tests, as triangles.

use crease::contact::Body;
use crease::math::Vec3;
use crease::mesh::PointIndex;
use std::f64::consts::{PI, TAU};

/// Points [m] and triangles.
#[derive(Debug, Clone, Default)]
pub struct Shape {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[PointIndex; 3]>,
}

impl Shape {
    /// Sphere of `rings` rings of twice as many points; `radius` [m] by direction.
    pub fn ball(centre: Vec3, rings: usize, radius: impl Fn(usize, usize) -> f64) -> Self {
        let (n, m) = (rings, 2 * rings);
        let mut points = Vec::new();
        for i in 1..n {
            let (sin, cos) = (PI * i as f64 / n as f64).sin_cos();
            for j in 0..m {
                let (s, c) = (TAU * j as f64 / m as f64).sin_cos();
                points.push(centre + Vec3::new(sin * c, cos, sin * s) * radius(i, j));
            }
        }
        points.push(centre + Vec3::y() * radius(0, 0));
        points.push(centre - Vec3::y() * radius(n, 0));
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

    pub fn sphere(centre: Vec3, radius: f64, rings: usize) -> Self {
        Self::ball(centre, rings, |_, _| radius)
    }

    /// A sphere with a needle on every third point of every third ring.
    pub fn spiked(centre: Vec3, radius: f64, spike: f64, rings: usize) -> Self {
        Self::ball(centre, rings, |i, j| if i % 3 == 0 && j % 3 == 0 { radius + spike } else { radius })
    }

    /// A tube of `radii` (from the middle, of the tube) [m] around the y axis: closed, not convex.
    pub fn torus(centre: Vec3, radii: [f64; 2], count: [usize; 2]) -> Self {
        let [m, n] = count;
        let mut shape = Self::default();
        for i in 0..m {
            let (s, c) = (TAU * i as f64 / m as f64).sin_cos();
            for j in 0..n {
                let (sin, cos) = (TAU * j as f64 / n as f64).sin_cos();
                let out = radii[0] + radii[1] * cos;
                shape.points.push(centre + Vec3::new(out * c, radii[1] * sin, out * s));
            }
        }
        let at = |i: usize, j: usize| PointIndex((i % m * n + j % n) as u32);
        for i in 0..m {
            for j in 0..n {
                shape.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
                shape.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
            }
        }
        shape
    }

    /// A rectangle with corner `at` and sides `a` and `b` [m], in `count` quads: a body without inside.
    pub fn plate(at: Vec3, a: Vec3, b: Vec3, count: [usize; 2]) -> Self {
        let [m, n] = count;
        let mut shape = Self::default();
        for i in 0..=m {
            for j in 0..=n {
                shape.points.push(at + a * (i as f64 / m as f64) + b * (j as f64 / n as f64));
            }
        }
        let at = |i: usize, j: usize| PointIndex((i * (n + 1) + j) as u32);
        for i in 0..m {
            for j in 0..n {
                shape.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                shape.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        shape
    }

    /// Both shapes as one body.
    pub fn and(mut self, other: Self) -> Self {
        let base = self.points.len() as u32;
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + base))));
        self
    }

    pub fn body(&self) -> Body {
        Body::new(self.points.clone(), self.triangles.clone()).expect("test bodies are sound")
    }
}
