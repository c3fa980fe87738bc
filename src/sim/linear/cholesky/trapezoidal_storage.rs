//! The lower part of a dense matrix in one piece of memory: stairs of [`STAIR`] columns, each from the row of its first
//! column down. Of a square little more than half, and to dense kernels each stair is a matrix by columns.

use std::ops::Range;

/// Columns of a stair; a multiple of 3, so that blocks of the cloth lie in one.
pub const STAIR: usize = 192;

/// Numbers of the first `columns` columns of `rows` rows.
pub fn len(rows: usize, columns: usize) -> usize {
    let top = columns - columns % STAIR;
    before(rows, top) + (columns - top) * (rows - top)
}

/// Where row 0 of column `j` would lie in `rows` rows, if its stair began there; the other rows follow.
pub fn row_zero(rows: usize, j: usize) -> usize {
    let top = j - j % STAIR;
    before(rows, top) + (j - top) * (rows - top) - top
}

/// Numbers of all stairs before the one that begins in column `top`: STAIR columns of rows, rows - STAIR, ... each.
fn before(rows: usize, top: usize) -> usize {
    top * rows - top * top.saturating_sub(STAIR) / 2
}

/// Every stair of the first `columns` columns of `rows` rows: the row (and column) it begins in, and where its numbers are.
pub fn ranges(rows: usize, columns: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
    (0..columns).step_by(STAIR).map(move |top| {
        let start = before(rows, top);
        (top, start..start + STAIR.min(columns - top) * (rows - top))
    })
}

/// The same from the stair on that begins in column `first`, whose `numbers` come first.
pub fn each_from<T>(
    mut numbers: &mut [T],
    rows: usize,
    columns: usize,
    first: usize,
) -> impl Iterator<Item = (usize, &mut [T])> {
    ranges(rows, columns).skip(first.div_ceil(STAIR)).map(move |(top, range)| {
        let (stair, rest) = std::mem::take(&mut numbers).split_at_mut(range.len());
        numbers = rest;
        (top, stair)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number has a place of its own, and the stairs are those places.
    #[test]
    fn places_fill_the_memory_in_order() {
        for (rows, columns) in
            [(0, 0), (3, 3), (192, 192), (195, 192), (384, 384), (600, 600), (600, 3), (903, 420)]
        {
            let mut next = 0;
            for j in 0..columns {
                for i in j - j % STAIR..rows {
                    assert_eq!(row_zero(rows, j) + i, next, "row {i} of column {j} of {rows} x {columns}");
                    next += 1;
                }
            }
            assert_eq!(len(rows, columns), next);
            let mut numbers: Vec<usize> = (0..next).collect();
            for (top, range) in ranges(rows, columns) {
                assert_eq!(range.start, row_zero(rows, top) + top);
                let later: Vec<_> = each_from(&mut numbers[range.start..], rows, columns, top).collect();
                assert_eq!((later[0].0, later[0].1[0], later[0].1.len()), (top, range.start, range.len()));
                assert_eq!(later.iter().map(|(_, stair)| stair.len()).sum::<usize>(), next - range.start);
            }
        }
    }
}
