//! Substitution with a factor: forwards from the leaves to the roots, backwards from the roots to the leaves.
//!
//! Both stream the factor through memory once, one independent subtree per thread. As in the factorisation every sum
//! has its fixed order.

use crate::math::Vec3;
use crate::sim::linear::cholesky::numeric::Factor;
use crate::sim::linear::cholesky::symbolic::{Front, Fronts};
use crate::sim::linear::cholesky::{Real, dense, trapezoidal_storage};

/// Subtrees of less than this many rows are not shared between threads.
const SHARED: usize = 400;

impl<T: Real> Factor<T> {
    /// Solves in place for a right-hand side over rows.
    pub fn solve(&self, fronts: &Fronts, rhs: &mut [Vec3]) {
        let largest = rhs.iter().map(|v| v.amax()).fold(0.0, f64::max);
        let unit = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        let scaled = |r: &u32| rhs[*r as usize] / unit;
        let mut x: Vec<T> =
            fronts.order.iter().map(scaled).flat_map(|v| [v.x, v.y, v.z].map(T::from_f64)).collect();
        let pass = Pass { fronts, number: &self.number };
        pass.forest_forwards(&fronts.roots, &mut x);
        pass.forest_backwards(&fronts.roots, &[], &mut x);
        for (&r, x) in fronts.order.iter().zip(x.chunks_exact(3)) {
            rhs[r as usize] = Vec3::new(x[0].to_f64(), x[1].to_f64(), x[2].to_f64()) * (unit * self.scale);
        }
    }
}

struct Pass<'a, T> {
    fronts: &'a Fronts,
    number: &'a [T],
}

impl<T: Real> Pass<'_, T> {
    /// Two halves of neighbouring fronts, and how many numbers of the solution belong to the first.
    fn halves<'f>(&self, fronts: &'f [u32]) -> (&'f [u32], &'f [u32], usize) {
        let (left, right) = fronts.split_at(fronts.len() / 2);
        let start = |v: u32| {
            let first = self.fronts.list[v as usize].first;
            3 * self.fronts.list[first as usize].own[0] as usize
        };
        (left, right, start(right[0]) - start(left[0]))
    }

    fn panel(&self, front: &Front) -> &[T] {
        let (own, rows) = front.shape();
        &self.number[front.start..front.start + trapezoidal_storage::len(rows, own)]
    }

    /// x <- L^-1 x in the subtrees of neighbouring fronts; gives what each leaves on its boundary.
    fn forest_forwards(&self, fronts: &[u32], x: &mut [T]) -> Vec<Vec<T>> {
        match fronts {
            [] => Vec::new(),
            [one] => vec![self.forwards(*one, x)],
            _ => {
                let (left, right, middle) = self.halves(fronts);
                let (low, high) = x.split_at_mut(middle);
                let (mut a, mut b) = join_if(
                    low.len().min(high.len()) > 3 * SHARED,
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
        let (own, rows) = front.shape();
        let (below, mine) = x.split_at_mut(x.len() - own);
        let children = self.fronts.children_of(front);
        let left = self.forest_forwards(children, below);
        let mut w = vec![T::zero(); rows];
        w[..own].copy_from_slice(mine);
        for (&c, left) in children.iter().zip(&left) {
            for (&p, from) in self.fronts.places_of(c).iter().zip(left.chunks_exact(3)) {
                w[3 * p as usize..][..3].iter_mut().zip(from).for_each(|(to, from)| *to += *from);
            }
        }
        dense::forwards(self.panel(front), own, &mut w);
        mine.copy_from_slice(&w[..own]);
        w.split_off(own)
    }

    /// x <- L^-T x in the subtrees of neighbouring fronts, `above` being the solution on their parent's rows.
    fn forest_backwards(&self, fronts: &[u32], above: &[T], x: &mut [T]) {
        match fronts {
            [] => {}
            [one] => self.backwards(*one, above, x),
            _ => {
                let (left, right, middle) = self.halves(fronts);
                let (low, high) = x.split_at_mut(middle);
                join_if(
                    low.len().min(high.len()) > 3 * SHARED,
                    || self.forest_backwards(left, above, low),
                    || self.forest_backwards(right, above, high),
                );
            }
        }
    }

    fn backwards(&self, v: u32, above: &[T], x: &mut [T]) {
        let front = &self.fronts.list[v as usize];
        let (own, rows) = front.shape();
        let (below, mine) = x.split_at_mut(x.len() - own);
        let mut w = Vec::with_capacity(rows);
        w.extend_from_slice(mine);
        for &p in self.fronts.places_of(v) {
            w.extend_from_slice(&above[3 * p as usize..][..3]);
        }
        dense::backwards(self.panel(front), own, &mut w);
        mine.copy_from_slice(&w[..own]);
        self.forest_backwards(self.fronts.children_of(front), &w, below);
    }
}

/// Both, on two threads where that is `worth` it.
fn join_if<A: Send, B: Send>(
    worth: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if worth { rayon::join(a, b) } else { (a(), b()) }
}
