//! Sparse multifrontal Cholesky factorisation, the direct solver of the cloth's systems.
//!
//! The pattern changes whenever contacts appear or vanish, so that the symbolic analysis must be cheap as well: it
//! works on 3 x 3 blocks and sorted lists (`nested_dissection.rs`: the elimination order; `symbolic.rs`: the fronts).
//! The factor is made in single precision first (`numeric.rs`; `dense.rs` wraps faer): half the time, half the memory.
//! Conjugate gradients in double precision with this factor as preconditioner reach the residual tolerance in one to
//! three iterations; if they do not, or if a pivot is not positive, the factor is made again in double precision. The
//! bits of a solution depend neither on the number of threads nor on the buffers kept between factorisations. The same
//! iterations solve a system that has hardly changed with a stale factor ([`Cholesky::solve_with_stale_factor`]).
//! Systems of one number per point, whose axes do not couple, have faer's sparse solver ([`ScalarCholesky`]).

mod dense;
mod nested_dissection;
mod numeric;
mod prefix_sum;
mod real;
mod scalar;
mod symbolic;
#[cfg(test)]
mod tests;
mod trapezoidal_storage;
mod triangular_solve;
mod tuning;
mod vertex_cover;

pub use scalar::ScalarCholesky;

use crate::block_matrix::BlockMatrix;
use crate::cholesky::numeric::Factor;
use crate::cholesky::symbolic::Fronts;
use crate::cholesky::tuning::TUNING;
use crate::vector::{Vec3, dot};
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// Reason why a factorisation failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// The matrix is not positive definite (or not finite).
    NotPositive,
    /// The factor does not fit in memory.
    TooLarge,
}

/// Work of linear solves, independent of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolveCost {
    /// Multiplications of factorisations.
    pub multiplications: f64,
    /// Minimum of bytes moved: every factor written once and read twice by a triangular solve, the matrix read by a
    /// product.
    pub bytes: f64,
}

impl AddAssign for SolveCost {
    fn add_assign(&mut self, other: Self) {
        self.multiplications += other.multiplications;
        self.bytes += other.bytes;
    }
}

/// Size of a factorisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorSize {
    /// Multiplications of the factorisation.
    pub multiplications: f64,
    /// Number of entries of the factor.
    pub entries: usize,
}

/// A factorisation that can be refilled.
#[derive(Default)]
pub struct Cholesky {
    fronts: Fronts,
    /// Pattern to which the fronts belong.
    start: Vec<u32>,
    column: Vec<u32>,
    single: Factor<f32>,
    double: Factor<f64>,
    /// Whether the last factorisation is in `double`, else in `single`.
    in_double: bool,
    /// Number of factorisations still to be made in double precision.
    double_precision_holdoff: u32,
    /// Work since the last call of [`Self::take_cost`].
    cost: SolveCost,
}

impl Cholesky {
    /// Factorises `matrix`. The `positions` of all points [m] determine the elimination order when the pattern is new.
    /// Fails if the matrix is not positive definite or the factor too large.
    pub fn factorise(&mut self, matrix: &BlockMatrix, positions: &[Vec3]) -> Result<(), FactorError> {
        let (start, column) = matrix.pattern();
        if self.start != start || self.column != column {
            self.start.clear();
            self.column.clear();
            self.fronts = Fronts::new(matrix, positions);
            self.start.extend_from_slice(start);
            self.column.extend_from_slice(column);
        }
        if self.fronts.factor_len > TUNING.max_factor_entries {
            return Err(FactorError::TooLarge);
        }
        let is_small = self.fronts.work() < TUNING.direct_double_max_flops;
        self.in_double = self.double_precision_holdoff > 0 || is_small;
        self.double_precision_holdoff = self.double_precision_holdoff.saturating_sub(1);
        if !self.in_double {
            self.cost += self.factor_cost::<f32>();
            if self.single.fill(&self.fronts, matrix).is_ok() {
                return Ok(());
            }
        }
        self.refill_in_double(matrix)
    }

    /// Solves in place for a right-hand side, one entry per row, with the matrix that was factorised last. On failure
    /// the right-hand side is unchanged.
    pub fn solve(&mut self, matrix: &BlockMatrix, rhs: &mut [Vec3]) -> Result<(), FactorError> {
        if !self.in_double {
            let residual_tol = TUNING.refinement.residual_tol;
            let goal = Goal::Residual { max_squared: residual_tol * residual_tol * dot(rhs, rhs) };
            if let Some(x) = self.iterate(matrix, rhs, goal) {
                rhs.copy_from_slice(&x);
                return Ok(());
            }
            self.refill_in_double(matrix)?;
        }
        self.double.solve(&self.fronts, rhs);
        self.cost.bytes += 2.0 * self.factor_cost::<f64>().bytes;
        Ok(())
    }

    /// Returns the work since the last call.
    pub fn take_cost(&mut self) -> SolveCost {
        std::mem::take(&mut self.cost)
    }

    /// Returns the work of one factorisation.
    fn factor_cost<T>(&self) -> SolveCost {
        let bytes = (self.fronts.factor_len * size_of::<T>()) as f64;
        SolveCost { multiplications: self.fronts.work(), bytes }
    }

    /// Exchanges the buffers that are used during a factorisation only.
    pub fn swap_buffers(&mut self, other: &mut Self) {
        self.single.swap_buffers(&mut other.single);
        self.double.swap_buffers(&mut other.double);
    }

    /// Releases a factor that has more than `entries` entries; it cannot be used for solves afterwards.
    pub fn release_if_larger_than(&mut self, entries: usize) {
        self.single.release_if_larger_than(entries);
        self.double.release_if_larger_than(entries);
    }

