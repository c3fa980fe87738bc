//! Triangular solves with a factor: forward substitution from the leaves to the roots, back substitution from the roots
//! to the leaves.
//!
//! Both read the factor once, one independent subtree per thread. As in the factorisation every sum has a fixed order.

use crate::cholesky::numeric::Factor;
use crate::cholesky::real::Real;
use crate::cholesky::symbolic::{Front, Fronts};
use crate::cholesky::tuning::TUNING;
use crate::cholesky::{dense, trapezoidal_storage};
use crate::vector::Vec3;

impl<T: Real> Factor<T> {
    /// Solves in place for a right-hand side, one entry per row.
    pub fn solve(&self, fronts: &Fronts, rhs: &mut [Vec3]) {
        let largest = rhs.iter().map(|v| v.amax()).fold(0.0, f64::max);
        let unit = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        let scaled = |r: &u32| rhs[*r as usize] / unit;
        let mut x: Vec<T> =
            fronts.order.iter().map(scaled).flat_map(|v| [v.x, v.y, v.z].map(T::from_f64)).collect();
        let solve = Substitution { fronts, entries: &self.entries };
        solve.forest_forwards(&fronts.roots, &mut x);
        solve.forest_backwards(&fronts.roots, &[], &mut x);
        for (&r, x) in fronts.order.iter().zip(x.chunks_exact(3)) {
            rhs[r as usize] = Vec3::new(x[0].to_f64(), x[1].to_f64(), x[2].to_f64()) * (unit * self.scale);
        }
    }
}

struct Substitution<'a, T> {
    fronts: &'a Fronts,
    entries: &'a [T],
}

impl<T: Real> Substitution<'_, T> {
    /// Returns two halves of neighbouring fronts, and the number of entries of the solution that belong to the first.
    fn halves<'f>(&self, fronts: &'f [u32]) -> (&'f [u32], &'f [u32], usize) {
        let (left, right) = fronts.split_at(fronts.len() / 2);
        let start = |v: u32| {
            let first = self.fronts.list[v as usize].first;
            3 * self.fronts.list[first as usize].pivots[0] as usize
        };
        (left, right, start(right[0]) - start(left[0]))
    }

    fn panel(&self, front: &Front) -> &[T] {
        let (pivots, rows) = front.shape();
        &self.entries[front.start..front.start + trapezoidal_storage::len(rows, pivots)]
    }

    /// Computes x <- L^-1 x in the subtrees of neighbouring fronts; returns the change of the update rows of each.
    fn forest_forwards(&self, fronts: &[u32], x: &mut [T]) -> Vec<Vec<T>> {
        match fronts {
            [] => Vec::new(),
            [one] => vec![self.forwards(*one, x)],
            _ => {
                let (left, right, middle) = self.halves(fronts);
                let (low, high) = x.split_at_mut(middle);
                let (mut a, mut b) = join_if(
                    low.len().min(high.len()) > 3 * TUNING.parallel.min_forest_rows,
                    || self.forest_forwards(left, low),
                    || self.forest_forwards(right, high),
                );
                a.append(&mut b);
                a
            }
        }
    }

    fn forwards(&self, v: u32, x: &mut [T]) -> Vec<T> {
        let front = &self.fronts.list[v as usize];
        let (pivots, rows) = front.shape();
        let (below, mine) = x.split_at_mut(x.len() - pivots);
        let children = self.fronts.children_of(front);
        let changes = self.forest_forwards(children, below);
        let mut w = vec![T::zero(); rows];
        w[..pivots].copy_from_slice(mine);
        for (&c, change) in children.iter().zip(&changes) {
            for (&p, from) in self.fronts.extend_add_map(c).iter().zip(change.chunks_exact(3)) {
                w[3 * p as usize..][..3].iter_mut().zip(from).for_each(|(to, from)| *to += *from);
            }
        }
        dense::forwards(self.panel(front), pivots, &mut w);
        mine.copy_from_slice(&w[..pivots]);
        w.split_off(pivots)
    }

    /// Computes x <- L^-T x in the subtrees of neighbouring fronts; `above` is the solution on their parent's rows.
    fn forest_backwards(&self, fronts: &[u32], above: &[T], x: &mut [T]) {
        match fronts {
            [] => {}
            [one] => self.backwards(*one, above, x),
            _ => {
                let (left, right, middle) = self.halves(fronts);
                let (low, high) = x.split_at_mut(middle);
                join_if(
                    low.len().min(high.len()) > 3 * TUNING.parallel.min_forest_rows,
                    || self.forest_backwards(left, above, low),
                    || self.forest_backwards(right, above, high),
                );
            }
        }
    }

    fn backwards(&self, v: u32, above: &[T], x: &mut [T]) {
        let front = &self.fronts.list[v as usize];
        let (pivots, rows) = front.shape();
        let (below, mine) = x.split_at_mut(x.len() - pivots);
        let mut w = Vec::with_capacity(rows);
        w.extend_from_slice(mine);
        for &p in self.fronts.extend_add_map(v) {
            w.extend_from_slice(&above[3 * p as usize..][..3]);
        }
        dense::backwards(self.panel(front), pivots, &mut w);
        mine.copy_from_slice(&w[..pivots]);
        self.forest_backwards(self.fronts.children_of(front), &w, below);
    }
}

/// Computes both, on two threads if `parallel`.
fn join_if<A: Send, B: Send>(
    parallel: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if parallel { rayon::join(a, b) } else { (a(), b()) }
}
