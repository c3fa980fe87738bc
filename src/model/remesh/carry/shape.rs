//! Shapes of a simulation mesh carried to the garment that lies on it.
//!
//! The edges of the mesh are chords of the garment's surface: wrinkles of the source pose that are finer than they stay beside it.
//! What lies between a point of the garment and its place on the mesh is carried along, turned as the mesh turns there.
//!
//! A crease between the points of the garment cannot be read off at them: one would lie on its ridge, the next beside it, and the ridge
//! would be a row of teeth. The displacement is projected instead: of all fields that are linear on the triangles of the garment, the
//! one that differs least from it over the surface,
//!
//! ```text
//! minimise  sum_f integral over f of |sum_p w_p D_p - d|²  +  k sum_h A_h |s_h - R_h s'_h|²
//!
//! d: displacement of the surface, D_p: of the point p
//! s_h, s'_h: kink of shape and source pose at hinge h of the area A_h (a third of its triangles), as a displacement at their height
//! R_h: rotation of the surface there
//! ```
//!
//! integrated by samples and solved by conjugate gradients. The kinks spread a crease that runs across the triangles over some of
//! them, so that its ridge is straight. A motion of the whole garment comes out as it is, and so does the volume under the surface.

use crate::garment::Garment;
use crate::remesh::tuning::TUNING;
use crate::remesh::{SimulationMesh, SurfaceFinder, SurfacePoint, interpolate};
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::triangle::{self, nearest_corner, sample_weights};
use crease_geometry::mesh::{Hinge, PointIndex, point_rotations, turned};
use crease_linear::{ResidualTolerance, by_diagonal, conjugate_gradients};
use rayon::prelude::*;

impl SimulationMesh {
    /// Positions of the points of the `source` garment with the points of the mesh at `shape`. In the source pose they are its own.
    pub fn carry(&self, source: &Garment, shape: &[Vec3]) -> Vec<Vec3> {
        if self.is_source {
            return shape.to_vec();
        }
        let carried = Carried {
            mesh: self,
            shape,
            rotations: point_rotations(&self.garment.points, &self.garment.triangles, shape),
        };
        let at_points = source.points.iter().zip(&self.source_location);
        let read_off: Vec<Vec3> = at_points.map(|(x, at)| carried.displacement(x, at)).collect();
        let projected = Projection::new(&carried, source).solve(read_off);
        source.points.iter().zip(&projected).map(|(x, d)| x + d).collect()
    }
}

/// A shape of a simulation mesh.
struct Carried<'a> {
    mesh: &'a SimulationMesh,
    /// Positions of the points of the mesh [m].
    shape: &'a [Vec3],
    /// Rotations of the mesh, one per point.
    rotations: Vec<Mat3>,
}

impl Carried<'_> {
    /// Displacement [m] of the place `x` of the source surface, which is at the place `at` of the mesh or beside it.
    fn displacement(&self, x: &Vec3, at: &SurfacePoint) -> Vec3 {
        let garment = &self.mesh.garment;
        let [from, to] =
            [&garment.points[..], self.shape].map(|points| interpolate(points, &garment.triangles, at));
        let corners = &garment.triangles[at.face as usize];
        to - x + turned(&self.rotations, corners, &at.weights, &(x - from))
    }
}

/// Normal equations of the projection.
struct Projection<'a> {
    triangles: &'a [[PointIndex; 3]],
    /// Per triangle: integrals of the products of the weights of its corners [m²].
    mass: Vec<Mat3>,
    /// Kinks at the hinges.
    kinks: Vec<Kink>,
    /// Per point: integral of its weight times the displacement [m³].
    right: Vec<Vec3>,
}

/// Kink of a linear field at a hinge: the sum of its slopes away from the edge on both sides, times a height of the triangles, as a
/// combination of the values at the four points.
struct Kink {
    points: [PointIndex; 4],
    /// Factors of the values [-].
    factors: [f64; 4],
    /// Weight of the square of the kink [m²].
    weight: f64,
}

impl Kink {
    /// The kink at `hinge` of triangles over `points` [m]; none beside a triangle without area.
    fn new(hinge: &Hinge, points: &[Vec3]) -> Option<Self> {
        let [a, b, c, d] = hinge.points.map(|p| points[p.at()]);
        let edge = b - a;
        let length = edge.norm();
        let [(t, height), (s, other)] =
            [c, d].map(|x| ((x - a).dot(&edge) / (length * length), (x - a).cross(&edge).norm() / length));
        let scale = height.min(other);
        if scale.is_nan() || scale <= 0.0 {
            return None;
        }
        let (p, q) = (scale / height, scale / other);
        Some(Self {
            points: hinge.points,
            factors: [-(1.0 - t) * p - (1.0 - s) * q, -t * p - s * q, p, q],
            weight: TUNING.kink_weight * length * (height + other) / 6.0,
        })
    }