    /// Size of the last factorisation.
    pub fn size(&self) -> FactorSize {
        FactorSize { multiplications: self.fronts.work(), entries: self.fronts.factor_len }
    }

    /// Whether the last factorisation is in double precision.
    pub fn is_double(&self) -> bool {
        self.in_double
    }

    fn refill_in_double(&mut self, matrix: &BlockMatrix) -> Result<(), FactorError> {
        if !self.in_double {
            self.in_double = true;
            self.double_precision_holdoff = TUNING.double_precision_holdoff;
        }
        self.cost += self.factor_cost::<f64>();
        self.double.fill(&self.fronts, matrix).map_err(|_| FactorError::NotPositive)
    }

    /// Solves in place with the stale factor of an earlier matrix of the same rows, and returns whether it succeeded.
    ///
    /// The iterations minimise the energy 1/2 x·Ax - rhs·x until the decrease that is left, as predicted by the stale
    /// factor, is small relative to the first prediction or to `energy_tol` [J]. Where the first prediction is below
    /// `energy_tol` two iterations suffice, as each decreases the energy. They fail, with the right-hand side
    /// unchanged, where they would take longer than half a factorisation, where a factorisation costs next to nothing,
    /// and, if `strict`, where the first prediction is well above `energy_tol`.
    pub fn solve_with_stale_factor(
        &mut self,
        matrix: &BlockMatrix,
        rhs: &mut [Vec3],
        energy_tol: f64,
        strict: bool,
    ) -> bool {
        if self.in_double {
            return false;
        }
        let solved = self.iterate(matrix, rhs, Goal::Decrease { energy_tol, strict });
        solved.is_some_and(|x| {
            rhs.copy_from_slice(&x);
            true
        })
    }

    /// Conjugate gradients with the single-precision factor as preconditioner; `None` if they miss the goal. Flexible
    /// (Notay 2000), as rounding makes the preconditioner a slightly different one in every iteration.
    fn iterate(&mut self, matrix: &BlockMatrix, rhs: &[Vec3], goal: Goal) -> Option<Vec<Vec3>> {
        let triangular_solve_bytes = 2.0 * self.factor_cost::<f32>().bytes;
        let product_bytes = matrix.bytes();
        let mut x = vec![Vec3::zeros(); rhs.len()];
        let mut r = rhs.to_vec();
        let (mut p, mut image) = (x.clone(), x.clone());
        let mut curvature = 1.0;
        let mut progress = StaleProgress { first: f64::NAN, max_iterations: self.max_stale_iterations() };
        for k in 0..=TUNING.refinement.max_iterations {
            if matches!(goal, Goal::Residual { max_squared } if dot(&r, &r) <= max_squared) {
                return Some(x);
            }
            let mut z = r.clone();
            self.single.solve(&self.fronts, &mut z);
            self.cost.bytes += triangular_solve_bytes;
            if let Goal::Decrease { energy_tol, strict } = goal {
                match progress.judge(k, dot(&r, &z), energy_tol, strict) {
                    StaleVerdict::Converged => return Some(x),
                    StaleVerdict::Failed => return None,
                    StaleVerdict::Continue => {}
                }
            }
            let beta = -dot(&z, &image) / curvature;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + *p * beta);
            matrix.multiply(&p, &mut image);
            self.cost.bytes += product_bytes;
            curvature = dot(&p, &image);
            let alpha = dot(&p, &r) / curvature;
            if !(curvature > 0.0 && alpha.is_finite()) {
                return None;
            }
            for k in 0..r.len() {
                x[k] += p[k] * alpha;
                r[k] -= image[k] * alpha;
            }
        }
        None
    }

    /// Number of iterations with a stale factor that take half as long as a factorisation.
    fn max_stale_iterations(&self) -> f64 {
        let per_iteration = TUNING.refinement.flops_per_entry_budget * self.fronts.factor_len as f64;
        self.fronts.work() / per_iteration
    }
}

/// Goal of the iterations.
#[derive(Clone, Copy)]
enum Goal {
    /// Squared residual.
    Residual { max_squared: f64 },
    /// Predicted decrease that is left, for an energy tolerance [J]; see [`Cholesky::solve_with_stale_factor`].
    Decrease { energy_tol: f64, strict: bool },
}

/// Progress of iterations with a stale factor.
struct StaleProgress {
    /// First predicted decrease [J].
    first: f64,
    /// Number of iterations that are worthwhile.
    max_iterations: f64,
}

/// Decision after an iteration with a stale factor.
enum StaleVerdict {
    Converged,
    Failed,
    Continue,
}

impl StaleProgress {
    /// Decides after `k` iterations with a predicted decrease of `left` [J].
    fn judge(&mut self, k: usize, left: f64, energy_tol: f64, strict: bool) -> StaleVerdict {
        let tuning = &TUNING.refinement;
        let absolute_tol = tuning.stale_energy_fraction * energy_tol;
        if k == 0 {
            self.first = left;
            if strict && left > tuning.strict_energy_factor * energy_tol {
                return StaleVerdict::Failed;
            }
        } else if left <= absolute_tol.max(tuning.stale_rel_tol * self.first)
            || (k == tuning.min_stale_iterations && self.first <= energy_tol)
        {
            return StaleVerdict::Converged;
        }
        let slow = left > self.first * tuning.max_contraction.powi(k as i32 - 1)
            && left > tuning.noise_floor_factor * absolute_tol;
        let over_budget = k > tuning.min_stale_iterations && k as f64 >= self.max_iterations;
        if left.is_nan() || slow || over_budget { StaleVerdict::Failed } else { StaleVerdict::Continue }
    }
}
