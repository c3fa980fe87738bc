//! Dense kernels inside one front, by faer.
//!
//! A front is stored in trapezoidal panels of columns. Its pivot columns are eliminated a few at a time; its
//! contribution block is a product. Large products and solves are split into tiles of fixed size for several threads,
//! and each tile is one call on one thread, so that the bits of the result do not depend on the number of threads.

use crate::cholesky::real::Real;
use crate::cholesky::trapezoidal_storage::{PANEL_WIDTH, panels, panels_from};
use crate::cholesky::tuning::{ParallelTuning, TUNING};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::*;
use faer::{Accum, ColMut, ColRef, MatMut, MatRef, Par};
use rayon::prelude::*;

const TILES: ParallelTuning = TUNING.parallel;

/// Error of a pivot that is not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotPositive;

/// Eliminates the first `pivots` of the `rows` columns of a symmetric matrix, which `front` has in panels: the Cholesky
/// factor in place. Fails if a pivot is not positive.
pub fn eliminate<T: Real>(front: &mut [T], rows: usize, pivots: usize) -> Result<(), NotPositive> {
    let width = TILES.columns_per_elimination.min(pivots);
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<T>(width, Par::Seq, Default::default()));
    for (top, range) in panels(rows, pivots) {
        let (panel, later) = front[range.start..].split_at_mut(range.len());
        let (tall, wide) = (rows - top, PANEL_WIDTH.min(pivots - top));
        eliminate_panel(panel, tall, wide, MemStack::new(&mut memory))?;
        let panel = MatRef::from_column_major_slice(panel, tall, wide);
        let multiplications = (pivots - top - wide) * tall * wide;
        let later_panels = panels_from(later, rows, pivots, top + wide);
        for_each_tile(later_panels, multiplications, |(at, later)| {
            let (tall, wide) = (rows - at, PANEL_WIDTH.min(pivots - at));
            let columns = MatMut::from_column_major_slice_mut(later, tall, wide);
            subtract_tile(columns, panel.subrows(at - top, tall), Accum::Add);
        });
    }
    Ok(())
}

/// Eliminates the columns of one panel of `tall` rows and `wide` columns.
fn eliminate_panel<T: Real>(
    panel: &mut [T],
    tall: usize,
    wide: usize,
    memory: &mut MemStack,
) -> Result<(), NotPositive> {
    for from in (0..wide).step_by(TILES.columns_per_elimination) {
        let width = TILES.columns_per_elimination.min(wide - from);
        let (done, rest) = panel[from * tall..].split_at_mut(width * tall);
        drop_tiny(done);
        let columns = MatMut::from_column_major_slice_mut(done, tall, width).subrows_mut(from, tall - from);
        let (mut diagonal, below) = columns.split_at_row_mut(width);
        cholesky_in_place(diagonal.rb_mut(), Default::default(), Par::Seq, memory, Default::default())
            .map_err(|_| NotPositive)?;
        solve_below(diagonal.rb(), below);
        drop_tiny(done);
        let next = from + width;
        if next < wide {
            let done = MatRef::from_column_major_slice(done, tall, width).subrows(next, tall - next);
            let rest = MatMut::from_column_major_slice_mut(rest, tall, wide - next);
            subtract_rows(rest.subrows_mut(next, tall - next), done, done.subrows(0, wide - next));
        }
    }
    Ok(())
}

/// Computes the contribution block of an eliminated `front` (the first `pivots` of `rows` columns, in panels): minus
/// its lower part times its transpose, a triangle in panels. Entries above the diagonal are undefined.
pub fn contribution_block<T: Real>(front: &[T], rows: usize, pivots: usize, update: &mut [T]) {
    let size = rows - pivots;
    let tile = |(top, panel): (usize, &mut [T])| {
        let (tall, wide) = (size - top, PANEL_WIDTH.min(size - top));
        let mut columns = MatMut::from_column_major_slice_mut(panel, tall, wide);
        let mut keep = Accum::Replace;
        for (from, range) in panels(rows, pivots) {
            let width = PANEL_WIDTH.min(pivots - from);
            let factor = MatRef::from_column_major_slice(&front[range], rows - from, width);
            subtract_tile(columns.rb_mut(), factor.subrows(pivots - from + top, tall), keep);
            keep = Accum::Add;
        }
    };
    for_each_tile(panels_from(update, size, size, 0), size * size * pivots, tile);
}

/// Sets negligible entries to zero before their products become subnormal, which are a hundred times slower.
fn drop_tiny<T: Real>(entries: &mut [T]) {
    for x in entries {
        *x = if *x < T::TINY && -*x < T::TINY { T::zero() } else { *x };
    }
}

