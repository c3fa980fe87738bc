//! Vertex block descent on the potential of a step (Chen and others 2024), for `--method vbd`.
//!
//! A round takes gradient and Hessian once; its sweeps move one point after another, to and fro, by
//! `-D⁻¹ (g + H d)` with its own block D: the minimum over that point of the round's quadratic model. Then the way is cut
//! where layers are near, and by the line search, exactly as Newton's is: what is not solved may look wrong, but it
//! does not cross or blow up. The number of rounds and sweeps is fixed; nothing is asked to converge.

use crate::contact::Contact;
use crate::math::{Mat3, Vec3};
use crate::sim::{BlockMatrix, Inertia, NewtonReport, Problem, Workspace};

/// Rounds of a step, and pairs of sweeps (to and fro) of a round: where more cost more than they gained on the chart of
/// accuracy.
const ROUNDS: usize = 2;
const SWEEPS: usize = 10;

impl Problem<'_> {
    /// Lowers phi from `x`, in place. Reports one local iteration a round and never that it converged.
    pub(in crate::sim) fn sweep(
        &self,
        x: &mut [Vec3],
        contact: &mut Contact,
        work: &mut Workspace,
    ) -> NewtonReport {
        let mut report = NewtonReport::default();
        if self.fixed.iter().all(|held| *held) {
            return report;
        }
        for round in 0..ROUNDS {
            let g = self.linearise(x, x, contact, work, &mut report);
            let clock = std::time::Instant::now();
            // The first guess is what the cloth would do without forces: sweeps carry no motion of the whole far.
            let guess: Vec<Vec3> = match self.inertia {
                Some(Inertia { inertial, .. }) if round == 0 => {
                    inertial.iter().zip(&*x).map(|(y, x)| y - x).collect()
                }
                _ => vec![Vec3::zeros(); x.len()],
            };
            let Some(d) = swept(work.matrix(), &g, &guess) else { break };
            report.seconds.linear_solve += clock.elapsed().as_secs_f64();
            report.local_iterations += 1;
            report.max_displacement = d.iter().map(|d| d.norm()).fold(0.0, f64::max);
            report.newton_decrement = -g.iter().zip(&d).map(|(g, d)| g.dot(d)).sum::<f64>();
            if !report.max_displacement.is_finite() || self.move_along(x, &g, &d, contact, &mut report) == 0.0
            {
                break;
            }
        }
        report
    }
}

/// What the sweeps make of H d = -g from d = `guess`, over all points.
fn swept(matrix: &BlockMatrix, g: &[Vec3], guess: &[Vec3]) -> Option<Vec<Vec3>> {
    let rows = matrix.row_count();
    let inverse: Vec<Mat3> = (0..rows).map(|r| matrix.diagonal(r).try_inverse()).collect::<Option<_>>()?;
    // Rows hold what is left of the diagonal only; what is right of it is kept up to date as points move.
    let mut d = matrix.gather(guess);
    let mut image = vec![Vec3::zeros(); rows];
    matrix.multiply(&d, &mut image);
    let mut rest: Vec<Vec3> = matrix.gather(g).iter().zip(&image).map(|(g, hd)| -g - hd).collect();
    let right = transposed(matrix);
    for sweep in 0..2 * SWEEPS {
        for k in 0..rows {
            let r = if sweep % 2 == 0 { k } else { rows - 1 - k };
            let step = inverse[r] * rest[r];
            d[r] += step;
            for (&c, block) in matrix.row(r).iter().zip(matrix.blocks(r)) {
                // The block at (r, c) acts on row c by its transpose.
                rest[c as usize] -= block.tr_mul(&step);
            }
            for &(c, at) in &right.entries[right.start[r] as usize..right.start[r + 1] as usize] {
                rest[c as usize] -= matrix.values()[at as usize] * step;
            }
        }
    }
    Some(matrix.scatter(&d))
}

/// Blocks right of the diagonal, row by row.
struct Right {
    start: Vec<u32>,
    /// Row that the block stands in, and its place among the values.
    entries: Vec<(u32, u32)>,
}

fn transposed(matrix: &BlockMatrix) -> Right {
    let rows = matrix.row_count();
    let (starts, columns) = matrix.pattern();
    let mut start = vec![0u32; rows + 1];
    let below =
        |r: usize| (starts[r] as usize..starts[r + 1] as usize - 1).map(|at| (at, columns[at] as usize));
    (0..rows).flat_map(below).for_each(|(_, c)| start[c + 1] += 1);
    (0..rows).for_each(|r| start[r + 1] += start[r]);
    let mut next = start.clone();
    let mut entries = vec![(0, 0); start[rows] as usize];
    for r in 0..rows {
        for (at, c) in below(r) {
            entries[next[c] as usize] = (r as u32, at as u32);
            next[c] += 1;
        }
    }
    Right { start, entries }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::BlockSink;

    /// A chain of springs, held by its first point: sweeps come to what the matrix says.
    #[test]
    fn sweeps_come_to_the_solution() {
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
        let found = swept(&matrix, &g, &[Vec3::x(); 4]).expect("blocks are invertible");
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found - truth).norm() < 1e-6, "{found} {truth}");
        }
    }
}
