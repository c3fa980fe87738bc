//! Least-squares fit of hinge angles to a curvature tensor per triangle.
//!
//! The hinges of a face make its tensor (`solver/energy/bending.rs`),
//!
//! ```text
//! S_f = sum_e phi_e l_e / (2 A_f) t_e t_e^T            t_e: in-plane normal of edge e
//! ```
//!
//! A tensor has three components, and there are half as many hinges as triangle sides. A requested tensor field `W` is
//! therefore met in the least squares,
//!
//! ```text
//! minimise  sum_f A_f |S_f(phi) - W_f|²
//! ```
//!
//! which is the bending energy of the difference. The residual is orthogonal to every tensor field the hinges can make,
//! nearly constant ones among them, so the total angle across a fold is kept. The angle of an open side is free, as in the
//! bending energy. The system is solved by conjugate gradients in a fixed order; for `W` = 0 the answer is exactly 0.

use crate::remesh::carry::surface::GarmentSurface;
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::triangle;
use crease_linear::{ResidualTolerance, by_diagonal, conjugate_gradients};
use nalgebra::{Matrix3, Vector3};

/// A symmetric tensor in a face's own frame, as (xx, yy, sqrt2 xy): its length is the tensor's Frobenius norm.
pub type PlaneTensor = Vector3<f64>;

/// Frame of a triangle: two unit vectors in its plane and the unit normal.
#[derive(Debug, Clone, Copy)]
pub struct FaceFrame {
    /// Direction of the first side.
    pub x: Vec3,
    /// In-plane direction at a right angle to it.
    pub y: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

impl FaceFrame {
    /// The frame of the triangle with these corners; an arbitrary one for a triangle without area.
    pub fn new(corners: &[Vec3; 3]) -> Self {
        let x = (corners[1] - corners[0]).try_normalize(0.0).unwrap_or_else(Vec3::x);
        let normal = triangle::normal(corners).unwrap_or_else(Vec3::z);
        Self { x, y: normal.cross(&x), normal }
    }

    /// In-plane components of `v`.
    pub fn project(&self, v: &Vec3) -> Vec2 {
        Vec2::new(v.dot(&self.x), v.dot(&self.y))
    }
}

/// The tensor t t^T of the in-plane normal t of an edge; zero for an edge without length.
pub fn edge_tensor(edge: &Vec2) -> PlaneTensor {
    match edge.try_normalize(0.0) {
        Some(e) => PlaneTensor::new(e.y * e.y, e.x * e.x, -std::f64::consts::SQRT_2 * e.x * e.y),
        None => PlaneTensor::zeros(),
    }
}

/// Contribution of one face to the normal equations.
struct FaceBlock {
    /// Hinge of every side; `None` for an open side.
    hinges: [Option<u32>; 3],
    /// Gram matrix of the tensors of the sides, times the area.
    gram: Matrix3<f64>,
}

/// Angles [rad], one per hinge of `surface`, that come closest to the tensors `requested` [1/m], one per face in the frame
/// [`FaceFrame::new`] of its corners. Triangles without area request nothing.
pub fn fit_hinge_angles(surface: &GarmentSurface, requested: &[PlaneTensor]) -> Vec<f64> {
    let count = surface.topology.hinges.len();
    let mut faces = Vec::with_capacity(requested.len());
    let mut right = vec![0.0; count];
    let mut diagonal = vec![0.0; count];
    for (f, tensor) in requested.iter().enumerate() {
        let area = 0.5 * surface.normal(f).norm();
        if area <= 0.0 {
            continue;
        }
        let hinges = surface.topology.triangle_edges[f].map(|e| surface.topology.edge_hinge[e as usize]);
        let (columns, tensor) = side_tensors(&surface.corners(f), area, &hinges, *tensor);
        let gram: Matrix3<f64> = columns.transpose() * columns * area;
        let load = columns.transpose() * tensor * area;
        for k in 0..3 {
            let Some(hinge) = hinges[k] else { continue };
            right[hinge as usize] += load[k];
            diagonal[hinge as usize] += gram[(k, k)];
        }
        faces.push(FaceBlock { hinges, gram });
    }
    solve(&faces, &diagonal, &right)
}

/// Per side of a face the tensor that one radian on it makes, as columns, and the tensor requested. Open sides are
/// projected out of both.
fn side_tensors(
    corners: &[Vec3; 3],
    area: f64,
    hinges: &[Option<u32>; 3],
    mut requested: PlaneTensor,
) -> (Matrix3<f64>, PlaneTensor) {
    let frame = FaceFrame::new(corners);
    let column = |k: usize| {
        let edge = frame.project(&(corners[(k + 1) % 3] - corners[k]));
        edge_tensor(&edge) * (edge.norm() / (2.0 * area))
    };
    let mut columns = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    for k in (0..3).filter(|&k| hinges[k].is_none()) {
        let free = columns.column(k).into_owned();
        let length = free.norm_squared();
        if length > 0.0 {
            for j in 0..3 {
                let rest = columns.column(j) - free * (columns.column(j).dot(&free) / length);
                columns.set_column(j, &rest);
            }
            requested -= free * (requested.dot(&free) / length);
        }
        columns.set_column(k, &Vector3::zeros());
    }
    (columns, requested)
}

/// Solves the normal equations by conjugate gradients from zero, with the diagonal as preconditioner.
fn solve(faces: &[FaceBlock], diagonal: &[f64], right: &[f64]) -> Vec<f64> {
    let multiply = |x: &[f64], out: &mut [f64]| {
        out.fill(0.0);
        for face in faces {
            let own = Vector3::from(face.hinges.map(|h| h.map_or(0.0, |h| x[h as usize])));
            let product = face.gram * own;
            for k in 0..3 {
                let Some(hinge) = face.hinges[k] else { continue };
                out[hinge as usize] += product[k];
            }
        }
    };
    let mut x = vec![0.0; right.len()];
    let tolerance =
        ResidualTolerance::RelativeEnergy(TUNING.hinge_fit_residual_tol * TUNING.hinge_fit_residual_tol);
    let max_iterations = TUNING.max_hinge_fit_iterations;
    conjugate_gradients(&mut x, right, multiply, by_diagonal(diagonal), tolerance, max_iterations);
    x
}
