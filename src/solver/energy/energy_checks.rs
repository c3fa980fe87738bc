//! The checks that every energy term passes.

use crate::energy::term::Energy;
use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockSink;

struct Dense(nalgebra::DMatrix<f64>);

impl BlockSink for Dense {
    fn add(&mut self, i: u32, j: u32, block: &Mat3) {
        assert!(i >= j, "a block above the diagonal was added");
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

/// Returns the dense Hessian of `term`.
pub(crate) fn dense_hessian(term: &dyn Energy, x: &[Vec3]) -> nalgebra::DMatrix<f64> {
    let mut dense = Dense(nalgebra::DMatrix::zeros(3 * x.len(), 3 * x.len()));
    term.add_hessian(x, &mut dense);
    dense.0
}

/// Asserts that the gradient agrees with central differences of the value (relative 1e-6 of the largest entry), and
/// that the Hessian is symmetric without negative eigenvalues (-1e-10 of the largest).
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

/// Asserts that the term restricted to `points` has the same gradient and Hessian rows there and the same differences
/// of the value when one of them moves.
pub(crate) fn check_restriction(term: &dyn Energy, x: &[Vec3], points: &[bool], step: f64) {
    let part = term.restricted_to(points).expect("the term can be restricted");
    let (mut whole, mut few) = (vec![Vec3::zeros(); x.len()], vec![Vec3::zeros(); x.len()]);
    term.add_gradient(x, &mut whole);
    part.add_gradient(x, &mut few);
    let scale = whole.iter().map(|g| g.amax()).fold(0.0, f64::max);
    let (h, hp) = (dense_hessian(term, x), dense_hessian(part.as_ref(), x));
    for p in (0..x.len()).filter(|&p| points[p]) {
        assert!((whole[p] - few[p]).amax() <= 1e-12 * scale, "{}: point {p}", term.name());
        let (rows, fewer) = (h.rows(3 * p, 3), hp.rows(3 * p, 3));
        assert!((rows - fewer).amax() <= 1e-12 * h.amax(), "{}: rows of point {p}", term.name());
        let mut moved = x.to_vec();
        moved[p].z += step;
        let [all, some] = [term, part.as_ref()].map(|term| term.value(&moved) - term.value(x));
        assert!((all - some).abs() <= 1e-9 * all.abs().max(some.abs()), "{}: {all} {some}", term.name());
    }
}

/// Asserts that a rigid motion leaves the value unchanged and rotates the forces.
pub(crate) fn check_rigid_motion(term: &dyn Energy, x: &[Vec3]) {
    let rotation = nalgebra::Rotation3::new(Vec3::new(0.4, -0.9, 0.3));
    let shift = Vec3::new(0.2, -0.1, 0.5);
    let moved: Vec<Vec3> = x.iter().map(|p| rotation * p + shift).collect();
    let (here, there) = (term.value(x), term.value(&moved));
    assert!((here - there).abs() <= 1e-10 * here.abs().max(1e-300), "{}: {here} {there}", term.name());
    let (mut g, mut gm) = (vec![Vec3::zeros(); x.len()], vec![Vec3::zeros(); x.len()]);
    term.add_gradient(x, &mut g);
    term.add_gradient(&moved, &mut gm);
    let scale = g.iter().map(|g| g.amax()).fold(0.0, f64::max);
    for (a, b) in g.iter().zip(&gm) {
        assert!((rotation * a - b).amax() <= 1e-10 * scale);
    }
}

/// Asserts that, from rest at `x`, the secant Hessian predicts no force for a rotation of the whole by any angle, where
/// the Hessian at `x` predicts one.
pub(crate) fn check_secant_of_a_rotation(term: &dyn Energy, x: &[Vec3]) {
    let rotation = nalgebra::Rotation3::new(Vec3::new(0.4, -0.9, 0.3));
    let displacement: Vec<Vec3> = x.iter().map(|p| rotation * p - p).collect();
    let midpoint: Vec<Vec3> = x.iter().zip(&displacement).map(|(x, d)| x + d * 0.5).collect();
    let force = |midpoint: &[Vec3]| {
        let mut dense = Dense(nalgebra::DMatrix::zeros(3 * x.len(), 3 * x.len()));
        term.add_secant_hessian(x, midpoint, &mut dense);
        let flat = displacement.iter().flat_map(|d| [d.x, d.y, d.z]);
        (dense.0 * nalgebra::DVector::from_iterator(3 * x.len(), flat)).amax()
    };
    let (by_secant, by_hessian) = (force(&midpoint), force(x));
    assert!(by_hessian > 0.0 && by_secant <= 1e-10 * by_hessian, "{by_secant} {by_hessian}");
}
