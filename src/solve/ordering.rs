//! Elimination order of the free points: nested dissection by recursive coordinate bisection.
//!
//! Bisection of the *present* positions keeps contact pairs, which are neighbours in space, on one side of a cut;
//! an order from the rest shape makes a folded sheet up to sixty times dearer to factorise (`docs/decisions.md`).

use super::BlockMatrix;
use crate::math::Vec3;

/// Parts of this size are not cut further.
const LEAF: usize = 48;

/// Rows of `matrix` in elimination order, by the present `positions` of all points [m].
pub fn nested_dissection(matrix: &BlockMatrix, positions: &[Vec3]) -> Vec<u32> {
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
    let place: Vec<Vec3> = matrix.gather(positions);
    let mut cut = Cut { start, neighbour, place, side: vec![0; n], next: 1, order: Vec::with_capacity(n) };
    cut.part((0..n as u32).collect());
    cut.order
}

struct Cut {
    start: Vec<u32>,
    neighbour: Vec<u32>,
    place: Vec<Vec3>,
    /// Per row: stamp of the half it was last put in.
    side: Vec<u32>,
    next: u32,
    order: Vec<u32>,
}

impl Cut {
    fn part(&mut self, mut rows: Vec<u32>) {
        if rows.len() <= LEAF {
            self.order.append(&mut rows);
            return;
        }
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for &r in &rows {
            low = low.inf(&self.place[r as usize]);
            high = high.sup(&self.place[r as usize]);
        }
        let axis = (high - low).imax();
        let half = rows.len() / 2;
        let key = |r: &u32| self.place[*r as usize][axis];
        rows.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let mut right = rows.split_off(half);
        // The order inside a half decides ties later: make it independent of the selection's swaps.
        rows.sort_unstable();
        right.sort_unstable();
        let stamp = self.next;
        self.next += 1;
        for &r in &right {
            self.side[r as usize] = stamp;
        }
        let touches = |cut: &Self, r: u32| {
            let (a, b) = (cut.start[r as usize] as usize, cut.start[r as usize + 1] as usize);
            cut.neighbour[a..b].iter().any(|&q| cut.side[q as usize] == stamp)
        };
        let (separator, left): (Vec<u32>, Vec<u32>) = rows.into_iter().partition(|&r| touches(self, r));
        if left.is_empty() {
            // Everything touches everything: no cut helps.
            self.order.extend_from_slice(&right);
            self.order.extend_from_slice(&separator);
            return;
        }
        self.part(left);
        self.part(right);
        self.order.extend_from_slice(&separator);
    }
}
