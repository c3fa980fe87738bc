//! The direct solver against dense matrices, conjugate gradients and itself on other numbers of threads.

use super::*;
use crate::BlockSink;
use crate::block_matrix::INVALID;
use crate::conjugate_gradient::conjugate_gradient;
use crate::vector::Mat3;
use crease_geometry::math::Rng;

/// Points with the pairs that are coupled.
struct CoupledPoints {
    positions: Vec<Vec3>,
    pairs: Vec<(u32, u32)>,
}

/// A sheet of `n` x `n` points 5 mm apart, folded `folds` times across alternating axes into layers 0.6 mm apart, with
/// couplings over two rings and between points of different layers that are near. The fold lines are not rounded.
fn folded_sheet(n: u32, folds: u32) -> CoupledPoints {
    let mut positions: Vec<Vec3> = (0..n * n)
        .map(|k| Vec3::new(0.005 * f64::from(k % n), 0.0, 0.005 * f64::from(k / n) + 1e-4 * f64::from(k % 7)))
        .collect();
    let mut size = [0.005 * f64::from(n), 0.005 * f64::from(n)];
    let mut height = 0.0006;
    for fold in 0..folds {
        let axis = 2 * (fold % 2) as usize;
        let half = 0.5 * size[fold as usize % 2];
        for p in positions.iter_mut().filter(|p| p[axis] > half) {
            p[axis] = 2.0 * half - p[axis];
            p.y = 2.0 * height - 0.0006 - p.y;
        }
        size[fold as usize % 2] = half;
        height *= 2.0;
    }
    let mut pairs = Vec::new();
    for j in 0..n {
        for i in 0..n {
            for (di, dj) in [(1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)] {
                if i + di < n && j + dj < n {
                    pairs.push((j * n + i, (j + dj) * n + i + di));
                }
            }
        }
    }
    for a in 0..n * n {
        for b in 0..a {
            let d = positions[a as usize] - positions[b as usize];
            if d.y.abs() > 0.0003 && d.norm() < 0.004 {
                pairs.push((a, b));
            }
        }
    }
    CoupledPoints { positions, pairs }
}

impl CoupledPoints {
    /// A positive definite matrix: mass `mass`, and for every pair a spring of 1 along its direction times `stiffness`
    /// (times `wall` between layers) and a hundredth of it across. Points for which `fixed` is true have no row.
    fn matrix(&self, mass: f64, wall: f64, fixed: impl Fn(u32) -> bool) -> BlockMatrix {
        let mut next = 0;
        let row_of = (0..self.positions.len() as u32)
            .map(|p| {
                let row = if fixed(p) { INVALID } else { next };
                next += u32::from(row != INVALID);
                row
            })
            .collect();
        let mut matrix = BlockMatrix::with_pattern(row_of, &mut |visit| {
            self.pairs.iter().for_each(|(a, b)| visit(&[*a, *b]))
        });
        for p in 0..self.positions.len() {
            matrix.add_diagonal(p, mass * (1.0 + 0.3 * (p as f64).sin()));
        }
        for &(a, b) in &self.pairs {
            let d = self.positions[a as usize] - self.positions[b as usize];
            let stiffness = if d.y.abs() > 0.0003 { wall } else { 1.0 };
            let u = d.normalize();
            let block = (u * u.transpose() + Mat3::identity() * 0.01) * stiffness;
            matrix.add(a, a, &block);
            matrix.add(b, b, &block);
            let (i, j) = (a.max(b), a.min(b));
            matrix.add(i, j, &-block);
        }
        matrix
    }
}

fn right_hand_side(n: usize) -> Vec<Vec3> {
    let mut rng = Rng::from_state(3);
    (0..n).map(|_| rng.in_cube()).collect()
}

fn residual(matrix: &BlockMatrix, x: &[Vec3], rhs: &[Vec3]) -> f64 {
    let mut image = vec![Vec3::zeros(); x.len()];
    matrix.multiply(x, &mut image);
    image.iter_mut().zip(rhs).for_each(|(i, r)| *i -= r);
    (dot(&image, &image) / dot(rhs, rhs)).sqrt()
}

fn solved(direct: &mut Cholesky, matrix: &BlockMatrix, positions: &[Vec3], rhs: &[Vec3]) -> Vec<Vec3> {
    direct.factorise(matrix, positions).unwrap();
    let mut x = rhs.to_vec();
    direct.solve(matrix, &mut x).unwrap();
    x
}

