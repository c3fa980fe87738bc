//! Flat test specimens in the material plane, warp along x; also those of `tests/elastic.rs`.

use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, Topology};
use crease_model::error::{Error, Result};
use crease_model::garment::Garment;
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// A flat specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct TestSheet {
    /// Points of the material plane [m].
    pub flat: Vec<Vec2>,
    /// Triangles over the points, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}

impl TestSheet {
    /// Quads between lines across at `along` [m] and `across` + 1 lines over `width` [m], cut by one diagonal. Bent
    /// about the lines across, only their hinges have an angle.
    pub fn strip(along: &[f64], width: f64, across: usize) -> Self {
        let rows = across + 1;
        let y = |j: usize| width * (j as f64 / across as f64 - 0.5);
        let flat = along.iter().flat_map(|&x| (0..rows).map(move |j| Vec2::new(x, y(j)))).collect();
        let at = |i: usize, j: usize| (i * rows + j) as u32;
        let triangles = (1..along.len())
            .flat_map(|i| (1..rows).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let (a, b, c, d) = (at(i - 1, j - 1), at(i, j - 1), at(i, j), at(i - 1, j));
                [[a, b, c], [a, c, d]]
            })
            .collect();
        Self { flat, triangles }
    }

    /// An unstructured triangulation of `length` x `width` [m] with about `count` points: evenly spaced ones on the
    /// border, and inside an equilateral lattice whose points are displaced at random (by a fixed seed) by up to a
    /// seventh of their distance. Deterministic.
    pub(super) fn unstructured(length: f64, width: f64, count: usize) -> Result<Self> {
        // The number of points decreases with their spacing: bisection.
        let (mut fine, mut coarse) = (0.2, 2.0);
        let unit = (length * width / count as f64).sqrt();
        for _ in 0..40 {
            let middle = 0.5 * (fine + coarse);
            if scattered(length, width, middle * unit).len() > count {
                fine = middle
            } else {
                coarse = middle
            }
        }
        let candidates = [fine, coarse].map(|spacing| scattered(length, width, spacing * unit));
        let [more, fewer] = candidates;
        let flat = if more.len().abs_diff(count) < fewer.len().abs_diff(count) { more } else { fewer };
        Self::delaunay(flat, 1e-3 * unit * unit)
    }

    /// Delaunay triangulation of `flat`; triangles of twice the area `sliver` [m²] or less are left out: collinear
    /// points of the border span triangles of rounding errors.
    ///
    /// # Errors
    /// If a point is not finite.
    pub fn delaunay(flat: Vec<Vec2>, sliver: f64) -> Result<Self> {
        let mut mesh = DelaunayTriangulation::<Point2<f64>>::new();
        for p in &flat {
            mesh.insert(Point2::new(p.x, p.y))
                .map_err(|e| Error::input("chart", "", format!("cannot be meshed: {e:?}"), ""))?;
        }
        let triangles = mesh
            .inner_faces()
            .map(|face| face.vertices().map(|v| v.fix().index() as u32))
            .filter(|t| {
                let [a, b, c] = t.map(|p| flat[p as usize]);
                (b - a).perp(&(c - a)) > sliver
            })
            .collect();
        Ok(Self { flat, triangles })
    }

    /// A strip 0..`length` of `width` [m] with one more row before 0 for a clamp, filled with an equilateral lattice
    /// of edge `length` / `along` rotated by `degrees`; lattice points closer than 0.45 edges to the border are left
    /// out.
    ///
    /// # Errors
    /// If a point is not finite.
    pub fn lattice(length: f64, width: f64, along: usize, degrees: f64) -> Result<Self> {
        let h = length / along as f64;
        let across = (width / h).round() as usize;
        let (s, c) = degrees.to_radians().sin_cos();
        let (margin, extent) = (0.45 * h, 2 * along as i32);
        let mut flat = Vec::new();
        for i in -extent..extent {
            for j in -extent..extent {
                let shift = 0.5 * f64::from(j.rem_euclid(2));
                let q = Vec2::new(f64::from(i) + shift, f64::from(j) * 0.75f64.sqrt()) * h;
                let p = Vec2::new(c * q.x - s * q.y + 0.5 * length, s * q.x + c * q.y);
                if p.x > margin && p.x < length - margin && p.y.abs() < 0.5 * width - margin {
                    flat.push(p);
                }
            }
        }
        let even = |k: usize| width * (k as f64 / across as f64 - 0.5);
        for k in -1..=along as i64 {
            flat.extend([-0.5 * width, 0.5 * width].map(|y| Vec2::new(k as f64 * h, y)));
        }
        for x in [-h, 0.0, length] {
            flat.extend((1..across).map(|k| Vec2::new(x, even(k))));
        }
        Self::delaunay(flat, 1e-3 * h * h)
    }

    /// A ring between the radii `inner` and `outer` [m], with one more row of elements inside for a clamp: rings of
    /// points `h` [m] apart.
    pub(super) fn ring(inner: f64, outer: f64, h: f64) -> Result<Self> {
        let rings = ((outer - inner) / h).round().max(1.0) as usize;
        let mut flat = Vec::new();
        for k in 0..=rings + 1 {
            let radius = inner + (k as f64 - 1.0) * (outer - inner) / rings as f64;
            let count = (std::f64::consts::TAU * radius / h).round().max(12.0) as usize;
            let shift = 0.5 * (k % 2) as f64;
            flat.extend((0..count).map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * (i as f64 + shift) / count as f64).sin_cos();
                Vec2::new(radius * cos, radius * sin)
            }));
        }
        let mut sheet = Self::delaunay(flat, 1e-3 * h * h)?;
        // Triangles across the hole are not cloth.
        let hole = inner - (outer - inner) / rings as f64;
        let flat = &sheet.flat;
        sheet.triangles.retain(|t| !t.iter().all(|p| flat[*p as usize].norm() < hole + 1e-9));
        Ok(sheet)
    }

    /// Stiffness ratio of every hinge of a specimen whose points are `clamped` (one flag per point): twice as stiff
    /// between a fully clamped triangle and a free one. Otherwise the clamp lies half an element inside the free
    /// cloth and the order of convergence is one.
    pub fn half_clamp(&self, clamped: &[bool]) -> Vec<f64> {
        let triangles: Vec<[PointIndex; 3]> = self.triangles.iter().map(|t| t.map(PointIndex)).collect();
        let is_clamped = |f: u32| self.triangles[f as usize].iter().all(|&p| clamped[p as usize]);
        let topology = Topology::new(self.flat.len(), &triangles);
        let across = |[a, b]: [u32; 2]| is_clamped(a) != is_clamped(b);
        topology.hinges.iter().map(|h| if across(h.triangles) { 2.0 } else { 1.0 }).collect()
    }

    /// Garment whose source pose has its points at `points` [m].
    pub(super) fn garment(&self, points: Vec<Vec3>) -> Garment {
        let material = self.triangles.iter().map(|t| t.map(|p| self.flat[p as usize])).collect();
        Garment { material, material_from_uv: true, ..Garment::of_triangles(points, &self.triangles) }
    }

    /// Garment that lies flat at height 0: x stays x, y becomes -z.
    pub(super) fn flat_garment(&self) -> Garment {
        self.garment(self.flat.iter().map(|p| Vec3::new(p.x, 0.0, -p.y)).collect())
    }
}

