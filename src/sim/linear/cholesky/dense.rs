//! Dense kernels inside one front: the one door to faer.
//!
//! A front is stored in stairs of columns. Its own columns are eliminated in panels; what they leave on the boundary is a
//! product. Large products and solves are cut into tiles of fixed size for several threads, and each tile is one call
//! on one thread, so that the bits of the result do not depend on the number of threads.

use crate::sim::linear::cholesky::Real;
use crate::sim::linear::cholesky::trapezoidal_storage;
use crate::sim::linear::cholesky::trapezoidal_storage::STAIR;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::*;
use faer::{Accum, ColMut, ColRef, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns eliminated at a time: products of this depth run at full rate.
const PANEL: usize = 96;
/// Columns of one stripe of a tile's square on the diagonal.
const STRIPE: usize = 48;
/// As many rows of a stair are solved for, or take a product, as one tile.
const ROWS: usize = 192;
/// Columns of one step of a substitution.
const STEP: usize = 48;
/// Products of fewer multiplications are not shared between threads.
const SHARED: usize = 1 << 21;

/// A pivot was not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotPositive;

/// Eliminates the first `own` of the `rows` columns of a symmetric matrix, which are in `panel`, in stairs: Cholesky factor
/// in place.
pub fn eliminate<T: Real>(panel: &mut [T], rows: usize, own: usize) -> Result<(), NotPositive> {
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<T>(PANEL.min(own), Par::Seq, Default::default()));
    for (top, range) in trapezoidal_storage::ranges(rows, own) {
        let (stair, later) = panel[range.start..].split_at_mut(range.len());
        let (tall, wide) = (rows - top, STAIR.min(own - top));
        eliminate_stair(stair, tall, wide, MemStack::new(&mut memory))?;
        let stair = MatRef::from_column_major_slice(stair, tall, wide);
        let multiplications = (own - top - wide) * tall * wide;
        share(
            trapezoidal_storage::each_from(later, rows, own, top + wide),
            multiplications,
            |(at, later)| {
                let (tall, wide) = (rows - at, STAIR.min(own - at));
                let columns = MatMut::from_column_major_slice_mut(later, tall, wide);
                subtract_tile(columns, stair.subrows(at - top, tall), Accum::Add);
            },
        );
    }
    Ok(())
}

