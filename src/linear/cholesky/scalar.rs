//! Cholesky factorisation of a sparse matrix of numbers, for systems in which the axes do not couple: faer's, on one thread.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Par, Side};

/// Factor of a positive definite matrix of numbers.
pub struct ScalarCholesky {
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
}

impl ScalarCholesky {
    /// Factorises the matrix of `count` rows whose lower triangle is the sum of `entries` (row, column, value); `None` if it is not
    /// positive definite.
    pub fn new(count: usize, entries: &[(u32, u32, f64)]) -> Option<Self> {
        let triplets: Vec<Triplet<usize, usize, f64>> =
            entries.iter().map(|(r, c, value)| Triplet::new(*r as usize, *c as usize, *value)).collect();
        let matrix = SparseColMat::try_new_from_triplets(count, count, &triplets).ok()?;
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            Default::default(),
        )
        .ok()?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut factor = vec![0.0; symbolic.len_val()];
        symbolic
            .factorize_numeric_llt::<f64>(
                &mut factor,
                matrix.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(scratch)),
                Default::default(),
            )
            .ok()?;
        Some(Self { symbolic, factor })
    }

    /// Solves in place for right-hand sides of one entry per row each, one after the other in `rhs`.
    pub fn solve(&self, rhs: &mut [f64]) {
        let rows = self.symbolic.nrows();
        let columns = rhs.len().checked_div(rows).unwrap_or(0);
        let factor = LltRef::<usize, f64>::new(&self.symbolic, &self.factor);
        let mut memory = MemBuffer::new(factor.solve_in_place_scratch::<f64>(columns, Par::Seq));
        let rhs = MatMut::from_column_major_slice_mut(&mut rhs[..rows * columns], rows, columns);
        factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut memory));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_springs_is_solved() {
        // Unit springs between neighbours of a chain of 50, the first held by another: pulled at its end by 1, point k moves by k + 1.
        let count = 50u32;
        let springs = (1..count).flat_map(|k| [(k, k, 1.0), (k - 1, k - 1, 1.0), (k, k - 1, -1.0)]);
        let entries: Vec<_> = springs.chain([(0, 0, 1.0)]).collect();
        let solver = ScalarCholesky::new(50, &entries).expect("positive");
        let mut rhs = vec![0.0; 100];
        (rhs[49], rhs[99]) = (1.0, -2.0);
        solver.solve(&mut rhs);
        for k in 0..50 {
            let moved = k as f64 + 1.0;
            assert!((rhs[k] - moved).abs() < 1e-9 && (rhs[50 + k] + 2.0 * moved).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_is_refused() {
        assert!(ScalarCholesky::new(2, &[(0, 0, 1.0), (1, 1, 1.0), (1, 0, 2.0)]).is_none());
    }
}
