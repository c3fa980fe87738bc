//! Sparse Cholesky factorisation by fronts: the direct solver of the cloth's systems.
//!
//! The pattern changes whenever contacts come or go, so that analysis must be cheap as well: it works on 3 x 3 blocks
//! and sorted lists (`dissection.rs`: the order; `fronts.rs`: the dense matrices). The factor is made in single
//! precision first (`factor.rs`; `dense.rs` is the door to faer): half the time, half the memory. Conjugate gradients
//! in double precision with that factor as preconditioner reach [`TOLERANCE`] in one to three iterations; if they do
//! not, or if a pivot is not positive, the factor is made again in double precision. The bits of a solution depend
//! neither on the number of threads nor on the buffers kept between factorisations. The same iterations solve a system that
//! has hardly changed with the factor of an older one, as far as a direction needs ([`Cholesky::solve_with_older`]).

mod dense;
mod nested_dissection;
mod numeric;
mod symbolic;
#[cfg(test)]
mod tests;
mod trapezoidal_storage;
mod triangular_solve;
mod vertex_cover;

use crate::math::Vec3;
use crate::sim::BlockMatrix;
use crate::sim::linear::cholesky::numeric::Factor;
use crate::sim::linear::cholesky::symbolic::Fronts;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// Why a factorisation failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// The matrix is not positive definite (or not finite).
    NotPositive,
    /// The factor does not fit in memory.
    TooLarge,
}

/// A factor beyond this many numbers is refused: 4 GiB in double precision.
const LARGEST_FACTOR: usize = 512 << 20;
/// Residual of a solution, relative to the right-hand side. Newton's own error is far above it, and a third iteration
/// costs as much as a tenth of a factorisation.
const TOLERANCE: f64 = 1e-8;
/// Iterations after which a factor in single precision is given up.
const MOST_ITERATIONS: usize = 30;
/// Share of what there was to gain that iterations with an older factor may leave.
const LEFT_SHARE: f64 = 1e-3;
/// Share of what was left that each of them may leave, while much is.
const SLOWEST: f64 = 0.3;
/// Up to this many times what may be left in the end the older factor is no judge of single iterations: it takes contacts that
/// have become stiff since for soft, and what is left by its measure goes up and down.
const CLOSE: f64 = 30.0;
/// An iteration takes as long as about so many multiplications of a factorisation for each number of the factor, twice over:
/// all of them together must not take longer than half a factorisation.
const HALF_OF_FACTORISATION: f64 = 200.0;
/// So many are always made, and are enough where there was no more to gain than what counts as converged.
const FEWEST_ITERATIONS: usize = 2;
/// Share of what counts as converged that they may leave.
const LEFT_OPEN: f64 = 0.3;
/// Who is wary of an older factor asks it only where by its measure no more than so many times what counts as converged is to gain.
const NEARLY_THERE: f64 = 3.0;
/// Factorisations of less work (multiplications) are made in double precision at once: they take a millisecond.
const SMALL: f64 = 2e7;
/// Factorisations that stay in double precision after one in single precision was not good enough.
const DOUBT: u32 = 16;

/// The numbers a factor is made of.
trait Real: faer::traits::RealField + Copy + Default {
    /// Numbers of a factor below this are taken for zero, where the largest are about 1e6: products of two such are
    /// still normal numbers.
    const TINY: Self;
    fn from_f64(x: f64) -> Self;
    fn to_f64(self) -> f64;
}

impl Real for f32 {
    const TINY: Self = 2e-13;
    #[inline]
    fn from_f64(x: f64) -> Self {
        x as Self
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.into()
    }
}

impl Real for f64 {
    const TINY: Self = 1e-120;
    #[inline]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}

/// What linear solves took, whatever the machine.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolveCost {
    /// Multiplications of factorisations.
    pub multiplications: f64,
    /// Bytes moved at least: every factor written once and read twice by a substitution, the matrix read by a product.
    pub bytes: f64,
}

impl AddAssign for SolveCost {
    fn add_assign(&mut self, other: Self) {
        self.multiplications += other.multiplications;
        self.bytes += other.bytes;
    }
}

/// A factorisation that can be refilled.
#[derive(Default)]
pub struct Cholesky {
    fronts: Fronts,
    /// Pattern the fronts belong to.
    start: Vec<u32>,
    column: Vec<u32>,
    single: Factor<f32>,
    double: Factor<f64>,
    /// Which of the two holds the last factorisation.
    in_double: bool,
    /// Factorisations still to be made in double precision.
    doubt: u32,
    /// Of what has been done since it was last asked for.
    cost: SolveCost,
}

impl Cholesky {
    /// Factorises `matrix`; `positions` of all points [m] choose the elimination order when the pattern is new.
    pub fn factorise(&mut self, matrix: &BlockMatrix, positions: &[Vec3]) -> Result<(), FactorError> {
        let (start, column) = matrix.pattern();
        if self.start != start || self.column != column {
            self.start.clear();
            self.column.clear();
            self.fronts = Fronts::new(matrix, positions);
            self.start.extend_from_slice(start);
            self.column.extend_from_slice(column);
        }
        if self.fronts.factor_len > LARGEST_FACTOR {
            return Err(FactorError::TooLarge);
        }
        self.in_double = self.doubt > 0 || self.fronts.work() < SMALL;
        self.doubt = self.doubt.saturating_sub(1);
        if !self.in_double {
            self.cost += self.of_factor::<f32>();
            if self.single.fill(&self.fronts, matrix).is_ok() {
                return Ok(());
            }
        }
        self.refill_in_double(matrix)
    }