/// The same within one stair of `tall` rows and `wide` columns.
fn eliminate_stair<T: Real>(
    stair: &mut [T],
    tall: usize,
    wide: usize,
    memory: &mut MemStack,
) -> Result<(), NotPositive> {
    for from in (0..wide).step_by(PANEL) {
        let width = PANEL.min(wide - from);
        let (done, rest) = stair[from * tall..].split_at_mut(width * tall);
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

/// What the eliminated `panel` (the first `own` of `rows` columns, in stairs) leaves on the boundary: minus its lower part
/// times its transpose, a triangle in stairs. Above the diagonal there is no promise.
pub fn leave<T: Real>(panel: &[T], rows: usize, own: usize, update: &mut [T]) {
    let size = rows - own;
    let tile = |(top, stair): (usize, &mut [T])| {
        let (tall, wide) = (size - top, STAIR.min(size - top));
        let mut columns = MatMut::from_column_major_slice_mut(stair, tall, wide);
        let mut keep = Accum::Replace;
        for (from, range) in trapezoidal_storage::ranges(rows, own) {
            let width = STAIR.min(own - from);
            let factor = MatRef::from_column_major_slice(&panel[range], rows - from, width);
            subtract_tile(columns.rb_mut(), factor.subrows(own - from + top, tall), keep);
            keep = Accum::Add;
        }
    };
    share(trapezoidal_storage::each_from(update, size, size, 0), size * size * own, tile);
}

/// Sets to zero what is too small to matter, before its products become subnormal: those are a hundred times slower.
fn drop_tiny<T: Real>(numbers: &mut [T]) {
    for x in numbers {
        *x = if *x < T::TINY && -*x < T::TINY { T::zero() } else { *x };
    }
}

/// below <- below L^-T
fn solve_below<T: Real>(l: MatRef<T>, below: MatMut<T>) {
    let rows = below.nrows();
    if rows > ROWS && rows * l.nrows() * l.nrows() > SHARED {
        let (top, bottom) = below.split_at_row_mut((rows / 2).next_multiple_of(16));
        rayon::join(|| solve_below(l, top), || solve_below(l, bottom));
    } else if rows > 0 {
        solve_lower_triangular_in_place(l, below.transpose_mut(), Par::Seq);
    }
}

/// columns <- columns - factor across^T
fn subtract_rows<T: Real>(columns: MatMut<T>, factor: MatRef<T>, across: MatRef<T>) {
    let rows = columns.nrows();
    if rows > ROWS && rows * across.nrows() * across.ncols() > SHARED {
        let half = (rows / 2).next_multiple_of(16);
        let (top, bottom) = columns.split_at_row_mut(half);
        let (above, below) = factor.split_at_row(half);
        rayon::join(|| subtract_rows(top, above, across), || subtract_rows(bottom, below, across));
    } else if rows > 0 {
        matmul(columns, Accum::Add, factor, across.transpose(), -T::one(), Par::Seq);
    }
}

/// Does the `work` of every tile of a product of so many multiplications, on all threads where it is large.
fn share<I: Send>(tiles: impl Iterator<Item = I>, multiplications: usize, work: impl Fn(I) + Sync + Send) {
    // Half of them lie above the diagonal.
    if multiplications > 2 * SHARED {
        tiles.collect::<Vec<_>>().into_par_iter().for_each(work);
    } else {
        tiles.for_each(work);
    }
}

/// The first columns of a lower triangle <- (themselves, or 0) - `factor` `factor`^T, the rows of which are theirs.
fn subtract_tile<T: Real>(mut columns: MatMut<T>, factor: MatRef<T>, keep: Accum) {
    let (rows, width) = columns.shape();
    let across = factor.subrows(0, width).transpose();
    // Of the square on the diagonal little more than the half that counts.
    for from in (0..width).step_by(STRIPE) {
        let stripe = STRIPE.min(width - from);
        let square = columns.rb_mut().submatrix_mut(from, from, width - from, stripe);
        let across = across.subcols(from, stripe);
        matmul(square, keep, factor.subrows(from, width - from), across, -T::one(), Par::Seq);
    }
    let below = columns.subrows_mut(width, rows - width);
    matmul(below, keep, factor.subrows(width, rows - width), across, -T::one(), Par::Seq);
}

/// Own part of w <- L^-1 w; the rest of `w`, less what its own part takes from it. Of the factor the `panel` holds the first
/// `own` columns, in stairs.
pub fn forwards<T: Real>(panel: &[T], own: usize, w: &mut [T]) {
    let rows = w.len();
    for (top, range) in trapezoidal_storage::ranges(rows, own) {
        let tall = rows - top;
        for (k, columns) in panel[range].chunks(STEP * tall).enumerate() {
            let (from, width) = (k * STEP, columns.len() / tall);
            let (head, rest) = w[top + from..].split_at_mut(width);
            for (j, column) in columns.chunks_exact(tall).enumerate() {
                let column = &column[from + j..from + width];
                let x = head[j] / column[0];
                head[j] = x;
                head[j + 1..].iter_mut().zip(&column[1..]).for_each(|(w, l)| *w -= *l * x);
            }
            let below = MatRef::from_column_major_slice(columns, tall, width);
            let below = below.subrows(from + width, rest.len());
            let rest = ColMut::from_slice_mut(rest);
            matmul(
                rest.as_mat_mut(),
                Accum::Add,
                below,
                ColRef::from_slice(head).as_mat(),
                -T::one(),
                Par::Seq,
            );
        }
    }
}

/// Own part of w <- L^-T w, the rest being known.
pub fn backwards<T: Real>(panel: &[T], own: usize, w: &mut [T]) {
    let rows = w.len();
    for (top, range) in trapezoidal_storage::ranges(rows, own).collect::<Vec<_>>().into_iter().rev() {
        let tall = rows - top;
        for (k, columns) in panel[range].chunks(STEP * tall).enumerate().rev() {
            let (from, width) = (k * STEP, columns.len() / tall);
            let (head, known) = w[top + from..].split_at_mut(width);
            let below = MatRef::from_column_major_slice(columns, tall, width);
            let below = below.subrows(from + width, known.len());
            let to = ColMut::from_slice_mut(head);
            let known = ColRef::from_slice(known).as_mat();
            matmul(to.as_mat_mut(), Accum::Add, below.transpose(), known, -T::one(), Par::Seq);
            for (j, column) in columns.chunks_exact(tall).enumerate().rev() {
                let column = &column[from + j..from + width];
                let taken =
                    head[j + 1..].iter().zip(&column[1..]).fold(T::zero(), |sum, (w, l)| sum + *w * *l);
                head[j] = (head[j] - taken) / column[0];
            }
        }
    }
}
