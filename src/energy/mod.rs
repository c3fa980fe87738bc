//! A shelf of energies, one small file each: value [J], gradient [N], Hessian [N/m] over the points of the mesh.
//!
//! Terms know plain arrays of points, no file and no thread; they only read the memory. Every Hessian a term adds
//! is positive semi-definite (projected analytically or Gauss-Newton), so that a Newton step is a descent step.
//! A new term is one file here; the tests of the shelf (finite differences, rigid motion, positive Hessian) are
//! called once for it in that file.

mod bending;
mod drag;
mod edge_contact;
mod gravity;
mod membrane;
mod plane_contact;
mod pressure;
mod shrinking_sphere;
mod target_spring;

pub use bending::{Bending, BendingTerm};
pub use drag::Drag;
pub use edge_contact::{EdgeContact, EdgeContacts};
pub use gravity::Gravity;
pub use membrane::{Membrane, MembraneTerm};
pub use plane_contact::{PlaneContact, PlaneContacts};
pub use pressure::Pressure;
pub use shrinking_sphere::ShrinkingSphere;
pub use target_spring::{TargetSpring, TargetSprings};

use crate::math::{Mat3, Vec3};
use rayon::prelude::*;

/// Receives the 3 x 3 blocks of a symmetric Hessian.
pub trait BlockSink {
    /// Adds `block` at block row `i`, block column `j`. Only blocks with `i >= j` are given.
    fn add(&mut self, i: u32, j: u32, block: &Mat3);
    /// Whether any block between `points` is of use; those of others need not be made.
    fn is_relevant(&self, _points: &[u32]) -> bool {
        true
    }
}

/// An energy over the points of a mesh.
pub trait Energy: Sync {
    /// Its name, as in reports.
    fn name(&self) -> &'static str;
    /// Energy [J] at positions `x` [m].
    fn value(&self, x: &[Vec3]) -> f64;
    /// Adds the gradient [N] to `out`, one entry per point.
    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]);
    /// Adds a positive semi-definite Hessian [N/m].
    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink);
    /// The same for a way that begins at `x` and has its middle about at `half` [m]: the gradients at its two ends differ by about
    /// this times the way. Where elements turn on it the Hessian at `x` is wrong by the square of the angle, this one by its cube.
    /// Elements that stay as they are do with the Hessian at `x`.
    fn add_secant_hessian(&self, x: &[Vec3], _half: &[Vec3], out: &mut dyn BlockSink) {
        self.add_hessian(x, out);
    }
    /// Visits every group of points that the Hessian couples.
    fn visit_stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    /// The same with fewer elements: all that have a point for which `kept` is set (one flag per point). There gradient and
    /// Hessian stay what they are, and the value changes alike. `None` where leaving elements out is not worth while.
    fn restricted_to(&self, _kept: &[bool]) -> Option<Box<dyn Energy + '_>> {
        None
    }
}

/// The sum of a function of every element and its number, in the same order for any number of threads.
pub(crate) fn sum_of<T: Sync>(elements: &[T], of: impl Fn((usize, &T)) -> f64 + Sync) -> f64 {
    let part = |(k, part): (usize, &[T])| {
        let numbered = part.iter().enumerate().map(|(i, element)| (k * CHUNK + i, element));
        numbered.map(&of).sum::<f64>()
    };
    elements.par_chunks(CHUNK).enumerate().map(part).collect::<Vec<f64>>().into_iter().sum()
}

/// Elements that one task takes.
const CHUNK: usize = 1024;

/// Adds the block of the pair (`i`, `j`) of a symmetric element matrix at its lower-triangle place.
#[inline]
pub(crate) fn add_symmetric(out: &mut dyn BlockSink, i: u32, j: u32, block: &Mat3) {
    if i >= j { out.add(i, j, block) } else { out.add(j, i, &block.transpose()) }
}

#[cfg(test)]
pub(crate) mod energy_checks {
    //! The checks every term on the shelf passes.
    use super::*;

    struct Dense(nalgebra::DMatrix<f64>);

    impl BlockSink for Dense {
        fn add(&mut self, i: u32, j: u32, block: &Mat3) {
            assert!(i >= j, "a block above the diagonal was given");
            let (i, j) = (3 * i as usize, 3 * j as usize);
            for r in 0..3 {
                for c in 0..3 {
                    self.0[(i + r, j + c)] += block[(r, c)];
                    if i != j {
                        self.0[(j + c, i + r)] += block[(r, c)];
                    }
                }
            }
        }
    }

    /// Dense Hessian of `term`.
    pub(crate) fn dense_hessian(term: &dyn Energy, x: &[Vec3]) -> nalgebra::DMatrix<f64> {
        let mut dense = Dense(nalgebra::DMatrix::zeros(3 * x.len(), 3 * x.len()));
        term.add_hessian(x, &mut dense);
        dense.0
    }

