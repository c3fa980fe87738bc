//! Flat sheets of cloth for tests: triangles in the material plane and the models made from them.

use crease::energy::{Bending, Membrane};
use crease::garment::RestState;
use crease::math::{Vec2, Vec3};
use crease::mesh::{PointIndex, Topology};
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// Points of the material plane [m] and triangles over them, all turning the same way.
#[derive(Debug, Clone)]
pub struct Sheet {
    pub flat: Vec<Vec2>,
    pub triangles: Vec<[u32; 3]>,
}

/// `count + 1` values from `from` to `to`.
pub fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}

impl Sheet {
    /// Quads between the lines `xs` and `ys`, all cut by the same diagonal, or by alternating ones (union jack).
    pub fn quads(xs: &[f64], ys: &[f64], alternating: bool) -> Self {
        let flat = xs.iter().flat_map(|&x| ys.iter().map(move |&y| Vec2::new(x, y))).collect();
        let at = |i: usize, j: usize| (i * ys.len() + j) as u32;
        let mut triangles = Vec::new();
        for i in 0..xs.len() - 1 {
            for j in 0..ys.len() - 1 {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                if alternating && (i + j) % 2 == 1 {
                    triangles.extend([[a, b, d], [b, c, d]]);
                } else {
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        Self { flat, triangles }
    }

    /// One-diagonal strip 0..length with one more column of quads before 0 for the clamp.
    pub fn strip(length: f64, width: f64, along: usize) -> Self {
        let across = (along as f64 * width / length).round() as usize;
        let mut xs = vec![-length / along as f64];
        xs.extend(spaced(0.0, length, along));
        Self::quads(&xs, &spaced(-width / 2.0, width / 2.0, across), false)
    }

    /// Delaunay triangulation of `flat`; triangles of twice the area `sliver` [m²] or less are left out.
    pub fn delaunay(flat: Vec<Vec2>, sliver: f64) -> Self {
        let mut mesh = DelaunayTriangulation::<Point2<f64>>::new();
        for p in &flat {
            mesh.insert(Point2::new(p.x, p.y)).expect("test points are finite");
        }
        let twice = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| flat[i as usize]);
            (b - a).perp(&(c - a))
        };
        let triangles = mesh
            .inner_faces()
            .map(|face| face.vertices().map(|v| v.fix().index() as u32))
            .filter(|t| twice(t) > sliver)
            .collect();
        Self { flat, triangles }
    }

    /// A strip as [`Self::strip`], filled with an equilateral lattice turned by `degrees` (the meshes of
    /// `r16_locking.py`: lattice points nearer than 0.45 edges to the border or the clamp line give way).
    pub fn lattice_strip(length: f64, width: f64, along: usize, degrees: f64) -> Self {
        let h = length / along as f64;
        let across = (width / h).round() as usize;
        let (s, c) = degrees.to_radians().sin_cos();
        let (margin, reach) = (0.45 * h, 2 * along as i32);
        let mut flat = Vec::new();
        for i in -reach..reach {
            for j in -reach..reach {
                let q = Vec2::new(
                    (f64::from(i) + 0.5 * f64::from(j.rem_euclid(2))) * h,
                    f64::from(j) * h * 3f64.sqrt() / 2.0,
                );
                let p = Vec2::new(c * q.x - s * q.y + length / 2.0, s * q.x + c * q.y);
                if p.x > margin && p.x < length - margin && p.y.abs() < width / 2.0 - margin {
                    flat.push(p);
                }
            }
        }
        let ys = spaced(-width / 2.0, width / 2.0, across);
        for x in std::iter::once(-h).chain(spaced(0.0, length, along)) {
            flat.extend([-width / 2.0, width / 2.0].map(|y| Vec2::new(x, y)));
        }
        for x in [-h, 0.0, length] {
            flat.extend(ys[1..across].iter().map(|&y| Vec2::new(x, y)));
        }
        Self::delaunay(flat, 1e-3 * h * h)
    }

    pub fn topology(&self) -> Topology {
        let triangles: Vec<_> = self.triangles.iter().map(|t| t.map(PointIndex)).collect();
        Topology::new(self.flat.len(), &triangles)
    }

    /// Corners of every triangle in the material plane [m].
    pub fn material(&self) -> Vec<[Vec2; 3]> {
        self.triangles.iter().map(|t| t.map(|i| self.flat[i as usize])).collect()
    }

    /// Membrane of `stiffness` (warp, weft, shear) [N/m], undamped.
    pub fn membrane(&self, stiffness: [f64; 3]) -> Membrane {
        Membrane::from_parts(&self.triangles, &self.material(), stiffness, 0.0)
    }

    /// Bending of isotropic `rigidity` [N·m], undamped.
    pub fn bending(&self, rigidity: f64) -> Bending {
        Bending::from_parts(&self.topology(), &self.material(), [rigidity; 2], 0.0)
    }

    /// New, flat memory.
    pub fn memory(&self) -> RestState {
        RestState::flat(self.topology().hinges.len(), self.triangles.len())
    }

    /// Memory whose hinges between a wholly held triangle and a free one are twice as stiff: the half clamp. Without
    /// it the clamp line lies half an element inside the free cloth and the order falls to one.
    pub fn half_clamped(&self, held: &[bool]) -> RestState {
        let wholly = |f: u32| self.triangles[f as usize].iter().all(|&i| held[i as usize]);
        let mut memory = self.memory();
        for (ratio, hinge) in memory.stiffness_ratio.iter_mut().zip(&self.topology().hinges) {
            if wholly(hinge.triangles[0]) != wholly(hinge.triangles[1]) {
                *ratio = 2.0;
            }
        }
        memory
    }

    /// A third of the area of its triangles for every point, times `density` [kg/m²].
    pub fn mass(&self, density: f64) -> Vec<f64> {
        let mut mass = vec![0.0; self.flat.len()];
        for (t, m) in self.triangles.iter().zip(self.material()) {
            let area = 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs();
            t.iter().for_each(|&i| mass[i as usize] += density * area / 3.0);
        }
        mass
    }

    /// The sheet laid flat at z = 0.
    pub fn laid(&self) -> Vec<Vec3> {
        self.flat.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect()
    }
}
