//! From a curvature tensor on every triangle to an angle on every hinge.
//!
//! The hinges of a face make its tensor (`energy/bending.rs`),
//!
//! ```text
//! S_f = sum_e phi_e l_e / (2 A_f) t_e t_e^T            t_e: in-plane normal of edge e
//! ```
//!
//! There are three numbers in a tensor and half as many hinges as triangle sides, so a wanted tensor field `W` is met in
//! the least squares,
//!
//! ```text
//! minimise  sum_f A_f |S_f(phi) - W_f|²
//! ```
//!
//! which is the bending energy of the difference: of all angles, those that would take the least torque to be bent to
//! `W`. What is left is orthogonal to every tensor field the hinges can make, constant ones nearly among them; so the
//! total angle across a fold stays. An open side's angle is free, as in the bending energy. Solved by
//! conjugate gradients in a fixed order; for `W` = 0 the answer is exactly 0.

use crate::math::{Vec2, Vec3};
use crate::transfer::GarmentSurface;
use nalgebra::{Matrix3, Vector3};

/// Residual at which the solution stands, relative to the right side. The matrix is well conditioned (3 hinges of one
/// face are independent), so this takes some tens of rounds.
const TOLERANCE: f64 = 1e-10;
const MOST_ROUNDS: usize = 2000;
const NONE: u32 = u32::MAX;

/// A symmetric tensor in a face's own frame, as (xx, yy, sqrt2 xy): its length is the tensor's.
pub(super) type PlaneTensor = Vector3<f64>;

/// Frame of a triangle: two unit vectors in its plane and the unit normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceFrame {
    pub(super) x: Vec3,
    pub(super) y: Vec3,
    pub(super) normal: Vec3,
}

impl FaceFrame {
    /// Of the triangle with these corners; any frame for one without area.
    pub(super) fn of([a, b, c]: &[Vec3; 3]) -> Self {
        let x = (b - a).try_normalize(0.0).unwrap_or_else(Vec3::x);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vec3::z);
        Self { x, y: normal.cross(&x), normal }
    }

    /// `v` in the plane.
    pub(super) fn flat(&self, v: &Vec3) -> Vec2 {
        Vec2::new(v.dot(&self.x), v.dot(&self.y))
    }
}

/// t t^T of the in-plane normal t of an edge; zero for an edge without length.
pub(super) fn across(edge: &Vec2) -> PlaneTensor {
    match edge.try_normalize(0.0) {
        Some(e) => PlaneTensor::new(e.y * e.y, e.x * e.x, -std::f64::consts::SQRT_2 * e.x * e.y),
        None => PlaneTensor::zeros(),
    }
}

/// Angles [rad], one per hinge of `sheet`, that come closest to the tensors `wanted` [1/m], one per face in the frame
/// [`FaceFrame::of`] its corners. Triangles without area want nothing.
pub(super) fn hinge_angles(sheet: &GarmentSurface, wanted: &[PlaneTensor]) -> Vec<f64> {
    let count = sheet.topology.hinges.len();
    let mut faces = Vec::with_capacity(wanted.len());
    let mut right = vec![0.0; count];
    let mut diagonal = vec![0.0; count];
    for (f, want) in wanted.iter().enumerate() {
        let area = 0.5 * sheet.normal(f).norm();
        if area <= 0.0 {
            continue;
        }
        let hinges =
            sheet.topology.triangle_edges[f].map(|e| sheet.topology.edge_hinge[e as usize].unwrap_or(NONE));
        let (columns, want) = columns(&sheet.corners(f), area, &hinges, *want);
        let gram: Matrix3<f64> = columns.transpose() * columns * area;
        let load = columns.transpose() * want * area;
        for k in (0..3).filter(|&k| hinges[k] != NONE) {
            right[hinges[k] as usize] += load[k];
            diagonal[hinges[k] as usize] += gram[(k, k)];
        }
        faces.push((hinges, gram));
    }
    solve(&faces, &diagonal, &right)
}

/// Per side of a face: the tensor that one radian on it makes; open sides are projected out of these and of `want`.
fn columns(
    corners: &[Vec3; 3],
    area: f64,
    hinges: &[u32; 3],
    mut want: PlaneTensor,
) -> (Matrix3<f64>, PlaneTensor) {
    let frame = FaceFrame::of(corners);
    let column = |k: usize| {
        let edge = frame.flat(&(corners[(k + 1) % 3] - corners[k]));
        across(&edge) * (edge.norm() / (2.0 * area))
    };
    let mut columns = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    for k in (0..3).filter(|&k| hinges[k] == NONE) {
        let free = columns.column(k).into_owned();
        let length = free.norm_squared();
        if length > 0.0 {
            for j in 0..3 {
                let rest = columns.column(j) - free * (columns.column(j).dot(&free) / length);
                columns.set_column(j, &rest);
            }
            want -= free * (want.dot(&free) / length);
        }
        columns.set_column(k, &Vector3::zeros());
    }
    (columns, want)
}

/// Conjugate gradients with the diagonal as preconditioner, from zero.
fn solve(faces: &[([u32; 3], Matrix3<f64>)], diagonal: &[f64], right: &[f64]) -> Vec<f64> {
    let multiply = |x: &[f64], out: &mut [f64]| {
        out.fill(0.0);
        for (hinges, gram) in faces {
            let own = Vector3::from(hinges.map(|h| if h == NONE { 0.0 } else { x[h as usize] }));
            let product = gram * own;
            for k in (0..3).filter(|&k| hinges[k] != NONE) {
                out[hinges[k] as usize] += product[k];
            }
        }
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let precondition = |r: &[f64]| -> Vec<f64> {
        r.iter().zip(diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect()
    };
    let mut x = vec![0.0; right.len()];
    let mut residual = right.to_vec();
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut rho = dot(&residual, &z);
    let stop = TOLERANCE * TOLERANCE * rho;
    let mut product = vec![0.0; right.len()];
    for _ in 0..MOST_ROUNDS {
        if rho <= stop || rho <= 0.0 {
            break;
        }
        multiply(&direction, &mut product);
        let curvature = dot(&direction, &product);
        if curvature <= 0.0 {
            break;
        }
        let step = rho / curvature;
        for i in 0..x.len() {
            x[i] += step * direction[i];
            residual[i] -= step * product[i];
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        let turn = next / rho;
        rho = next;
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = z + turn * *d;
        }
    }
    x
}
