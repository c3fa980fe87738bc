//! Vertex block descent (Chen and others 2024) on backward Euler: a fixed number of sweeps over single points with
//! their 3 x 3 diagonal blocks instead of linear systems.
//!
//! Each linearisation takes gradient and Hessian once; its sweeps visit one point after another, forwards and
//! backwards, and move it by `-D⁻¹ (g + H d)` with its diagonal block D, to the minimum over that point of the
//! quadratic model. A sweep moves information to neighbouring points only, so that stiff or long cloth stays stretched
//! at any step size, and the result depends on the number of sweeps.

use crease_geometry::math::{Mat3, Vec3};
use crease_linear::BlockMatrix;
use crease_solver::sim::{Inertia, InnerSolver, Method, MethodSpec, NewtonReport, StageSolve};

/// Linearisations per step; more cost more than they gain in accuracy.
const LINEARISATION_COUNT: usize = 2;
/// Pairs of a forward and a backward sweep per linearisation; more cost more than they gain in accuracy.
const SWEEP_PAIR_COUNT: usize = 10;

pub(super) const SPEC: MethodSpec = MethodSpec {
    name: "vbd",
    description: "vertex block descent, VISUAL: looks like cloth, does not converge; for previews of small or soft garments",
    solver: InnerSolver::FixedWork(solve),
    ..*Method::BackwardEuler.spec()
};

/// Decreases phi from `x` in place. Reports one local iteration per linearisation and never convergence.
fn solve(stage: StageSolve, x: &mut [Vec3]) -> NewtonReport {
    let StageSolve { problem, contact, work, .. } = stage;
    let mut report = NewtonReport::default();
    if problem.fixed.iter().all(|fixed| *fixed) {
        return report;
    }
    for k in 0..LINEARISATION_COUNT {
        // The initial guess is the motion without forces: sweeps move nothing far.
        let guess: Vec<Vec3> = match problem.inertia {
            Some(Inertia { inertial, .. }) if k == 0 => {
                inertial.iter().zip(&*x).map(|(y, x)| y - x).collect()
            }
            _ => vec![Vec3::zeros(); x.len()],
        };
        let direction = |matrix: &BlockMatrix, g: &[Vec3]| gauss_seidel(matrix, g, &guess);
        if problem.descend(x, contact, work, &mut report, direction) == 0.0 {
            break;
        }
    }
    report
}

/// Returns the result of symmetric block Gauss-Seidel sweeps on H d = -g from d = `guess`, over all points; `None` if a
/// diagonal block is singular.
fn gauss_seidel(matrix: &BlockMatrix, g: &[Vec3], guess: &[Vec3]) -> Option<Vec<Vec3>> {
    let rows = matrix.row_count();
    let inverse: Vec<Mat3> = (0..rows).map(|r| matrix.diagonal(r).try_inverse()).collect::<Option<_>>()?;
    // The residual is updated as points move, by the column of each: the matrix stores the lower triangle only.
    let mut d = matrix.gather(guess);
    let mut image = vec![Vec3::zeros(); rows];
    matrix.multiply(&d, &mut image);
    let mut residual: Vec<Vec3> = matrix.gather(g).iter().zip(&image).map(|(g, hd)| -g - hd).collect();
    let upper = transpose_pattern(matrix);
    for sweep in 0..2 * SWEEP_PAIR_COUNT {
        for k in 0..rows {
            let r = if sweep % 2 == 0 { k } else { rows - 1 - k };
            let step = inverse[r] * residual[r];
            d[r] += step;
            for (&c, block) in matrix.row(r).iter().zip(matrix.blocks(r)) {
                // The block at (r, c) acts on row c by its transpose.
                residual[c as usize] -= block.tr_mul(&step);
            }
            for &(c, slot) in &upper.entries[upper.start[r] as usize..upper.start[r + 1] as usize] {
                residual[c as usize] -= matrix.values()[slot as usize] * step;
            }
        }
    }
    Some(matrix.scatter(&d))
}

/// Sparsity pattern above the diagonal, row by row.
struct UpperPattern {
    start: Vec<u32>,
    /// Row in which the block is stored, and its slot among the values.
    entries: Vec<(u32, u32)>,
}

fn transpose_pattern(matrix: &BlockMatrix) -> UpperPattern {
    let rows = matrix.row_count();
    let (starts, columns) = matrix.pattern();
    let mut start = vec![0u32; rows + 1];
    let below = |r: usize| {
        (starts[r] as usize..starts[r + 1] as usize - 1).map(|slot| (slot, columns[slot] as usize))
    };
    (0..rows).flat_map(below).for_each(|(_, c)| start[c + 1] += 1);
    (0..rows).for_each(|r| start[r + 1] += start[r]);
    let mut next = start.clone();
    let mut entries = vec![(0, 0); start[rows] as usize];
    for r in 0..rows {
        for (slot, c) in below(r) {
            entries[next[c] as usize] = (r as u32, slot as u32);
            next[c] += 1;
        }
    }
    UpperPattern { start, entries }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_linear::BlockSink;

    /// A chain of springs, fixed by the mass on its diagonal: the sweeps converge to the solution.
    #[test]
    fn sweeps_converge_to_the_solution() {
        let mut matrix = BlockMatrix::with_pattern(vec![0, 1, 2, 3], &mut |visit| {
            [[0, 1], [1, 2], [2, 3], [0, 3]].iter().for_each(|pair| visit(pair));
        });
        let coupling = Mat3::new(1.0, 0.2, 0.0, -0.1, 1.0, 0.3, 0.0, 0.0, 1.0);
        for (i, j) in [(1, 0), (2, 1), (3, 2), (3, 0)] {
            matrix.add(i, j, &(-coupling));
        }
        (0..4).for_each(|p| matrix.add_diagonal(p, 4.0));
        let truth: Vec<Vec3> = (0..4).map(|k| Vec3::new(f64::from(k), 1.0, -0.5 * f64::from(k))).collect();
        let mut image = vec![Vec3::zeros(); 4];
        matrix.multiply(&truth, &mut image);
        let g: Vec<Vec3> = image.iter().map(|v| -v).collect();
        let found = gauss_seidel(&matrix, &g, &[Vec3::x(); 4]).expect("blocks are invertible");
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found - truth).norm() < 1e-6, "{found} {truth}");
        }
    }
}
