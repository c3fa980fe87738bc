//! Reference of the direct solver: faer's supernodal sparse factorisation of the scalar matrix, ordered by recursive
//! bisection at the median of the widest axis.

use crease_geometry::math::Vec3;
use crease_linear::BlockMatrix;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// A factorisation that can be repeated for matrices of one pattern.
#[derive(Default)]
pub struct FaerSparse {
    /// Starts of the columns of the upper triangle.
    column_start: Vec<usize>,
    row: Vec<usize>,
    value: Vec<f64>,
    symbolic: Option<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
}

impl FaerSparse {
    /// Factorises `matrix`, after [`Self::analyse`].
    pub fn factorise(&mut self, matrix: &BlockMatrix) {
        self.fill(matrix);
        let symbolic = self.symbolic.as_ref().expect("analysed");
        let n = 3 * matrix.row_count();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row);
        let upper = SparseColMatRef::new(pattern, &self.value[..]);
        let mut memory =
            MemBuffer::new(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()));
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
            .expect("positive definite");
    }

    /// Number of entries of the factor.
    pub fn len(&self) -> usize {
        self.factor.len()
    }

    /// Solves in place for a right-hand side, one vector per block row.
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

    /// Determines the elimination order and the symbolic factorisation.
    pub fn analyse(&mut self, matrix: &BlockMatrix, positions: &[Vec3]) {
        let blocks = matrix.row_count();
        let n = 3 * blocks;
        self.column_start.clear();
        self.row.clear();
        self.column_start.push(0);
        for r in 0..blocks {
            for c in 0..3 {
                for &b in matrix.row(r) {
                    // Only the upper triangle of a diagonal block is stored.
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
        .expect("fits");
        self.symbolic = Some(symbolic);
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

/// Largest number of rows of a part that is not divided.
const MAX_LEAF_ROWS: usize = 48;

/// Rows of `matrix` in elimination order, by the `positions` of all points [m].
fn nested_dissection(matrix: &BlockMatrix, positions: &[Vec3]) -> Vec<u32> {
    let n = matrix.row_count();
    let mut degree = vec![0u32; n + 1];
    for r in 0..n {
        for &c in matrix.row(r).iter().filter(|&&c| c as usize != r) {
            degree[r + 1] += 1;
            degree[c as usize + 1] += 1;
        }
    }
    for r in 0..n {
        degree[r + 1] += degree[r];
    }
    let start = degree;
    let mut fill = start.clone();
    let mut neighbour = vec![0u32; start[n] as usize];
    for r in 0..n {
        for &c in matrix.row(r).iter().filter(|&&c| c as usize != r) {
            for (a, b) in [(r, c), (c as usize, r as u32)] {
                neighbour[fill[a] as usize] = b;
                fill[a] += 1;
            }
        }
    }
    let mut dissection = Dissection {
        start,
        neighbour,
        position: matrix.gather(positions),
        side: vec![0; n],
        next: 1,
        order: Vec::with_capacity(n),
    };
    dissection.divide((0..n as u32).collect());
    dissection.order
}

/// State of the recursive bisection.
struct Dissection {
    /// Start of the neighbours of every row.
    start: Vec<u32>,
    neighbour: Vec<u32>,
    /// Positions, one per row [m].
    position: Vec<Vec3>,
    /// Number of the last half that every row belonged to.
    side: Vec<u32>,
    /// Next number of a half.
    next: u32,
    /// Elimination order so far.
    order: Vec<u32>,
}

impl Dissection {
    /// Appends `rows` to the order: the two halves, then their separator.
    fn divide(&mut self, mut rows: Vec<u32>) {
        if rows.len() <= MAX_LEAF_ROWS {
            self.order.append(&mut rows);
            return;
        }
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for &r in &rows {
            low = low.inf(&self.position[r as usize]);
            high = high.sup(&self.position[r as usize]);
        }
        let axis = (high - low).imax();
        let half = rows.len() / 2;
        let key = |r: &u32| self.position[*r as usize][axis];
        rows.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let mut right = rows.split_off(half);
        // The order within a half decides later ties: it must not depend on the swaps of the selection.
        rows.sort_unstable();
        right.sort_unstable();
        let number = self.next;
        self.next += 1;
        for &r in &right {
            self.side[r as usize] = number;
        }
        let touches = |dissection: &Self, r: u32| {
            let (a, b) = (dissection.start[r as usize] as usize, dissection.start[r as usize + 1] as usize);
            dissection.neighbour[a..b].iter().any(|&q| dissection.side[q as usize] == number)
        };
        let (separator, left): (Vec<u32>, Vec<u32>) = rows.into_iter().partition(|&r| touches(self, r));
        if left.is_empty() {
            // All rows are adjacent to the other half: no separator exists.
            self.order.extend_from_slice(&right);
            self.order.extend_from_slice(&separator);
            return;
        }
        self.divide(left);
        self.divide(right);
        self.order.extend_from_slice(&separator);
    }
}