    /// Gradient against central differences of the value (relative 1e-6 of the largest entry), Hessian symmetric
    /// and without negative eigenvalue (-1e-10 of the largest).
    pub(crate) fn check_gradient_and_hessian(term: &dyn Energy, x: &[Vec3], step: f64) {
        let mut gradient = vec![Vec3::zeros(); x.len()];
        term.add_gradient(x, &mut gradient);
        let scale = gradient.iter().map(|g| g.amax()).fold(0.0, f64::max);
        assert!(scale > 0.0, "{}: the test pose has no force", term.name());
        for i in 0..x.len() {
            for c in 0..3 {
                let (mut up, mut down) = (x.to_vec(), x.to_vec());
                up[i][c] += step;
                down[i][c] -= step;
                let difference = (term.value(&up) - term.value(&down)) / (2.0 * step);
                assert!(
                    (difference - gradient[i][c]).abs() <= 1e-6 * scale,
                    "{}: point {i} axis {c}: {difference} against {}",
                    term.name(),
                    gradient[i][c]
                );
            }
        }
        let h = dense_hessian(term, x);
        assert!((&h - h.transpose()).amax() <= 1e-12 * h.amax().max(1e-300));
        let eigen = h.symmetric_eigenvalues();
        assert!(
            eigen.min() >= -1e-10 * eigen.max(),
            "{}: eigenvalue {} of {}",
            term.name(),
            eigen.min(),
            eigen.max()
        );
    }

    /// With the elements around some points only: the same forces and blocks there, and the same differences of the value.
    pub(crate) fn check_around(term: &dyn Energy, x: &[Vec3], kept: &[bool], step: f64) {
        let part = term.restricted_to(kept).expect("the term has parts");
        let (mut whole, mut few) = (vec![Vec3::zeros(); x.len()], vec![Vec3::zeros(); x.len()]);
        term.add_gradient(x, &mut whole);
        part.add_gradient(x, &mut few);
        let scale = whole.iter().map(|g| g.amax()).fold(0.0, f64::max);
        let (h, hp) = (dense_hessian(term, x), dense_hessian(part.as_ref(), x));
        for p in (0..x.len()).filter(|&p| kept[p]) {
            assert!((whole[p] - few[p]).amax() <= 1e-12 * scale, "{}: point {p}", term.name());
            let (rows, fewer) = (h.rows(3 * p, 3), hp.rows(3 * p, 3));
            assert!((rows - fewer).amax() <= 1e-12 * h.amax(), "{}: rows of point {p}", term.name());
            let mut moved = x.to_vec();
            moved[p].z += step;
            let [all, some] = [term, part.as_ref()].map(|term| term.value(&moved) - term.value(x));
            assert!((all - some).abs() <= 1e-9 * all.abs().max(some.abs()), "{}: {all} {some}", term.name());
        }
    }

    /// Translation and rotation change neither the value nor (in their frame) the forces.
    pub(crate) fn check_rigid_motion(term: &dyn Energy, x: &[Vec3]) {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.4, -0.9, 0.3));
        let shift = Vec3::new(0.2, -0.1, 0.5);
        let moved: Vec<Vec3> = x.iter().map(|p| turn * p + shift).collect();
        let (here, there) = (term.value(x), term.value(&moved));
        assert!((here - there).abs() <= 1e-10 * here.abs().max(1e-300), "{}: {here} {there}", term.name());
        let (mut g, mut gm) = (vec![Vec3::zeros(); x.len()], vec![Vec3::zeros(); x.len()]);
        term.add_gradient(x, &mut g);
        term.add_gradient(&moved, &mut gm);
        let scale = g.iter().map(|g| g.amax()).fold(0.0, f64::max);
        for (a, b) in g.iter().zip(&gm) {
            assert!((turn * a - b).amax() <= 1e-10 * scale);
        }
    }

    /// At rest at `x`, a turn of the whole by any angle asks for no force by the secant, and by the Hessian for some.
    pub(crate) fn check_secant_of_a_turn(term: &dyn Energy, x: &[Vec3]) {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.4, -0.9, 0.3));
        let way: Vec<Vec3> = x.iter().map(|p| turn * p - p).collect();
        let half: Vec<Vec3> = x.iter().zip(&way).map(|(x, d)| x + d * 0.5).collect();
        let force = |half: &[Vec3]| {
            let mut dense = Dense(nalgebra::DMatrix::zeros(3 * x.len(), 3 * x.len()));
            term.add_secant_hessian(x, half, &mut dense);
            let way = nalgebra::DVector::from_iterator(3 * x.len(), way.iter().flat_map(|d| [d.x, d.y, d.z]));
            (dense.0 * way).amax()
        };
        let (by_secant, by_hessian) = (force(&half), force(x));
        assert!(by_hessian > 0.0 && by_secant <= 1e-10 * by_hessian, "{by_secant} {by_hessian}");
    }
}