/// Points of an unstructured rectangle, `spacing` [m] apart.
fn scattered(length: f64, width: f64, spacing: f64) -> Vec<Vec2> {
    let counts = [length, width].map(|side| (side / spacing).round().max(1.0) as usize);
    let even = |side: f64, count: usize| (0..=count).map(move |k| side * (k as f64 / count as f64 - 0.5));
    let mut points = Vec::new();
    for y in [-0.5 * width, 0.5 * width] {
        points.extend(even(length, counts[0]).map(|x| Vec2::new(x, y)));
    }
    for x in [-0.5 * length, 0.5 * length] {
        points.extend(even(width, counts[1]).map(|y| Vec2::new(x, y)).skip(1).take(counts[1] - 1));
    }
    // A linear congruential generator (Knuth): the upper bits as a number from -1 to 1.
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    };
    let rows = (width / (spacing * 0.75f64.sqrt())).ceil() as i64;
    let columns = (length / spacing).ceil() as i64;
    for j in -rows..=rows {
        for i in -columns..=columns {
            let shift = 0.5 * (j.rem_euclid(2)) as f64;
            let lattice = Vec2::new(i as f64 + shift, j as f64 * 0.75f64.sqrt()) * spacing;
            let p = lattice + Vec2::new(random(), random()) * (spacing / 7.0);
            let distance_to_border = (0.5 * length - p.x.abs()).min(0.5 * width - p.y.abs());
            if distance_to_border > 0.55 * spacing {
                points.push(p);
            }
        }
    }
    points
}