#[test]
fn small_systems_match_a_dense_solve() {
    let mut rng = Rng::from_state(11);
    // Random graphs of all small sizes: no row, one row, loose points, separate parts, everything coupled.
    for n in 0..40u32 {
        let positions = (0..n).map(|_| rng.in_cube()).collect();
        let density = [-0.9, 0.0, 1.0][n as usize % 3];
        let mut pairs = Vec::new();
        for a in 0..n {
            pairs.extend((0..a).filter(|_| 2.0 * rng.uniform() - 1.0 < density).map(|b| (a, b)));
        }
        let scene = CoupledPoints { positions, pairs };
        let matrix = scene.matrix(0.1, 100.0, |_| false);
        let rhs = right_hand_side(n as usize);
        let x = solved(&mut Cholesky::default(), &matrix, &scene.positions, &rhs);
        let n = n as usize;
        let mut dense = nalgebra::DMatrix::<f64>::zeros(3 * n, 3 * n);
        for r in 0..n {
            for (&c, block) in matrix.row(r).iter().zip(matrix.blocks(r)) {
                dense.view_mut((3 * r, 3 * c as usize), (3, 3)).copy_from(block);
                dense.view_mut((3 * c as usize, 3 * r), (3, 3)).copy_from(&block.transpose());
            }
        }
        let flat = nalgebra::DVector::from_iterator(3 * n, rhs.iter().flat_map(|v| [v.x, v.y, v.z]));
        let expected = dense.cholesky().unwrap().solve(&flat);
        for (r, x) in x.iter().enumerate() {
            assert!((x - expected.fixed_rows::<3>(3 * r)).amax() < 1e-11, "{n} rows, row {r}");
        }
    }
}

#[test]
fn folded_sheets_are_solved_in_either_precision() {
    for folds in 0..4 {
        let scene = folded_sheet(30, folds);
        let matrix = scene.matrix(1e-3, 100.0, |p| p % 30 == 0);
        let rhs = right_hand_side(matrix.row_count());
        let mut direct = Cholesky::default();
        let x = solved(&mut direct, &matrix, &scene.positions, &rhs);
        assert!(!direct.in_double, "single precision did not suffice for {folds} folds");
        assert!(residual(&matrix, &x, &rhs) <= TUNING.refinement.residual_tol);
        direct.double_precision_holdoff = 1;
        let y = solved(&mut direct, &matrix, &scene.positions, &rhs);
        assert!(direct.in_double);
        assert!(residual(&matrix, &y, &rhs) < 1e-11);
        let z = conjugate_gradient(&matrix, &rhs, 1e-12, 20_000);
        assert!(z.converged);
        let size = y.iter().map(|v| v.amax()).fold(0.0, f64::max);
        for ((x, y), z) in x.iter().zip(&y).zip(&z.x) {
            assert!((x - y).amax() < 1e-6 * size && (z - y).amax() < 1e-9 * size);
        }
    }
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_any_history() {
    let scene = folded_sheet(40, 2);
    let matrix = scene.matrix(1e-3, 1e3, |_| false);
    let rhs = right_hand_side(matrix.row_count());
    let other = folded_sheet(20, 1);
    let mut outcomes = Vec::new();
    for threads in [1, 2, 3] {
        for used in [false, true] {
            for double in [false, true] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let x = pool.install(|| {
                    let mut direct = Cholesky::default();
                    if used {
                        let matrix = other.matrix(2.0, 1.0, |_| false);
                        solved(&mut direct, &matrix, &other.positions, &right_hand_side(matrix.row_count()));
                    }
                    direct.double_precision_holdoff = u32::from(double);
                    solved(&mut direct, &matrix, &scene.positions, &rhs)
                });
                outcomes.push((double, x));
            }
        }
    }
    for double in [false, true] {
        let mut same = outcomes.iter().filter(|(d, _)| *d == double).map(|(_, x)| x);
        let first = same.next().unwrap();
        assert!(same.all(|x| x == first), "double precision: {double}");
    }
}

#[test]
fn stiffness_of_any_range_is_solved() {
    let scene = folded_sheet(24, 2);
    for wall in [1.0, 1e3, 1e6, 1e9, 1e12] {
        let matrix = scene.matrix(1e-3, wall, |_| false);
        let rhs = right_hand_side(matrix.row_count());
        let x = solved(&mut Cholesky::default(), &matrix, &scene.positions, &rhs);
        let reached = residual(&matrix, &x, &rhs);
        // What double precision can do: 1e-16 of the largest terms, which are about wall x.
        let size = x.iter().map(|v| v.amax()).fold(0.0, f64::max);
        assert!(reached <= TUNING.refinement.residual_tol.max(1e-14 * wall * size), "wall {wall}: {reached}");
    }
}

#[test]
fn numbers_that_decay_beyond_single_precision_are_solved() {
    // Mass a million times the springs: fill-in decays by 1e-6 from point to point.
    let scene = folded_sheet(40, 0);
    let matrix = scene.matrix(1e6, 1.0, |_| false);
    let rhs = right_hand_side(matrix.row_count());
    let mut direct = Cholesky::default();
    let x = solved(&mut direct, &matrix, &scene.positions, &rhs);
    assert!(!direct.in_double);
    assert!(residual(&matrix, &x, &rhs) <= TUNING.refinement.residual_tol);
    assert!(direct.single.entries.iter().all(|l| *l == 0.0 || l.is_normal()));
}

