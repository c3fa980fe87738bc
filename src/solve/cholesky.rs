//! Sparse Cholesky factorisation: the one door to faer.
//!
//! Supernodal (the simplicial one is ten times slower), on one thread (two were slower, and the bits of the result
//! would depend on their number). The symbolic part is kept while the pattern stays.

use super::{BlockMatrix, ordering::nested_dissection};
use crate::math::Vec3;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// A factorisation that can be refilled.
#[derive(Default)]
pub struct Cholesky {
    /// Upper triangle by columns: starts, rows.
    column_start: Vec<usize>,
    row: Vec<usize>,
    value: Vec<f64>,
    symbolic: Option<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
    /// Pattern the symbolic part belongs to.
    pattern: BlockMatrix,
}

/// Why a factorisation failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// The matrix is not positive definite (or not finite).
    NotPositive,
    /// The factor does not fit in memory.
    TooLarge,
}

/// A factor beyond this many numbers (8 bytes each) is refused: 4 GiB.
const LARGEST_FACTOR: usize = 512 << 20;

impl Cholesky {
    /// Factorises `matrix`; `positions` of all points [m] choose the elimination order when the pattern is new.
    pub fn factorise(&mut self, matrix: &BlockMatrix, positions: &[Vec3]) -> Result<(), FactorError> {
        if self.symbolic.is_none() || !self.pattern.same_pattern(matrix) {
            self.analyse(matrix, positions)?;
        }
        self.fill(matrix);
        let Some(symbolic) = &self.symbolic else { return Err(FactorError::TooLarge) };
        let n = 3 * matrix.row_count();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row);
        let upper = SparseColMatRef::new(pattern, &self.value[..]);
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
        self.factor.clear();
        self.factor.resize(symbolic.len_val(), 0.0);
        symbolic
            .factorize_numeric_llt::<f64>(
                &mut self.factor,
                upper,
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| FactorError::NotPositive)
    }

    /// Solves in place for a right-hand side over rows.
    pub fn solve(&self, rhs: &mut [Vec3]) {
        let Some(symbolic) = &self.symbolic else { return };
        let factor = LltRef::<usize, f64>::new(symbolic, &self.factor);
        let n = 3 * rhs.len();
        let mut flat: Vec<f64> = rhs.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
        let mut memory = MemBuffer::new(factor.solve_in_place_scratch::<f64>(1, Par::Seq));
        let column = MatMut::from_column_major_slice_mut(&mut flat, n, 1);
        factor.solve_in_place_with_conj(Conj::No, column, Par::Seq, MemStack::new(&mut memory));
        for (v, f) in rhs.iter_mut().zip(flat.chunks_exact(3)) {
            *v = Vec3::new(f[0], f[1], f[2]);
        }
    }

    fn analyse(&mut self, matrix: &BlockMatrix, positions: &[Vec3]) -> Result<(), FactorError> {
        let blocks = matrix.row_count();
        let n = 3 * blocks;
        self.column_start.clear();
        self.row.clear();
        self.column_start.push(0);
        for r in 0..blocks {
            for c in 0..3 {
                for &b in matrix.row(r) {
                    // The diagonal block gives its upper triangle only.
                    let rows = if b as usize == r { c + 1 } else { 3 };
                    self.row.extend((0..rows).map(|k| 3 * b as usize + k));
                }
                self.column_start.push(self.row.len());
            }
        }
        let order = nested_dissection(matrix, positions);
        let mut forward = Vec::with_capacity(n);
        let mut inverse = vec![0; n];
        for &r in &order {
            for c in 0..3 {
                inverse[3 * r as usize + c] = forward.len();
                forward.push(3 * r as usize + c);
            }
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Upper,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|_| FactorError::TooLarge)?;
        if symbolic.len_val() > LARGEST_FACTOR {
            self.symbolic = None;
            return Err(FactorError::TooLarge);
        }
        self.symbolic = Some(symbolic);
        self.pattern = matrix.clone();
        Ok(())
    }

    fn fill(&mut self, matrix: &BlockMatrix) {
        self.value.clear();
        self.value.reserve(self.row.len());
        for r in 0..matrix.row_count() {
            for c in 0..3 {
                for (&b, block) in matrix.row(r).iter().zip(matrix.blocks(r)) {
                    let rows = if b as usize == r { c + 1 } else { 3 };
                    self.value.extend((0..rows).map(|k| block[(c, k)]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::conjugate_gradient;
    use super::*;
    use crate::energy::BlockSink;
    use crate::math::Mat3;

    /// A chain of points with springs of different strength, points 3 and 7 held.
    fn chain() -> (BlockMatrix, Vec<Vec3>) {
        let n = 200u32;
        let mut next = 0;
        let row_of = (0..n)
            .map(|p| {
                if p == 3 || p == 7 {
                    super::super::block_matrix::HELD
                } else {
                    next += 1;
                    next - 1
                }
            })
            .collect();
        let mut matrix = BlockMatrix::with_pattern(row_of, &mut |visit| {
            (1..n).for_each(|p| visit(&[p - 1, p]));
            (2..n).for_each(|p| visit(&[p, p - 2]));
        });
        for p in 0..n {
            matrix.add_diagonal(p as usize, 10.0 + f64::from(p % 7));
            if p > 0 {
                let skew = Mat3::new(-1.0, 0.3, 0.0, 0.1, -2.0, 0.2, 0.0, 0.4, -0.5);
                matrix.add(p, p - 1, &skew);
            }
        }
        let positions = (0..n).map(|p| Vec3::new(f64::from(p), f64::from(p % 3), 0.0)).collect();
        (matrix, positions)
    }

    #[test]
    fn cholesky_and_conjugate_gradients_solve_the_same_system() {
        let (matrix, positions) = chain();
        let rhs: Vec<Vec3> =
            (0..matrix.row_count()).map(|k| Vec3::new((k as f64).sin(), 1.0, (k as f64).cos())).collect();
        let mut direct = Cholesky::default();
        direct.factorise(&matrix, &positions).unwrap();
        let mut x = rhs.clone();
        direct.solve(&mut x);
        let mut back = vec![Vec3::zeros(); x.len()];
        matrix.multiply(&x, &mut back);
        for (a, b) in back.iter().zip(&rhs) {
            assert!((a - b).amax() < 1e-12);
        }
        let solution = conjugate_gradient(&matrix, &rhs, 1e-12, 1000);
        assert!(solution.converged && solution.iterations > 3);
        for (a, b) in solution.x.iter().zip(&x) {
            assert!((a - b).amax() < 1e-9);
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let (mut matrix, positions) = chain();
        matrix.add_diagonal(50, -100.0);
        assert_eq!(Cholesky::default().factorise(&matrix, &positions), Err(FactorError::NotPositive));
    }
}