    /// Adds the load of a `kink` [m] to the points, one entry per point [m³].
    fn add(&self, kink: &Vec3, out: &mut [Vec3]) {
        (0..4).for_each(|k| out[self.points[k].at()] += kink * (self.weight * self.factors[k]));
    }

    /// The kink of the field `x` [m].
    fn of(&self, x: &[Vec3]) -> Vec3 {
        (0..4).map(|k| x[self.points[k].at()] * self.factors[k]).sum()
    }
}

impl<'a> Projection<'a> {
    /// The projection of the displacement of `carried` onto the triangles of `source`.
    fn new(carried: &Carried, source: &'a Garment) -> Self {
        let mesh = carried.mesh;
        let finder = SurfaceFinder::new(&mesh.garment);
        let of_triangle = |t: &[PointIndex; 3]| {
            let x = triangle::corners(&source.points, t);
            let start = t.map(|p| mesh.source_location[p.at()].face);
            let parts = TUNING.projection_parts;
            let area = triangle::area(&x) / f64::from(parts * parts);
            let (mut mass, mut right) = (Mat3::zeros(), Mat3::zeros());
            for weights in sample_weights(parts) {
                let place = x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2];
                let at = finder.locate(start[nearest_corner(&weights)], &place);
                let w = Vec3::from(weights);
                mass += w * w.transpose() * area;
                right += carried.displacement(&place, &at) * w.transpose() * area;
            }
            (mass, right)
        };
        let found: Vec<(Mat3, Mat3)> = source.triangles.par_iter().map(of_triangle).collect();
        let mut right = vec![Vec3::zeros(); source.points.len()];
        for (t, (_, of_corners)) in source.triangles.iter().zip(&found) {
            (0..3).for_each(|k| right[t[k].at()] += of_corners.column(k));
        }
        let kinks: Vec<Kink> =
            source.topology.hinges.iter().filter_map(|hinge| Kink::new(hinge, &source.points)).collect();
        for kink in &kinks {
            let before = kink.of(&source.points);
            let turn = |p: PointIndex| {
                let SurfacePoint { face, weights } = &mesh.source_location[p.at()];
                turned(&carried.rotations, &mesh.garment.triangles[*face as usize], weights, &before)
            };
            let change = (turn(kink.points[0]) + turn(kink.points[1])) / 2.0 - before;
            kink.add(&change, &mut right);
        }
        Self {
            kinks,
            triangles: &source.triangles,
            mass: found.into_iter().map(|(mass, _)| mass).collect(),
            right,
        }
    }

    /// Solves by conjugate gradients from `x` [m], with the diagonal as preconditioner. Points without a triangle stay.
    fn solve(&self, mut x: Vec<Vec3>) -> Vec<Vec3> {
        let mut diagonal = vec![0.0; x.len()];
        for (t, mass) in self.triangles.iter().zip(&self.mass) {
            (0..3).for_each(|k| diagonal[t[k].at()] += mass[(k, k)]);
        }
        for kink in &self.kinks {
            (0..4).for_each(|k| {
                diagonal[kink.points[k].at()] += kink.weight * kink.factors[k] * kink.factors[k]
            });
        }
        let multiply = |x: &[Vec3], out: &mut [Vec3]| {
            out.fill(Vec3::zeros());
            for (t, mass) in self.triangles.iter().zip(&self.mass) {
                for k in 0..3 {
                    out[t[k].at()] += (0..3).map(|j| x[t[j].at()] * mass[(k, j)]).sum::<Vec3>();
                }
            }
            self.kinks.iter().for_each(|kink| kink.add(&kink.of(x), out));
        };
        let area: f64 = diagonal.iter().sum();
        let tolerance = ResidualTolerance::Energy(TUNING.projection_tol * TUNING.projection_tol * area);
        let max_iterations = TUNING.max_projection_iterations;
        conjugate_gradients(&mut x, &self.right, multiply, by_diagonal(&diagonal), tolerance, max_iterations);
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::Garment;
    use crate::remesh::simulation_mesh::tests::sheet;
    use crate::remesh::{Curve, Seed, SizeField, SurfaceMesh, improve};
    use crease_geometry::mesh::{Hinge, hinge_angle};
    use nalgebra::Rotation3;

    /// A sheet with wrinkles 30 mm apart and 2 mm high, and a mesh of edges of 40 mm on it.
    fn wrinkled() -> (Garment, SimulationMesh) {
        let mut sheet = sheet(0.005, 1.0);
        sheet.points.iter_mut().for_each(|x| x.y += 0.002 * (x.x * std::f64::consts::TAU / 0.03).sin());
        let mut mesh = SurfaceMesh::new(&sheet);
        improve(&mut mesh, &SizeField::new(&[], 0.04, 1.0, 0.04));
        let mesh = mesh.finish();
        (sheet, mesh)
    }

    fn angles(garment: &Garment, x: &[Vec3]) -> Vec<f64> {
        let of = |h: &Hinge| hinge_angle(&h.points.map(|p| x[p.at()]));
        garment.topology.hinges.iter().map(of).collect()
    }

    #[test]
    fn wrinkles_finer_than_the_mesh_stay() {
        let (sheet, mesh) = wrinkled();
        assert!(mesh.garment.points.len() < sheet.points.len() / 8, "{}", mesh.garment.points.len());
        let source = angles(&sheet, &sheet.points);
        let bent = source.iter().filter(|a| a.abs() > 0.2).count();
        assert!(bent > source.len() / 10, "{bent} of {}", source.len());
        // In place, to the last bits; turned as a whole, with the same angles.
        let still = mesh.carry(&sheet, &mesh.garment.points);
        assert!(still.iter().zip(&sheet.points).all(|(a, b)| (a - b).norm() < 1e-12));
        let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.0);
        let shape: Vec<Vec3> = mesh.garment.points.iter().map(|x| turn * x).collect();
        let turned = angles(&sheet, &mesh.carry(&sheet, &shape));
        assert!(turned.iter().zip(&source).all(|(a, b)| (a - b).abs() < 1e-9));
        // On a cylinder of 0.2 m all but a few hinges change by what the cylinder bends them.
        let roll = |x: &Vec3| {
            let (sin, cos) = (x.x / 0.2).sin_cos();
            Vec3::new((0.2 + x.y) * sin, (0.2 + x.y) * cos, x.z)
        };
        let shape: Vec<Vec3> = mesh.garment.points.iter().map(roll).collect();
        let rolled = angles(&sheet, &mesh.carry(&sheet, &shape));
        let moved = rolled.iter().zip(&source).filter(|(a, b)| (**a - **b).abs() > 0.15).count();
        assert!(moved < source.len() / 50, "{moved} of {}", source.len());
    }

    /// A sheet with edges of 20 mm, a mesh with a line that runs across them, and the mesh folded along it like a roof.
    fn roof() -> (Garment, SimulationMesh, Vec<Vec3>) {
        let sheet = sheet(0.02, 1.0);
        let beside = |x: &Vec3| x.x - 0.13 - 0.2 * x.z;
        let mut mesh = SurfaceMesh::new(&sheet);
        let mut level: Vec<f64> = mesh.x.iter().map(beside).collect();
        mesh.cut(&mut level);
        let mut seeds = Vec::new();
        for [a, b] in mesh.edges_on_line(&level) {
            mesh.draw(a, b, Curve::Line(0));
            seeds.extend(Seed::along(mesh.x[a as usize], mesh.x[b as usize], 0.012));
        }
        improve(&mut mesh, &SizeField::new(&seeds, 0.012, 1.0, 0.02));
        let mesh = mesh.finish();
        let lifted = |x: &Vec3| x + Vec3::y() * (0.05 - 0.5 * beside(x).abs());
        let shape = mesh.garment.points.iter().map(lifted).collect();
        (sheet, mesh, shape)
    }

    /// Volume under the points `x` of `garment` [m³].
    fn volume(garment: &Garment, x: &[Vec3]) -> f64 {
        let under = |t: &[PointIndex; 3]| {
            let height = (0..3).map(|k| x[t[k].at()].y).sum::<f64>() / 3.0;
            triangle::area(&triangle::corners(&garment.points, t)) * height
        };
        garment.triangles.iter().map(under).sum()
    }

    /// Root mean square deviation [m] of the ridge of the roof from its mean height, away from borders.
    fn teeth(garment: &Garment, x: &[Vec3]) -> f64 {
        let finder = SurfaceFinder::new(garment);
        let height = |z: f64| {
            let at = finder.locate(0, &Vec3::new(0.13 + 0.2 * z, 0.0, z));
            interpolate(x, &garment.triangles, &at).y
        };
        let heights: Vec<f64> = (40..160).map(|k| height(1e-3 * f64::from(k))).collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / heights.len() as f64).sqrt()
    }

    #[test]
    fn a_crease_across_the_triangles_of_the_garment_is_straight() {
        let (sheet, mesh, shape) = roof();
        let [read, carried] = [mesh.to_source(&shape), mesh.carry(&sheet, &shape)];
        let [exact, of_read, of_carried] =
            [volume(&mesh.garment, &shape), volume(&sheet, &read), volume(&sheet, &carried)];
        assert!((of_carried / exact - 1.0).abs() < 5e-4, "{of_carried} of {exact}");
        assert!((of_read / exact - 1.0).abs() > 2e-3, "{of_read} of {exact}");
        let [of_read, of_carried] = [teeth(&sheet, &read), teeth(&sheet, &carried)];
        assert!(of_carried < 0.65 * of_read, "{of_carried} and {of_read} m");
    }
}