#[test]
fn an_indefinite_matrix_is_refused_and_leaves_no_trace() {
    let scene = folded_sheet(30, 1);
    let mut matrix = scene.matrix(1e-3, 10.0, |_| false);
    let mut direct = Cholesky::default();
    matrix.add_diagonal(50, -100.0);
    assert_eq!(direct.factorise(&matrix, &scene.positions), Err(FactorError::NotPositive));
    matrix.add_diagonal(50, f64::NAN);
    assert_eq!(direct.factorise(&matrix, &scene.positions), Err(FactorError::NotPositive));
    let mut matrix = scene.matrix(1e-3, 10.0, |_| false);
    matrix.add(5, 4, &Mat3::repeat(f64::NAN));
    assert_eq!(direct.factorise(&matrix, &scene.positions), Err(FactorError::NotPositive));
    let matrix = scene.matrix(1e-3, 10.0, |_| false);
    let rhs = right_hand_side(matrix.row_count());
    let x = solved(&mut direct, &matrix, &scene.positions, &rhs);
    assert!(residual(&matrix, &x, &rhs) <= TUNING.refinement.residual_tol);
}

#[test]
fn degenerate_positions_are_no_obstacle() {
    let scene = folded_sheet(12, 0);
    let matrix = scene.matrix(1.0, 1.0, |_| false);
    let rhs = right_hand_side(matrix.row_count());
    for coordinate in [0.0, f64::NAN, f64::INFINITY, 1e300] {
        let positions = vec![Vec3::repeat(coordinate); scene.positions.len()];
        let x = solved(&mut Cholesky::default(), &matrix, &positions, &rhs);
        assert!(residual(&matrix, &x, &rhs) <= TUNING.refinement.residual_tol);
    }
}

/// Single precision cannot tell the points apart there: cuts that made no progress overflowed the stack.
#[test]
fn positions_far_from_the_origin_are_no_obstacle() {
    let scene = folded_sheet(40, 1);
    let matrix = scene.matrix(1.0, 1.0, |_| false);
    let near = nested_dissection::Tree::new(&matrix, &scene.positions);
    for offset in [Vec3::new(3e5, 0.0, 3e5), Vec3::new(1e6, 1e6, -1e6), Vec3::new(0.0, -1e9, 0.0)] {
        let positions: Vec<Vec3> = scene.positions.iter().map(|p| p + offset).collect();
        let far = nested_dissection::Tree::new(&matrix, &positions);
        let mut rows = far.order.clone();
        rows.sort_unstable();
        assert!(rows.into_iter().eq(0..near.order.len() as u32));
        assert!(far.end.len() > near.end.len() / 2, "{} nodes of {}", far.end.len(), near.end.len());
    }
}

#[test]
fn a_factor_that_does_not_fit_is_refused() {
    // One front of 11,000 points: 545 million numbers.
    let n = 11_000;
    let scene = CoupledPoints {
        positions: vec![Vec3::zeros(); n],
        pairs: (1..n as u32).map(|p| (p, p - 1)).collect(),
    };
    let matrix = BlockMatrix::with_pattern((0..n as u32).collect(), &mut |visit| {
        scene.pairs.iter().for_each(|(a, b)| visit(&[*a, *b]));
    });
    assert_eq!(Cholesky::default().factorise(&matrix, &scene.positions), Err(FactorError::TooLarge));
}

#[test]
fn a_stale_factor_solves_what_has_hardly_changed_and_refuses_the_rest() {
    let scene = folded_sheet(40, 2);
    let then = scene.matrix(0.1, 100.0, |_| false);
    let rhs = right_hand_side(then.row_count());
    let mut direct = Cholesky::default();
    direct.factorise(&then, &scene.positions).unwrap();
    assert!(!direct.is_double(), "a factor that costs nothing is always made again");
    let decrease = |x: &[Vec3]| dot(x, &rhs);
    let now = scene.matrix(0.11, 105.0, |_| false);
    let mut x = rhs.clone();
    assert!(direct.solve_with_stale_factor(&now, &mut x, 0.0, false));
    let exact = solved(&mut Cholesky::default(), &now, &scene.positions, &rhs);
    assert!((decrease(&x) / decrease(&exact) - 1.0).abs() < 1e-3, "{} {}", decrease(&x), decrease(&exact));
    // The strict criterion refuses it where the predicted decrease is large.
    let mut x = rhs.clone();
    assert!(!direct.solve_with_stale_factor(&now, &mut x, 0.0, true));
    let other = scene.matrix(1e-4, 1e5, |_| false);
    let mut x = rhs.clone();
    assert!(!direct.solve_with_stale_factor(&other, &mut x, 0.0, false));
    assert_eq!(x, rhs);
    // Where the predicted decrease is below the tolerance two iterations suffice, and decrease the energy.
    assert!(direct.solve_with_stale_factor(&other, &mut x, f64::MAX, true));
    let mut image = x.clone();
    other.multiply(&x, &mut image);
    let energy = 0.5 * dot(&x, &image) - decrease(&x);
    let exact = solved(&mut Cholesky::default(), &other, &scene.positions, &rhs);
    assert!(energy < 0.0 && energy > -0.5 * decrease(&exact), "{energy} {}", decrease(&exact));
}
