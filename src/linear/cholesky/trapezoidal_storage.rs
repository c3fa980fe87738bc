//! Packed storage of the lower trapezoid of a dense matrix: panels of [`PANEL_WIDTH`] columns, each from the row of its
//! first column down. Of a square it takes little more than half, and each panel is a column-major matrix for dense
//! kernels.

use std::ops::Range;

/// Number of columns of a panel; a multiple of 3, so that a block of the cloth lies in one panel.
pub const PANEL_WIDTH: usize = 192;

/// Number of entries of the first `columns` columns of `rows` rows.
pub fn len(rows: usize, columns: usize) -> usize {
    let top = columns - columns % PANEL_WIDTH;
    panel_offset(rows, top) + (columns - top) * (rows - top)
}

/// Returns the index that row 0 of column `j` of `rows` rows would have if its panel began there; row i is i further.
pub fn column_offset(rows: usize, j: usize) -> usize {
    let top = j - j % PANEL_WIDTH;
    panel_offset(rows, top) + (j - top) * (rows - top) - top
}

/// Returns the number of entries before the panel that begins in column `top`: PANEL_WIDTH columns of rows, rows -
/// PANEL_WIDTH, ... each.
fn panel_offset(rows: usize, top: usize) -> usize {
    top * rows - top * top.saturating_sub(PANEL_WIDTH) / 2
}

/// Returns every panel of the first `columns` columns of `rows` rows: its first row (and column), and the range of its
/// entries.
pub fn panels(rows: usize, columns: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
    (0..columns).step_by(PANEL_WIDTH).map(move |top| {
        let start = panel_offset(rows, top);
        (top, start..start + PANEL_WIDTH.min(columns - top) * (rows - top))
    })
}

/// Returns the panels from the one that begins in column `first` on, whose entries are the first of `entries`.
pub fn panels_from<T>(
    mut entries: &mut [T],
    rows: usize,
    columns: usize,
    first: usize,
) -> impl Iterator<Item = (usize, &mut [T])> {
    panels(rows, columns).skip(first.div_ceil(PANEL_WIDTH)).map(move |(top, range)| {
        let (panel, rest) = std::mem::take(&mut entries).split_at_mut(range.len());
        entries = rest;
        (top, panel)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries are contiguous, and the panels are ranges of them.
    #[test]
    fn entries_are_contiguous() {
        for (rows, columns) in
            [(0, 0), (3, 3), (192, 192), (195, 192), (384, 384), (600, 600), (600, 3), (903, 420)]
        {
            let mut next = 0;
            for j in 0..columns {
                for i in j - j % PANEL_WIDTH..rows {
                    let index = column_offset(rows, j) + i;
                    assert_eq!(index, next, "row {i} of column {j} of {rows} x {columns}");
                    next += 1;
                }
            }
            assert_eq!(len(rows, columns), next);
            let mut entries: Vec<usize> = (0..next).collect();
            for (top, range) in panels(rows, columns) {
                assert_eq!(range.start, column_offset(rows, top) + top);
                let later: Vec<_> = panels_from(&mut entries[range.start..], rows, columns, top).collect();
                assert_eq!((later[0].0, later[0].1[0], later[0].1.len()), (top, range.start, range.len()));
                assert_eq!(later.iter().map(|(_, panel)| panel.len()).sum::<usize>(), next - range.start);
            }
        }
    }
}
