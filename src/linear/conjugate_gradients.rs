//! Conjugate gradients with the diagonal as preconditioner, for normal equations that are not assembled.

use crate::vector::Vec3;
use std::ops::{Add, Mul, Sub};

/// An unknown: a number, or a vector whose components have one matrix.
pub trait Unknown: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {
    /// The zero.
    const ZERO: Self;

    /// The sum of the products of the components.
    fn product(&self, other: &Self) -> f64;

    /// The value divided by `divisor`.
    fn divided(&self, divisor: f64) -> Self;
}

impl Unknown for f64 {
    const ZERO: Self = 0.0;

    fn product(&self, other: &Self) -> f64 {
        self * other
    }

    fn divided(&self, divisor: f64) -> Self {
        self / divisor
    }
}

impl Unknown for Vec3 {
    const ZERO: Self = Vec3::new(0.0, 0.0, 0.0);

    fn product(&self, other: &Self) -> f64 {
        self.dot(other)
    }

    fn divided(&self, divisor: f64) -> Self {
        self / divisor
    }
}

/// Improves the solution `x` of A x = `right` for at most `max_iterations`. `multiply` writes A times its first argument into the
/// second; `diagonal` is that of A, and unknowns where it is 0 stay. It ends when r . D⁻¹ r, with the residual r, is at most the
/// `goal` of its value at the start, or in a direction without curvature. The order of all sums is fixed.
pub fn conjugate_gradients<T: Unknown>(
    x: &mut [T],
    right: &[T],
    diagonal: &[f64],
    multiply: impl Fn(&[T], &mut [T]),
    goal: impl FnOnce(f64) -> f64,
    max_iterations: usize,
) {
    let dot = |a: &[T], b: &[T]| a.iter().zip(b).map(|(a, b)| a.product(b)).sum::<f64>();
    let precondition = |r: &[T]| -> Vec<T> {
        r.iter().zip(diagonal).map(|(r, d)| if *d > 0.0 { r.divided(*d) } else { T::ZERO }).collect()
    };
    let mut product = vec![T::ZERO; x.len()];
    multiply(x, &mut product);
    let mut residual: Vec<T> = right.iter().zip(&product).map(|(right, product)| *right - *product).collect();
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut rho = dot(&residual, &z);
    let goal = goal(rho);
    for _ in 0..max_iterations {
        if rho <= goal || rho <= 0.0 {
            break;
        }
        multiply(&direction, &mut product);
        let curvature = dot(&direction, &product);
        if curvature <= 0.0 {
            break;
        }
        let step = rho / curvature;
        for i in 0..x.len() {
            x[i] = x[i] + direction[i] * step;
            residual[i] = residual[i] - product[i] * step;
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        let beta = next / rho;
        rho = next;
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = *z + *d * beta;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_vectors_are_solved_for() {
        // The matrix [4 1 0; 1 3 0; 0 0 0]: the last unknown is free and stays.
        let diagonal = [4.0, 3.0, 0.0];
        fn multiply<T: Unknown>(x: &[T], out: &mut [T]) {
            out.copy_from_slice(&[x[0] * 4.0 + x[1], x[0] + x[1] * 3.0, T::ZERO]);
        }
        let mut x = [0.0, 0.0, 7.0];
        conjugate_gradients(&mut x, &[1.0, 2.0, 0.0], &diagonal, multiply, |rho| 1e-24 * rho, 10);
        assert!(
            (x[0] - 1.0 / 11.0).abs() < 1e-12 && (x[1] - 7.0 / 11.0).abs() < 1e-12 && x[2] == 7.0,
            "{x:?}"
        );
        let mut v = [Vec3::zeros(); 3];
        let right = [Vec3::new(1.0, 0.0, 2.0), Vec3::new(2.0, 0.0, 4.0), Vec3::zeros()];
        conjugate_gradients(&mut v, &right, &diagonal, multiply, |rho| 1e-24 * rho, 10);
        assert!((v[1] - Vec3::new(7.0, 0.0, 14.0) / 11.0).norm() < 1e-12, "{v:?}");
    }
}
