//! Preconditioned conjugate gradients for symmetric positive semidefinite matrices, which need not be assembled.

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

/// When conjugate gradients have converged. P is the preconditioner, r the residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ResidualTolerance {
    /// |r| is at most this fraction of the length of the right-hand side [-].
    Length(f64),
    /// r . P r is at most this, in its own unit.
    Energy(f64),
    /// r . P r is at most this fraction of its value at the start [-].
    RelativeEnergy(f64),
}

/// How conjugate gradients ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IterationOutcome {
    /// Number of iterations.
    pub iterations: usize,
    /// Whether the residual is within the tolerance. Otherwise the iterations did not suffice, or a direction had no positive curvature.
    pub converged: bool,
}

/// Preconditioner that divides each unknown by its entry of `diagonal`; unknowns where that is 0 stay.
pub fn by_diagonal<T: Unknown>(diagonal: &[f64]) -> impl Fn(usize, T) -> T {
    |k, r| if diagonal[k] > 0.0 { r.divided(diagonal[k]) } else { T::ZERO }
}

/// Improves the solution `x` of A x = `right` for at most `max_iterations`, or until a direction has no positive curvature. `multiply`
/// writes A times its first argument into the second; `precondition` returns row `k` of P r from row `k` of r. The order of all sums is
/// fixed.
pub fn conjugate_gradients<T: Unknown>(
    x: &mut [T],
    right: &[T],
    multiply: impl Fn(&[T], &mut [T]),
    precondition: impl Fn(usize, T) -> T,
    tolerance: ResidualTolerance,
    max_iterations: usize,
) -> IterationOutcome {
    let dot = |a: &[T], b: &[T]| a.iter().zip(b).map(|(a, b)| a.product(b)).sum::<f64>();
    let mut product = vec![T::ZERO; x.len()];
    multiply(x, &mut product);
    let mut residual: Vec<T> = right.iter().zip(&product).map(|(right, product)| *right - *product).collect();
    let mut z: Vec<T> = residual.iter().enumerate().map(|(k, r)| precondition(k, *r)).collect();
    let mut direction = z.clone();
    let mut rho = dot(&residual, &z);
    let goal = match tolerance {
        ResidualTolerance::Length(fraction) => fraction * fraction * dot(right, right),
        ResidualTolerance::Energy(goal) => goal,
        ResidualTolerance::RelativeEnergy(fraction) => (fraction * rho).max(0.0),
    };
    for iterations in 0..max_iterations {
        let size = match tolerance {
            ResidualTolerance::Length(_) => dot(&residual, &residual),
            ResidualTolerance::Energy(_) | ResidualTolerance::RelativeEnergy(_) => rho,
        };
        if size <= goal {
            return IterationOutcome { iterations, converged: true };
        }
        multiply(&direction, &mut product);
        let curvature = dot(&direction, &product);
        if curvature <= 0.0 || !curvature.is_finite() {
            return IterationOutcome { iterations, converged: false };
        }
        let step = rho / curvature;
        for k in 0..x.len() {
            x[k] = x[k] + direction[k] * step;
            residual[k] = residual[k] - product[k] * step;
            z[k] = precondition(k, residual[k]);
        }
        let next = dot(&residual, &z);
        let beta = next / rho;
        rho = next;
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = *z + *d * beta;
        }
    }
    IterationOutcome { iterations: max_iterations, converged: false }
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
        let tolerance = ResidualTolerance::RelativeEnergy(1e-24);
        let outcome =
            conjugate_gradients(&mut x, &[1.0, 2.0, 0.0], multiply, by_diagonal(&diagonal), tolerance, 10);
        assert_eq!(outcome, IterationOutcome { iterations: 2, converged: true });
        assert!(
            (x[0] - 1.0 / 11.0).abs() < 1e-12 && (x[1] - 7.0 / 11.0).abs() < 1e-12 && x[2] == 7.0,
            "{x:?}"
        );
        let mut v = [Vec3::zeros(); 3];
        let right = [Vec3::new(1.0, 0.0, 2.0), Vec3::new(2.0, 0.0, 4.0), Vec3::zeros()];
        conjugate_gradients(&mut v, &right, multiply, by_diagonal(&diagonal), tolerance, 10);
        assert!((v[1] - Vec3::new(7.0, 0.0, 14.0) / 11.0).norm() < 1e-12, "{v:?}");
    }
}
