//! The lower triangle of a square matrix in one piece of memory: stairs of [`STAIR`] columns, each from the row of its
//! first column down. Little more than half of the square, and to dense kernels each stair is a matrix by columns.

/// Columns of a stair; a multiple of 3, so that blocks of the cloth lie in one.
pub const STAIR: usize = 192;

/// Numbers of a triangle of `size` rows.
pub fn len(size: usize) -> usize {
    row_zero(size, size) + size - size % STAIR
}

/// Where row 0 of column `j` would lie in a triangle of `size` rows, if its stair began there; the other rows follow.
pub fn row_zero(size: usize, j: usize) -> usize {
    let top = j - j % STAIR;
    // The stairs before are STAIR columns of size, size - STAIR, size - 2 STAIR, ... rows.
    let before = top * size - top * top.saturating_sub(STAIR) / 2;
    before + (j - top) * (size - top) - top
}

/// Every stair of a triangle of `size` rows, with the row (and column) it begins in.
pub fn each<T>(mut numbers: &mut [T], size: usize) -> impl Iterator<Item = (usize, &mut [T])> {
    (0..size).step_by(STAIR).map(move |top| {
        let len = STAIR.min(size - top) * (size - top);
        let (stair, rest) = std::mem::take(&mut numbers).split_at_mut(len);
        numbers = rest;
        (top, stair)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of the triangle has a place of its own, and the stairs are those places.
    #[test]
    fn places_fill_the_memory_in_order() {
        for size in [0, 3, 192, 195, 384, 600] {
            let mut next = 0;
            for j in 0..size {
                for i in j - j % STAIR..size {
                    assert_eq!(row_zero(size, j) + i, next, "row {i} of column {j} of {size}");
                    next += 1;
                }
            }
            assert_eq!(len(size), next);
            let mut numbers: Vec<usize> = (0..next).collect();
            let stairs: Vec<_> = each(&mut numbers, size).collect();
            assert_eq!(stairs.iter().map(|(_, stair)| stair.len()).sum::<usize>(), next);
            assert!(stairs.iter().all(|(top, stair)| stair[0] == row_zero(size, *top) + top));
        }
    }
}