    /// Solves in place for a right-hand side over rows, with the matrix that was factorised last. After an error the
    /// right-hand side is what it was.
    pub fn solve(&mut self, matrix: &BlockMatrix, rhs: &mut [Vec3]) -> Result<(), FactorError> {
        if !self.in_double {
            let goal = Goal::Residual(TOLERANCE * TOLERANCE * dot(rhs, rhs));
            if let Some(x) = self.iterate(matrix, rhs, goal) {
                rhs.copy_from_slice(&x);
                return Ok(());
            }
            self.refill_in_double(matrix)?;
        }
        self.double.solve(&self.fronts, rhs);
        self.cost.bytes += 2.0 * self.of_factor::<f64>().bytes;
        Ok(())
    }

    /// What has been done since this was last asked for.
    pub fn take_cost(&mut self) -> SolveCost {
        std::mem::take(&mut self.cost)
    }

    /// Of one factorisation.
    fn of_factor<T>(&self) -> SolveCost {
        let bytes = (self.fronts.factor_len * size_of::<T>()) as f64;
        SolveCost { multiplications: self.fronts.work(), bytes }
    }

    /// Exchanges the buffers that are of use during a factorisation only.
    pub fn swap_buffers(&mut self, other: &mut Self) {
        self.single.swap_buffers(&mut other.single);
        self.double.swap_buffers(&mut other.double);
    }

    /// Lets go of a factor of more than so many numbers, which is not asked for again.
    pub fn release_if_larger_than(&mut self, numbers: usize) {
        self.single.let_go_beyond(numbers);
        self.double.let_go_beyond(numbers);
    }

    /// Multiplications of a factorisation, and numbers in its factor.
    pub fn size(&self) -> (f64, usize) {
        (self.fronts.work(), self.fronts.factor_len)
    }

    /// Whether the last factorisation is in double precision.
    pub fn is_double(&self) -> bool {
        self.in_double
    }

    fn refill_in_double(&mut self, matrix: &BlockMatrix) -> Result<(), FactorError> {
        if !self.in_double {
            self.in_double = true;
            self.doubt = DOUBT;
        }
        self.cost += self.of_factor::<f64>();
        self.double.fill(&self.fronts, matrix).map_err(|_| FactorError::NotPositive)
    }

    /// Solves in place with the factor of an older matrix of the same rows: only until what is left to gain of the energy
    /// 1/2 x·Ax - rhs·x, by the measure of that factor, is below a thousandth of the gain at first or three tenths of `enough`
    /// [J], what counts as converged; where no more than `enough` is to gain at first two iterations must do, as all of them gain
    /// something. Where that is not coming in half the time of a factorisation the right-hand side is what it was, and the answer
    /// is no; so it is where a factor costs next to nothing, and, if asked to be `wary`, where more than little is to gain.
    pub fn solve_with_stale_factor(
        &mut self,
        matrix: &BlockMatrix,
        rhs: &mut [Vec3],
        enough: f64,
        wary: bool,
    ) -> bool {
        if self.in_double {
            return false;
        }
        let solved = self.iterate(matrix, rhs, Goal::Gain { enough, wary });
        solved.is_some_and(|x| {
            rhs.copy_from_slice(&x);
            true
        })
    }

    /// Conjugate gradients with the single factor as preconditioner; none if they do not arrive. Flexible (Notay 2000):
    /// rounding makes the preconditioner a slightly different one every time.
    fn iterate(&mut self, matrix: &BlockMatrix, rhs: &[Vec3], goal: Goal) -> Option<Vec<Vec3>> {
        let substitution = 2.0 * self.of_factor::<f32>().bytes;
        let product = matrix.bytes();
        let mut x = vec![Vec3::zeros(); rhs.len()];
        let mut r = rhs.to_vec();
        let (mut p, mut image) = (x.clone(), x.clone());
        let mut curvature = 1.0;
        let mut first = f64::NAN;
        let worth_while = self.fronts.work() / (HALF_OF_FACTORISATION * self.fronts.factor_len as f64);
        for k in 0..=MOST_ITERATIONS {
            if matches!(goal, Goal::Residual(squared) if dot(&r, &r) <= squared) {
                return Some(x);
            }
            let mut z = r.clone();
            self.single.solve(&self.fronts, &mut z);
            self.cost.bytes += substitution;
            if let Goal::Gain { enough, wary } = goal {
                let left = dot(&r, &z);
                let little = LEFT_OPEN * enough;
                if k == 0 {
                    first = left;
                    if wary && first > NEARLY_THERE * enough {
                        return None;
                    }
                } else if left <= little.max(LEFT_SHARE * first)
                    || (k == FEWEST_ITERATIONS && first <= enough)
                {
                    return Some(x);
                }
                let slow = left > first * SLOWEST.powi(k as i32 - 1) && left > CLOSE * little;
                if left.is_nan() || slow || (k > FEWEST_ITERATIONS && k as f64 >= worth_while) {
                    return None;
                }
            }
            let share = -dot(&z, &image) / curvature;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + *p * share);
            matrix.multiply(&p, &mut image);
            self.cost.bytes += product;
            curvature = dot(&p, &image);
            let step = dot(&p, &r) / curvature;
            if !(curvature > 0.0 && step.is_finite()) {
                return None;
            }
            for k in 0..r.len() {
                x[k] += p[k] * step;
                r[k] -= image[k] * step;
            }
        }
        None
    }
}

/// When iterations have arrived.
#[derive(Clone, Copy)]
enum Goal {
    /// At this squared residual.
    Residual(f64),
    /// When little enough of what counts as converged [J] is left to gain; not at all if much is and one is wary.
    Gain { enough: f64, wary: bool },
}

fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Counts -> starts; gives their sum.
fn sum_up(count: &mut [u32]) -> u32 {
    let mut total = 0;
    for c in count {
        total += std::mem::replace(c, total);
    }
    total
}
