//! Flat sheets of cloth for tests: meshes in the material plane and the models made from them.

use crease_chart::TestSheet;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, Topology};
use crease_model::garment::RestState;
use crease_solver::energy::{Bending, Membrane};

/// `count + 1` values from `from` to `to`.
pub fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}

/// Quads between the lines `xs` and `ys`, all cut by the same diagonal, or by alternating ones (union jack).
pub fn quads(xs: &[f64], ys: &[f64], alternating: bool) -> TestSheet {
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
    TestSheet { flat, triangles }
}

/// One-diagonal strip 0..length with one more column of quads before 0 for the clamp.
pub fn clamped_strip(length: f64, width: f64, along: usize) -> TestSheet {
    let across = (along as f64 * width / length).round() as usize;
    let mut xs = vec![-length / along as f64];
    xs.extend(spaced(0.0, length, along));
    quads(&xs, &spaced(-width / 2.0, width / 2.0, across), false)
}

/// Models and fields of a sheet.
pub trait SheetModels {
    /// Topology of the triangles.
    fn topology(&self) -> Topology;
    /// Corners of every triangle in the material plane [m].
    fn material(&self) -> Vec<[Vec2; 3]>;
    /// Membrane of `stiffness` (warp, weft, shear) [N/m], undamped.
    fn membrane(&self, stiffness: [f64; 3]) -> Membrane;
    /// Bending of isotropic `rigidity` [N·m], undamped.
    fn bending(&self, rigidity: f64) -> Bending;
    /// New, flat memory.
    fn memory(&self) -> RestState;
    /// Memory of a half clamp where points are `held` ([`TestSheet::half_clamp`]).
    fn half_clamped(&self, held: &[bool]) -> RestState;
    /// A third of the area of its triangles for every point, times `density` [kg/m²].
    fn mass(&self, density: f64) -> Vec<f64>;
    /// The sheet laid flat at z = 0.
    fn laid(&self) -> Vec<Vec3>;
}

impl SheetModels for TestSheet {
    fn topology(&self) -> Topology {
        let triangles: Vec<_> = self.triangles.iter().map(|t| t.map(PointIndex)).collect();
        Topology::new(self.flat.len(), &triangles)
    }

    fn material(&self) -> Vec<[Vec2; 3]> {
        self.triangles.iter().map(|t| t.map(|i| self.flat[i as usize])).collect()
    }

    fn membrane(&self, stiffness: [f64; 3]) -> Membrane {
        Membrane::from_parts(&self.triangles, &self.material(), stiffness, 0.0)
    }

    fn bending(&self, rigidity: f64) -> Bending {
        Bending::from_parts(&self.topology(), &self.material(), [rigidity; 2], 0.0)
    }

    fn memory(&self) -> RestState {
        RestState::flat(self.topology().hinges.len(), self.triangles.len())
    }

    fn half_clamped(&self, held: &[bool]) -> RestState {
        let mut memory = self.memory();
        memory.stiffness_ratio = self.half_clamp(held);
        memory
    }

    fn mass(&self, density: f64) -> Vec<f64> {
        let mut mass = vec![0.0; self.flat.len()];
        for (t, m) in self.triangles.iter().zip(self.material()) {
            let area = 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs();
            t.iter().for_each(|&i| mass[i as usize] += density * area / 3.0);
        }
        mass
    }

    fn laid(&self) -> Vec<Vec3> {
        self.flat.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect()
    }
}