/// Computes below <- below L^-T.
fn solve_below<T: Real>(l: MatRef<T>, below: MatMut<T>) {
    let rows = below.nrows();
    if rows > TILES.max_tile_rows && rows * l.nrows() * l.nrows() > TILES.min_product_flops {
        let (top, bottom) = below.split_at_row_mut((rows / 2).next_multiple_of(16));
        rayon::join(|| solve_below(l, top), || solve_below(l, bottom));
    } else if rows > 0 {
        solve_lower_triangular_in_place(l, below.transpose_mut(), Par::Seq);
    }
}

/// Computes columns <- columns - factor across^T.
fn subtract_rows<T: Real>(columns: MatMut<T>, factor: MatRef<T>, across: MatRef<T>) {
    let rows = columns.nrows();
    if rows > TILES.max_tile_rows && rows * across.nrows() * across.ncols() > TILES.min_product_flops {
        let half = (rows / 2).next_multiple_of(16);
        let (top, bottom) = columns.split_at_row_mut(half);
        let (above, below) = factor.split_at_row(half);
        rayon::join(|| subtract_rows(top, above, across), || subtract_rows(bottom, below, across));
    } else if rows > 0 {
        matmul(columns, Accum::Add, factor, across.transpose(), -T::one(), Par::Seq);
    }
}

/// Calls `work` for every tile of a product of `multiplications`, on all threads where these are many.
fn for_each_tile<I: Send>(
    tiles: impl Iterator<Item = I>,
    multiplications: usize,
    work: impl Fn(I) + Sync + Send,
) {
    // Half of the multiplications are above the diagonal.
    if multiplications > 2 * TILES.min_product_flops {
        tiles.collect::<Vec<_>>().into_par_iter().for_each(work);
    } else {
        tiles.for_each(work);
    }
}

/// Computes the first columns of a lower triangle <- (themselves, or 0) - `factor` `factor`^T for the same rows.
fn subtract_tile<T: Real>(mut columns: MatMut<T>, factor: MatRef<T>, keep: Accum) {
    let (rows, width) = columns.shape();
    let across = factor.subrows(0, width).transpose();
    // Of the square on the diagonal little more than the lower half is computed.
    for from in (0..width).step_by(TILES.columns_per_stripe) {
        let stripe = TILES.columns_per_stripe.min(width - from);
        let square = columns.rb_mut().submatrix_mut(from, from, width - from, stripe);
        let across = across.subcols(from, stripe);
        matmul(square, keep, factor.subrows(from, width - from), across, -T::one(), Par::Seq);
    }
    let below = columns.subrows_mut(width, rows - width);
    matmul(below, keep, factor.subrows(width, rows - width), across, -T::one(), Par::Seq);
}

/// Forward substitution w <- L^-1 w for the pivots, with its update of the other rows of `w`. `front` has the first
/// `pivots` columns of the factor in panels.
pub fn forwards<T: Real>(front: &[T], pivots: usize, w: &mut [T]) {
    let rows = w.len();
    for (top, range) in panels(rows, pivots) {
        let tall = rows - top;
        for (k, columns) in front[range].chunks(TILES.columns_per_substitution * tall).enumerate() {
            let (from, width) = (k * TILES.columns_per_substitution, columns.len() / tall);
            let (head, rest) = w[top + from..].split_at_mut(width);
            for (j, column) in columns.chunks_exact(tall).enumerate() {
                let column = &column[from + j..from + width];
                let x = head[j] / column[0];
                head[j] = x;
                head[j + 1..].iter_mut().zip(&column[1..]).for_each(|(w, l)| *w -= *l * x);
            }
            let below = MatRef::from_column_major_slice(columns, tall, width);
            let below = below.subrows(from + width, rest.len());
            let rest = ColMut::from_slice_mut(rest).as_mat_mut();
            matmul(rest, Accum::Add, below, ColRef::from_slice(head).as_mat(), -T::one(), Par::Seq);
        }
    }
}

/// Back substitution w <- L^-T w for the pivots, with the other rows of `w` known.
pub fn backwards<T: Real>(front: &[T], pivots: usize, w: &mut [T]) {
    let rows = w.len();
    for (top, range) in panels(rows, pivots).collect::<Vec<_>>().into_iter().rev() {
        let tall = rows - top;
        for (k, columns) in front[range].chunks(TILES.columns_per_substitution * tall).enumerate().rev() {
            let (from, width) = (k * TILES.columns_per_substitution, columns.len() / tall);
            let (head, known) = w[top + from..].split_at_mut(width);
            let below = MatRef::from_column_major_slice(columns, tall, width);
            let below = below.subrows(from + width, known.len());
            let to = ColMut::from_slice_mut(head);
            let known = ColRef::from_slice(known).as_mat();
            matmul(to.as_mat_mut(), Accum::Add, below.transpose(), known, -T::one(), Par::Seq);
            for (j, column) in columns.chunks_exact(tall).enumerate().rev() {
                let column = &column[from + j..from + width];
                let sum = head[j + 1..].iter().zip(&column[1..]).fold(T::zero(), |sum, (w, l)| sum + *w * *l);
                head[j] = (head[j] - sum) / column[0];
            }
        }
    }
}
